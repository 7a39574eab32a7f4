"""Worker processes of this machine: what one does to its process is no other's, and no process stays behind."""

import ctypes
import os
import signal
import sys
import threading
import uuid
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from pebble import ProcessPool

from multibody_xval.scenarios import compute
from multibody_xval.scenarios.compute.prctl import SET_CHILD_SUBREAPER, SET_NAME, SET_PARENT_DEATH_SIGNAL, prctl

if TYPE_CHECKING:
    from multiprocessing.context import ForkServerContext

GRACE = 20.0
"""Seconds after a limit at which a pool that has not ended the run itself is given up: its pipe is stuck or garbled."""

LOOK_SECONDS = 1.0
"""How often it is looked whether processes are lost."""

MOST_PROCESSES = 64
"""Workers that may wait for jobs of their engine, beside those that compute."""

EXITED = 120
"""Exit code of a worker that an engine has ended as if all were well: pebble takes no notice of 0."""

WORKERS = "xval-"
"""How names of workers begin."""

MARK = "MULTIBODY_XVAL_POOL"
"""Variable in the environment of workers that has the same name, which programs that they start inherit too."""

Job = tuple[Callable[..., Any], Sequence[Any], float, str]
"""A function, its arguments, its time limit [s], and the name of what its process serves."""


class Pool(Protocol):
    """What runs functions somewhere else."""

    slots: int
    """How many it runs at once."""

    def submit(self, job: Job) -> "Future[Any]":
        """Start a job."""

    def is_lost(self, serves: str) -> bool:
        """Whether the processes of one engine give no results any more."""

    def give_up(self, serves: str) -> None:
        """End the processes of one engine, whose jobs never end by themselves."""


class LocalPool:
    """Worker processes of this machine, forked from one that has loaded the kernels.

    A process serves one engine: what one does to its process, such as to the rounding of its processor, is no other's.
    """

    def __init__(self, workers: int):
        self.slots = workers
        self._pools: dict[str, ProcessPool] = {}
        self._names: dict[str, str] = {}
        self._jobs: dict[str, list[Future[Any]]] = {}
        self._given_up: list[str] = []

    @cached_property
    def _context(self) -> "ForkServerContext":
        """Start the process from which workers are forked, as soon as there is something to run."""
        from multiprocessing import forkserver  # which other systems lack

        from multibody_xval.scenarios.compute.without_main import WithoutMain

        context = WithoutMain()
        context.set_forkserver_preload([f"{compute.__name__}.{name}" for name in ("ends_with_parent", "warm")])
        forkserver.ensure_running()  # by this thread: it ends with that
        prctl(SET_CHILD_SUBREAPER, 1)
        return context

    def submit(self, job: Job) -> "Future[Any]":
        """Start a job in a process that serves its engine alone."""
        function, arguments, limit, serves = job
        if self.is_lost(serves):
            self.give_up(serves)
        if serves not in self._pools:
            self._make_room()
            name = self._names[serves] = f"{WORKERS}{uuid.uuid4().hex[:10]}"
            self._pools[serves] = ProcessPool(self.slots, initializer=_begin, initargs=[name], context=self._context)
        future: Future[Any] = self._pools[serves].schedule(_by_one, args=[function, *arguments], timeout=limit)
        self._jobs[serves] = [*(own for own in self._jobs.get(serves, []) if not own.done()), future]
        return future

    def _make_room(self) -> None:
        """End workers that have nothing to do where there would be too many of them."""
        idle = [serves for serves, jobs in self._jobs.items() if all(job.done() for job in jobs)]
        for serves in idle:
            if self.slots * (len(self._pools) + 1) > MOST_PROCESSES and serves in self._pools:
                self._close(serves)

    def is_lost(self, serves: str) -> bool:
        """Whether the processes of an engine were killed while they had nothing to do, or have garbled their pipe."""
        return serves in self._pools and not self._pools[serves].active

    def give_up(self, serves: str) -> None:
        """End all processes of an engine; the next job begins in new ones."""
        if serves in self._pools:
            self._pools.pop(serves).stop()  # type: ignore[no-untyped-call]  # or it would start others in their place
        self._jobs.pop(serves, None)
        self._given_up.append(self._names.pop(serves))
        _end(self._given_up[-1])

    def _close(self, *names: str) -> None:
        pools = [self._pools.pop(name) for name in names]
        for pool in pools:
            pool.stop()  # type: ignore[no-untyped-call]
        ended = [process for name in names for process in _end(self._names.pop(name))]
        for pool in pools:
            pool.join(GRACE)
        _forget(ended)

    def close(self) -> None:
        """End all workers, and whatever they have started."""
        self._close(*self._pools)
        _forget([process for name in self._given_up for process in _end(name)])  # what was being started at that moment
        prctl(SET_CHILD_SUBREAPER, 0)


