"""Worker processes on this machine, each of which can crash, hang or be stopped without harm to the others."""

import os
import pickle
import re
import select
import signal
import socket
import sys
from collections.abc import Collection, Iterator
from concurrent.futures import Future, wait
from contextlib import contextmanager, suppress
from threading import Thread, Timer

from multibody_xval.engines.interface import registry
from multibody_xval.engines.isolated.process import FATAL, place_of_crash
from multibody_xval.scenarios.runs import TIME_LIMIT
from multibody_xval.scenarios.runs.executor import KILLED, Batch, Run, WorkerDied, WorkerExecutor
from multibody_xval.scenarios.runs.failures import ExecutorError
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.worker import Begun, identity_of
from multibody_xval.scenarios.runs.worker_template import BEGIN_SECONDS, END_SECONDS, WorkerTemplate
from reference_lcp.terminal import say_in_terminal

GRACE_SECONDS = 1.0
"""By how much a process may pass the time limit, in which it writes its crash log."""

KEPT_SECONDS = 5.0
"""What an engine has to load what it has kept, without a word to the user: MuJoCo Warp takes 2 s."""

IDLE_WORKERS = 8
"""Idle processes that are kept for their engine beside the busy ones: importing an engine takes up to a second."""


class LocalWorker:
    """A process forked from a template, below a supervisor, which runs one batch of its engine at a time.

    It does not import the program that started it, and no Ctrl-C of the terminal reaches it. When the starting process
    ends, so does it, with every process that an engine has started in it; see `supervise`.
    """

    def __init__(self, engine: str, template: WorkerTemplate):
        self.engine = engine
        self._late = False
        self._run: Run | None = None
        self._connection, self._supervisor, self._crash_log = template.fork()

    @property
    def busy(self) -> bool:
        """Whether it runs a batch."""
        return self._run is not None and not self._run.done()

    def alive(self) -> bool:
        """Whether it would take a batch."""
        return not (self._late or self._ended(0.0))

    def run(self, batch: Batch, identity: str, limit: float) -> Run:
        """Start on a batch, see `serve`, that may take `limit` seconds; gives its results, or `WorkerDied`."""
        run: Run = Future()

        def exchange() -> None:
            try:
                run.set_result(self._exchange(batch, identity, limit))
            except BaseException as problem:
                run.set_exception(problem)

        self._run = run
        Thread(target=exchange, daemon=True).start()  # a worker may be stopped in the middle of a message
        return run

    def dismiss(self) -> None:
        """Let its supervisor end it, and every process that it has started."""
        with suppress(OSError), socket.fromfd(self._connection.fileno(), socket.AF_UNIX, socket.SOCK_STREAM) as end:
            end.shutdown(socket.SHUT_WR)

    def end(self) -> None:
        """See that they have ended, and free what is held."""
        self._stop()
        if self._run is not None:
            wait([self._run], END_SECONDS)
        self._connection.close()
        self._crash_log.close()
        os.close(self._supervisor)

    def _exchange(self, batch: Batch, identity: str, limit: float) -> list[Result]:
        """Send a batch and wait for the reply, while the limit of what has begun counts."""
        begun: Begun | None = None
        try:
            with self._stopped_after(BEGIN_SECONDS):
                self._connection.send_bytes(pickle.dumps((batch, identity, limit)))
                reply = self._connection.recv()
            while isinstance(reply, Begun):
                begun = reply if reply.preparation else Begun(limit=limit)
                with self._stopped_after(begun.limit + GRACE_SECONDS):
                    if begun.preparation and not self._connection.poll(KEPT_SECONDS):
                        told = f"at most {begun.limit:g} s; what is made is kept for later runs"
                        say_in_terminal(f"{begun.preparation}: {told}")
                    reply = self._connection.recv()
        except Exception:  # it has died, or its engine has written into the connection
            raise self._death(begun) from None
        return [Result.blocked(reply)] * len(batch) if isinstance(reply, str) else reply

    @contextmanager
    def _stopped_after(self, seconds: float) -> Iterator[None]:
        def stop() -> None:
            self._late = True
            self._stop()

        timer = Timer(seconds, stop)
        timer.daemon = True
        timer.start()
        try:
            yield
        finally:
            timer.cancel()

    def _stop(self) -> None:
        self.dismiss()
        if not self._ended(END_SECONDS):
            signal.pidfd_send_signal(self._supervisor, signal.SIGKILL)
            self._ended(None)

    def _ended(self, within: float | None) -> bool:
        """Whether its supervisor ends within so many seconds; without a number, wait until it has."""
        end = select.poll()
        end.register(self._supervisor, select.POLLIN)
        return bool(end.poll(None if within is None else 1000 * within))

    def _death(self, begun: Begun | None) -> WorkerDied:
        """End it, and say why its batch has no results."""
        self._stop()
        self._crash_log.seek(0)
        crash_log = self._crash_log.read().decode(errors="replace")
        where, fault = place_of_crash(crash_log), re.search(rf"{FATAL}(.+)", crash_log)
        if begun is None:
            reason = f"no worker process began with it within {BEGIN_SECONDS:g} s" if self._late else KILLED
            return WorkerDied(reason, begun=False)
        if fault is not None:
            reason = f"the worker process crashed: {fault[1]}{where}"
        elif self._late or crash_log.startswith("Timeout"):
            reason = f"stopped at the time limit of {begun.limit:g} s{where}"
        else:
            return WorkerDied(KILLED)
        if begun.preparation:
            return WorkerDied(f"{begun.preparation}: {reason}", preparing=True)
        return WorkerDied(reason, by_engine=True)


