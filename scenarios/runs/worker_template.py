"""A process that has imported what every worker needs, and is forked for each: a worker starts in milliseconds.

It is a fresh Python that does not import the program that started it, has imported no engine, runs one thread, and ends
with its client. It needs Linux 5.3 or later.
"""

import ctypes
import gc
import os
import select
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress
from io import FileIO
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import NamedTuple

from engines.interface.variant import Variant
from engines.isolated.process import ONE_THREAD
from scenarios.runs.executor import run_batch
from scenarios.runs.failures import ExecutorError
from scenarios.runs.parameters import ChainRatios
from scenarios.runs.scratch import Closing
from scenarios.runs.task import SteadyStateTask
from scenarios.runs.worker import serve

PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36
"""Options of prctl(2): a signal at the end of the parent; orphans among the descendants become children."""

PRINTED_BYTES = 10_000
"""What is shown of what a worker prints; the rest is counted. An engine that warns in every step prints gigabytes."""

CHUNK_BYTES = 4096
"""What is read and shown at a time: so much can be written to a pipe that is writable without waiting."""

POLL_SECONDS = 0.002
"""Interval at which processes that have been killed are looked for until all have ended."""


def supervise(lifeline: int, connection: int) -> None:
    """Fork: return in the child, the worker; in the parent, end all that it has started once it or the client ends.

    The client holds the other ends of the lifeline, a pipe, and of the connection.
    """
    prctl(PR_SET_CHILD_SUBREAPER, 1)
    printed, output = os.pipe()
    supervisor, worker = os.getpid(), os.fork()
    if worker == 0:
        os.close(lifeline)
        os.close(printed)
        return _become_worker(supervisor, output)
    os.close(connection)
    os.close(output)
    try:
        shown = _Printed(printed)
        _watch(worker, lifeline, shown)
        _end_children()
        shown.finish()
    finally:
        os._exit(0)


def _become_worker(supervisor: int, output: int) -> None:
    """End with the supervisor, out of reach of its terminal and in a group of its own; print into its pipe."""
    prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != supervisor:  # it had ended before
        os._exit(0)
    os.setsid()
    os.dup2(output, 1)
    os.dup2(output, 2)
    os.close(output)


def prctl(option: int, value: int) -> None:
    """Set an option of this process; see prctl(2)."""
    if ctypes.CDLL(None).prctl(option, value, 0, 0, 0) != 0:
        raise OSError(f"prctl({option}, {value}) failed")


def _watch(worker: int, lifeline: int, printed: "_Printed") -> None:
    """Return when the worker has ended, or the client has closed the lifeline."""
    ended, wake = os.pipe()
    os.set_blocking(wake, False)
    signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    poll = select.poll()
    for descriptor in (ended, lifeline, printed.descriptor):
        poll.register(descriptor, select.POLLIN)
    while not _has_ended(worker):
        ready = [descriptor for descriptor, _ in poll.poll()]
        if lifeline in ready:
            return
        if ended in ready:
            os.read(ended, CHUNK_BYTES)
        if printed.descriptor in ready and not printed.take():
            poll.unregister(printed.descriptor)


def _has_ended(worker: int) -> bool:
    """Read the ends of children, those of orphans too; tell whether the worker is among them."""
    with suppress(ChildProcessError):
        while (process := os.waitpid(-1, os.WNOHANG)[0]) != 0:
            if process == worker:
                return True
    return False


def _end_children() -> None:
    """Kill every child until there is none: those of a killed one become children of this process."""
    process = os.getpid()
    children = Path(f"/proc/{process}/task/{process}/children")
    while True:
        for child in children.read_text().split():
            with suppress(ProcessLookupError):
                os.kill(int(child), signal.SIGKILL)
        try:
            while os.waitpid(-1, os.WNOHANG)[0] != 0:
                pass
        except ChildProcessError:
            return
        time.sleep(POLL_SECONDS)


class _Printed:
    """What a worker prints: its beginning is shown on standard error, the rest is counted."""

    def __init__(self, descriptor: int):
        os.set_blocking(descriptor, False)
        self.descriptor = descriptor
        self._shown = self._more = 0

    def take(self) -> bool:
        """Read some of it; tell whether there was any."""
        try:
            text = os.read(self.descriptor, CHUNK_BYTES)
        except BlockingIOError:
            return False
        part = text[: PRINTED_BYTES - self._shown]
        if part:
            _show(part)
        self._shown += len(part)
        self._more += len(text) - len(part)
        return bool(text)

    def finish(self) -> None:
        """Read what is left once the worker has ended, and say how much has not been shown."""
        while self.take():
            pass
        if self._more:
            _show(f"… ({self._more} bytes more)\n".encode())


def _show(text: bytes) -> None:
    """Write to standard error, unless whoever reads it is behind: that must not hold up the supervisor."""
    with suppress(OSError):
        if select.select([], [2], [], 0)[1]:
            os.write(2, text)


START_SECONDS = 180.0
"""What a process has to start, to import the suite and to compile it where that has not been kept, on a busy machine:
15 s on one that is not."""

SUITE = Path(__file__).resolve().parents[2]
"""Where the packages of the suite lie: looked for there first, whatever has their names in the working folder."""

END_SECONDS = 1.0
"""What a supervisor has to end its processes, and a template to end; one that takes longer, as it has been stopped, is
killed itself."""