class ThisProcess:
    """Runs one job after the other in this process: one that crashes or hangs ends the command."""

    slots = 1

    def submit(self, job: Job) -> "Future[Any]":
        """Run a job."""
        ended: Future[Any] = Future()
        try:
            ended.set_result(job[0](*job[1]))
        except Exception as problem:  # as it would come from another process
            ended.set_exception(problem)
        return ended

    def is_lost(self, serves: str) -> bool:
        """Never: every job has ended."""
        return False

    def give_up(self, serves: str) -> None:
        """Leave it: nothing runs any more."""


def without_processes() -> str | None:
    """Say why this system runs no worker processes; ``None`` where it does."""
    system: str = sys.platform
    if system == "linux":
        return None
    return f"worker processes need Linux, and this is {system}; engines run in the process of the command"


@contextmanager
def local(workers: int) -> Iterator[Pool]:
    """Give worker processes of this machine; all are ended with it, and what they started."""
    if (reason := without_processes()) is not None:
        print(f"{reason}: one that crashes or hangs ends the command; what is stored stays", file=sys.stderr)
        yield ThisProcess()
        return
    pool = LocalPool(workers)
    try:
        with _quiet_pipes():
            yield pool
    finally:
        pool.close()


@contextmanager
def _quiet_pipes() -> Iterator[None]:
    """Keep threads that read what workers send from printing a traceback where that is garbage: `is_lost` says so."""
    hook = threading.excepthook

    def quiet(problem: Any) -> None:
        if "message_manager_loop" not in problem.thread.name:
            hook(problem)

    threading.excepthook = quiet
    try:
        yield
    finally:
        threading.excepthook = hook


def _begin(name: str) -> None:
    """Begin a worker: Ctrl-C is the main process's, which ends workers; what engines print is lost; one thread each."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    prctl(SET_PARENT_DEATH_SIGNAL, signal.SIGKILL)
    prctl(SET_NAME, ctypes.c_char_p(name.encode()))
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)
    leave, worker = os._exit, os.getpid()
    os._exit = lambda code: leave(code or EXITED if os.getpid() == worker else code)  # type: ignore[assignment]
    os.environ |= {MARK: name, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def _by_one(function: Callable[..., Any], *arguments: Any) -> Any:
    """Run a job; a copy of its process that an engine has forked ends here: it would take jobs of the pool too."""
    worker = os.getpid()
    try:
        return function(*arguments)
    finally:
        if os.getpid() != worker:
            os._exit(EXITED)


def _end(name: str) -> list[int]:
    """End the processes that have a name, and those that they have started: nothing else; gives their numbers."""
    ended = []
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if _is_named(folder, name):
                os.kill(int(folder.name), signal.SIGKILL)
                ended.append(int(folder.name))
    return ended


def _forget(ended: Sequence[int]) -> None:
    """Wait for orphans among the processes that were ended: they are this process's children now."""
    for process in ended:
        with suppress(OSError):
            os.waitpid(process, 0)


def _is_named(folder: Path, name: str) -> bool:
    own = (folder / "comm").read_text().strip() == name
    return own or f"{MARK}={name}".encode() in (folder / "environ").read_bytes()
