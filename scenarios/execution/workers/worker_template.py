"""A process that has imported what every worker needs, and is forked for each: a worker starts in milliseconds.

It is a fresh Python that does not import the program that started it, has imported no engine, runs one thread, and ends
with its client. It needs Linux 5.3 or later.
"""

import gc
import os
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import NamedTuple

from engines.interface.variant import Variant
from engines.out_of_process.process import ONE_THREAD
from scenarios.execution.closing import Closing
from scenarios.execution.computation.batch import run_batch
from scenarios.execution.computation.failures import ExecutorError
from scenarios.execution.workers.supervisor import PR_SET_PDEATHSIG, prctl, supervise
from scenarios.execution.workers.worker import serve
from scenarios.tasks.parameters import ChainRatios
from scenarios.tasks.task import SteadyStateTask

START_SECONDS = 180.0
"""What a process has to start, to import the suite and to compile it where that has not been kept, on a busy machine:
15 s on one that is not."""

SUITE = Path(__file__).resolve().parents[3]
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
    "from scenarios.execution.workers.worker_template import fork_workers; fork_workers({descriptor})"
)


class ForkedWorker(NamedTuple):
    """What the client of a worker holds of it."""

    connection: Connection
    """Through which batches go and results come; see `scenarios.execution.workers.worker.serve`."""
    lifeline: int
    """Descriptor: once it is closed, the supervisor ends every process of the worker."""
    supervisor: int
    """Descriptor of the supervising process, see pidfd_open(2): readable once that has ended."""


class WorkerTemplate(Closing):
    """The template of the workers of one client, started with the first of them, and again if it was killed.

    Workers have the environment, the folder and the paths of modules that the client had when it started the template.

    Parameters
    ----------
    temporary
        Where engines find their temporary folder.
    """

    def __init__(self, temporary: Path):
        self._temporary = temporary
        self._process: subprocess.Popen[bytes] | None = None

    def fork(self, crash_log: Path) -> ForkedWorker:
        """Start a worker that writes into this file where it crashed.

        Raises
        ------
        ExecutorError
            If no process can be started.
        """
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
        released, lifeline = os.pipe()
        try:
            socket.send_fds(self._requests, [os.fsencode(crash_log)], [released, far.fileno()])
            supervisor = self._received()
        except BaseException:
            connection.close()
            os.close(lifeline)
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

    Parameters
    ----------
    descriptor
        Of the socket through which requests come: a crash log's path, the lifeline's other end and the connection's.
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