MESSAGE_BYTES = 4096
"""Longest message between the template and its client: Linux's longest path."""

STARTED = b"started"
"""Reply to a request; any other one is the reason why no worker could be forked."""

WARM_UP = SteadyStateTask(
    variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=0.9, ratios=ChainRatios(cells=1)
)
"""What a template runs before it is forked: its workers need not load the compiled reference anew."""

_START = (
    "import sys; sys.path[:] = {path!r}; "
    "from scenarios.runs.worker_template import fork_workers; fork_workers({descriptor})"
)


class ForkedWorker(NamedTuple):
    """What the client of a worker holds of it."""

    connection: Connection
    """Through which batches go and results come; see `scenarios.runs.worker.serve`."""
    lifeline: FileIO
    """Once it is closed, the supervisor ends every process of the worker."""
    supervisor: int
    """Descriptor of the supervising process, see pidfd_open(2): readable once that has ended."""


class WorkerTemplate(Closing):
    """The template of the workers of one client, started with the first of them, and again if it was killed.

    Workers have the environment, the folder and the paths of modules that the client had when it started the template.
    """

    def __init__(self, temporary: Path):
        self._temporary = temporary
        self._process: subprocess.Popen[bytes] | None = None

    def fork(self, crash_log: Path) -> ForkedWorker:
        """Start a worker that writes into this file where it crashed."""
        try:
            if self._process is not None:
                with suppress(OSError):  # it may have been killed since
                    return self._forked(crash_log)
            self.close()
            self._start()
            return self._forked(crash_log)
        except OSError as problem:
            self.close()
            raise ExecutorError(f"a worker process cannot be started: {problem}") from None
        except BaseException:  # an interrupt: the reply would be taken for that of the next request
            self.close()
            raise

    def close(self) -> None:
        """End the template; its workers go on."""
        if self._process is not None:
            self._requests.close()
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(END_SECONDS)
            self._process.kill()
            self._process.wait()
            self._process = None

    def _start(self) -> None:
        self._requests, far = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._requests.settimeout(START_SECONDS)
        with far:
            self._process = subprocess.Popen(
                [sys.executable, "-c", _START.format(path=[str(SUITE), *sys.path], descriptor=far.fileno())],
                stdin=subprocess.DEVNULL,
                stdout=2,
                env={**os.environ, **ONE_THREAD, "TMPDIR": str(self._temporary)},
                pass_fds=[far.fileno()],
                start_new_session=True,
            )

    def _forked(self, crash_log: Path) -> ForkedWorker:
        """Request a worker, over descriptors that no other attempt has had; raise `OSError` if there is none."""
        connection, far = Pipe()
        released, writing = os.pipe()
        lifeline = FileIO(writing, "w")
        try:
            socket.send_fds(self._requests, [os.fsencode(crash_log)], [released, far.fileno()])
            supervisor = self._received()
        except BaseException:
            connection.close()
            lifeline.close()
            raise
        finally:
            far.close()
            os.close(released)
        return ForkedWorker(connection, lifeline, supervisor)

    def _received(self) -> int:
        """Wait for the reply: the descriptor of the supervisor, or an `OSError`."""
        reply, descriptors = b"", list[int]()
        with suppress(ConnectionError):
            reply, descriptors, *_ = socket.recv_fds(self._requests, MESSAGE_BYTES, 1)
        if reply != STARTED:
            raise OSError(reply.decode() or "the template of workers has ended")
        if not descriptors:
            raise OSError("no descriptor is left for it")
        os.set_inheritable(descriptors[0], False)
        return descriptors[0]


def fork_workers(descriptor: int) -> None:
    """Be a template until the client has gone; return in each worker when it has served.

    Requests come through the socket: a crash log's path, the lifeline's other end and the connection's.
    """
    prctl(PR_SET_PDEATHSIG, signal.SIGKILL)  # ends it even where it has been stopped
    run_batch([WARM_UP])  # imports and loads what is compiled, and compiles what has not been kept
    gc.collect()
    gc.freeze()  # no collection in a worker touches, and so copies, the memory that it shares
    with socket.socket(fileno=descriptor) as requests:
        crash_log, lifeline, connection = _forked_on_request(requests)
    os.setsid()
    supervise(lifeline, connection)
    serve(connection, crash_log)


def _forked_on_request(requests: socket.socket) -> tuple[str, int, int]:
    """Fork for each request: return in the fork, and end with the client."""
    while True:
        crash_log, descriptors, *_ = socket.recv_fds(requests, MESSAGE_BYTES, 2)
        _forget_ended()
        if not crash_log:
            os._exit(0)
        try:
            process = os.fork()
        except OSError as problem:
            _reply(requests, str(problem).encode(), [])
        else:
            if process == 0:
                lifeline, connection = descriptors
                return os.fsdecode(crash_log), lifeline, connection
            supervisor = os.pidfd_open(process)
            _reply(requests, STARTED, [supervisor])
            os.close(supervisor)
        for descriptor in descriptors:
            os.close(descriptor)


def _reply(requests: socket.socket, message: bytes, descriptors: list[int]) -> None:
    with suppress(OSError):  # the client has gone, which the next request says
        socket.send_fds(requests, [message], descriptors)


def _forget_ended() -> None:
    """Read the ends of workers, whose processor time is then the client's; not while one is being forked.

    It would lose its number before its descriptor is opened.
    """
    with suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0] != 0:
            pass
