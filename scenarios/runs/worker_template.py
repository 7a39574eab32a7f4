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
import tempfile
from contextlib import ExitStack, suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import IO

import numpy as np

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.executor import run_batch
from multibody_xval.scenarios.runs.failures import ExecutorError
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.scratch import Closing, ScratchFolder
from multibody_xval.scenarios.runs.supervisor import PR_SET_PDEATHSIG, forget_ended, prctl, supervise
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.runs.worker import serve
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.one_call import SteadyState
from reference_lcp.process import ONE_THREAD, ROOT
from reference_lcp.schemes.euler import euler_simulation
from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation
from reference_lcp.steady.orbits import periodic_orbits

START_SECONDS = 180.0
"""What a process has to start, to import the suite and to compile it where that has not been kept, on a busy machine:
15 s on one that is not."""

BEGIN_SECONDS = 10.0
"""What a process that has started has to take a message; one that takes longer, as it has been stopped, is replaced.
It takes milliseconds on a machine that is not busy."""

END_SECONDS = 1.0
"""What a supervisor has to end its processes, and a template to end; one that takes longer, as it has been stopped, is
killed itself."""

MESSAGE_BYTES = 4096
"""Longest message between the template and its client."""

WARM_UP = SteadyStateTask(
    variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=0.9, ratios=ChainRatios(cells=1)
)
"""What a template runs before it is forked: its workers need not load the compiled reference anew."""

_START = (
    "import sys; sys.path[:] = {path!r}; "
    "from multibody_xval.scenarios.runs.worker_template import fork_workers; fork_workers({descriptor})"
)


class WorkerTemplate(Closing):
    """The template of the workers of one client, started with the first of them, and again if it was killed.

    Workers have the environment, the folder and the paths of modules that the client had when it started the template.
    """

    def __init__(self) -> None:
        self.folder = ScratchFolder()
        self._process: subprocess.Popen[bytes] | None = None

    def fork(self) -> tuple[Connection, int, IO[bytes]]:
        """Start a worker; gives the connection (see `serve`), the descriptor of its supervisor, and its crash log.

        The supervisor, see pidfd_open(2), ends every process of the worker once the client lets go of the connection.
        """
        try:
            if self._process is not None:
                with suppress(OSError):  # it may have been killed since
                    return self._forked()
            self._end()
            self.start()
            forked = self._forked()
        except BaseException as problem:  # after an interrupt, the reply would be taken for that of the next request
            self._end()
            if isinstance(problem, OSError):
                raise ExecutorError(f"a worker process cannot be started: {problem}") from None
            raise
        return forked

    def close(self) -> None:
        """End the template; its workers go on."""
        self._end()
        self.folder.close()

    def _end(self) -> None:
        if self._process is not None:
            self._requests.close()
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(END_SECONDS)
            self._process.kill()
            self._process.wait()
            self._process = None

    def start(self) -> None:
        """Start its process, and do not wait for it."""
        self._requests, far = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._requests.settimeout(START_SECONDS)
        with far:
            self._process = subprocess.Popen(
                [sys.executable, "-c", _START.format(path=[str(ROOT), *sys.path], descriptor=far.fileno())],
                stdin=subprocess.DEVNULL,
                stdout=2,
                env={**os.environ, **ONE_THREAD, "TMPDIR": str(self.folder.path)},
                pass_fds=[far.fileno()],
                start_new_session=True,
            )

    def _forked(self) -> tuple[Connection, int, IO[bytes]]:
        """Request a worker, over descriptors that no other attempt has had; raise `OSError` if there is none."""
        reply = b""
        with ExitStack() as opened:
            connection, far = Pipe()
            opened.callback(connection.close)
            crash_log = opened.enter_context(tempfile.TemporaryFile(dir=self.folder.path))
            with far:
                socket.send_fds(self._requests, [b"fork"], [far.fileno(), crash_log.fileno()])
            with suppress(ConnectionError):
                reply = self._requests.recv(MESSAGE_BYTES)
            if not reply.isdigit():
                raise OSError(reply.decode() or "the template of workers has ended")
            self._requests.settimeout(BEGIN_SECONDS)
            supervisor = os.pidfd_open(int(reply))
            opened.pop_all()
            return connection, supervisor, crash_log


def fork_workers(descriptor: int) -> None:
    """Be a template until the client has gone; return in each worker when it has served."""
    prctl(PR_SET_PDEATHSIG, signal.SIGKILL)  # ends it even where it has been stopped
    _compile_side_by_side()
    run_batch([WARM_UP])  # imports and loads what is compiled, and compiles what has not been kept
    gc.collect()
    gc.freeze()  # no collection in a worker touches, and so copies, the memory that it shares
    with socket.socket(fileno=descriptor) as requests:
        connection, crash_log = _forked_on_request(requests)
    os.setsid()
    supervise(connection)
    serve(connection, crash_log)


class _Fading(LaneModel):
    """A motion that halves in every period: the search of its steady state compiles the search, and no scheme."""

    def __init__(self, lane: Lane):
        self.lane = lane

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Halve the state, step by step."""
        left = 0.5 ** (np.arange(1, steps + 1) / steps)[:, None]
        forces = self.lane.preloads(start, steps)
        return Trajectory(
            self.lane.times(start, steps), left * state.positions, left * state.velocities, forces, forces
        )


def _compile_side_by_side() -> None:
    """Compile the scheme here and the search of steady states in another process, where they have not been kept."""
    lane, steps = WARM_UP.lane()
    try:
        search = os.fork()
    except OSError:  # as many processes as there may be: all is compiled here
        return
    if search == 0:
        prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        with suppress(BaseException):  # what is missing is compiled later
            SteadyState.of(periodic_orbits(SequentialSimulation([_Fading(lane)]), steps)[0])
        os._exit(0)
    euler_simulation([lane]).run(State.at_rest(1, lane.chain.cells), 0, steps)
    os.waitpid(search, 0)


def _forked_on_request(requests: socket.socket) -> list[int]:
    """Fork for each request: return in the fork, and end with the client.

    A request has descriptors of the connection's other end and of the crash log; the reply is the number of the
    supervisor, or the reason why no process could be forked.
    """
    while True:
        request, descriptors, *_ = socket.recv_fds(requests, MESSAGE_BYTES, 2)
        with suppress(ChildProcessError):  # not before: until then, the number of one that has ended is no other's
            forget_ended()
        if not request:
            os._exit(0)
        try:
            process = os.fork()
        except OSError as problem:
            reply = str(problem)
        else:
            if process == 0:
                return descriptors
            reply = str(process)
        with suppress(OSError):  # the client has gone, which the next request says
            requests.send(reply.encode())
        for descriptor in descriptors:
            os.close(descriptor)