def unavailable_reason() -> str | None:
    """Give the reason why there are no worker processes here; ``None`` where there are."""
    system: str = sys.platform
    if system == "linux":
        return None
    return f"worker processes need Linux, and this is {system}; engines run in the process of the command"


class LocalExecutor(WorkerExecutor):
    """Processes on this machine, each for one engine: what an engine does to its process affects no other engine.

    As many compute at a time as there are `workers`, or processors without that.
    """

    def __init__(self, workers: int | None = None, time_limit: float = TIME_LIMIT):
        super().__init__(workers if workers is not None else (os.cpu_count() or 1), time_limit)
        self._workers: list[LocalWorker] = []
        self._template: WorkerTemplate | None = None

    def warm_up(self) -> None:
        """Start the template of workers, which imports and compiles what they need; without them, nothing."""
        if self._template is None and unavailable_reason() is None:
            self._template = WorkerTemplate()
            self._template.start()

    def run_for_client(self, batch: Batch, identity: str, limit: float) -> list[Result]:
        """Run a batch of a client on another machine, to which the identity belongs, or raise `WorkerDied`."""
        return self._worker_for(batch[0].variant.engine).run(batch, identity, limit).result()

    def close(self) -> None:
        """End every process."""
        self._end(self._workers)
        if self._template is not None:
            self._template.close()
            self._template = None

    def _start(self, batch: Batch) -> Run:
        worker = self._worker_for(batch[0].variant.engine)
        return worker.run(batch, identity_of(batch[0].variant), self._limit)

    def _abandon(self, running: Collection[Run]) -> None:
        self._end([worker for worker in self._workers if worker.busy])

    def _worker_for(self, engine: str) -> LocalWorker:
        """Give an idle process for this engine, the one used last; a new one if there is none."""
        engine = registry.engine(engine).host
        self._end([worker for worker in self._workers if not (worker.busy or worker.alive())])
        idle = [worker for worker in self._workers if not worker.busy]
        same = [worker for worker in idle if worker.engine == engine]
        if same:
            self._workers.remove(same[-1])
            self._workers.append(same[-1])
            return same[-1]
        reason = unavailable_reason()
        if reason is not None:
            raise ExecutorError(reason)
        if len(idle) > IDLE_WORKERS:
            self._end(idle[:1])
        self._template = self._template or WorkerTemplate()
        self._workers.append(LocalWorker(engine, self._template))
        return self._workers[-1]

    def _end(self, workers: Collection[LocalWorker]) -> None:
        for worker in workers:
            worker.dismiss()
        for worker in list(workers):
            worker.end()
            self._workers.remove(worker)
