"""Runs in worker processes: a crash, a hang or an exit is the result of its run alone, and no process stays behind."""

import ctypes
import multiprocessing
import os
import signal
import sys
import time
import uuid
import zlib
from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from pebble import ProcessExpired, ProcessPool

from multibody_xval.engines.interface.registry import engine
from multibody_xval.scenarios import compute
from multibody_xval.scenarios.compute import SECONDS_A_RUN
from multibody_xval.scenarios.compute.batch import prepare, run_batch
from multibody_xval.scenarios.compute.prctl import SET_CHILD_SUBREAPER, SET_NAME, SET_PARENT_DEATH_SIGNAL, prctl
from multibody_xval.scenarios.model import REFERENCE, Config, Result, Run, Status, failed
from multibody_xval.scenarios.store import Store, is_kept
from reference_lcp.errors import ParameterError, shown

PREPARATION_SECONDS = 300.0
"""Time limit of an engine's import, and of the compilation of its first step, unless it states its own."""

GRACE = 20.0
"""Seconds after a limit at which a pool that has not ended the run itself is given up: its pipe is stuck or garbled."""

Job = tuple[Callable[..., Any], Sequence[Any], float, str]
"""A function, its arguments, its time limit [s], and the name of what its process serves."""


class Pool(Protocol):
    """What runs functions somewhere else."""

    slots: int
    """How many it runs at once."""

    def submit(self, job: Job) -> "Future[Any]":
        """Start a job."""

    def give_up(self, serves: str) -> None:
        """End the processes of one engine, whose jobs never end by themselves."""


class LocalPool:
    """Worker processes of this machine, forked from one that has loaded the kernels.

    A process serves one engine: what one does to its process, such as to the rounding of its processor, is no other's.
    """

    def __init__(self, workers: int):
        from multiprocessing import forkserver  # which other systems lack

        from multibody_xval.scenarios.compute.without_main import WithoutMain

        self.slots = workers
        self._pools: dict[str, ProcessPool] = {}
        self._names: dict[str, str] = {}
        self._context = WithoutMain()
        self._context.set_forkserver_preload([f"{compute.__name__}.{name}" for name in ("ends_with_parent", "warm")])
        forkserver.ensure_running()  # by this thread: it ends with that
        prctl(SET_CHILD_SUBREAPER, 1)

    def submit(self, job: Job) -> "Future[Any]":
        """Start a job in a process that serves its engine alone."""
        function, arguments, limit, serves = job
        if serves not in self._pools:
            name = self._names[serves] = f"{WORKERS}{uuid.uuid4().hex[:10]}"
            self._pools[serves] = ProcessPool(self.slots, initializer=_begin, initargs=[name], context=self._context)
        return self._pools[serves].schedule(function, args=arguments, timeout=limit)

    def give_up(self, serves: str) -> None:
        """End all processes of an engine; the next job begins in new ones."""
        self._pools.pop(serves, None)
        _end(self._names.pop(serves))

    def close(self) -> None:
        """End all workers, and whatever they have started."""
        for pool in self._pools.values():
            pool.stop()  # type: ignore[no-untyped-call]
        for name in self._names.values():
            _end(name)
        for pool in self._pools.values():
            pool.join(GRACE)


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
        yield pool
    finally:
        pool.close()


WORKERS = "xval-"
"""How names of workers begin."""

MARK = "MULTIBODY_XVAL_POOL"
"""Variable in the environment of workers that has the same name, which programs that they start inherit too."""


def _begin(name: str) -> None:
    """Begin a worker: Ctrl-C is the main process's, which ends workers; one thread a process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    prctl(SET_PARENT_DEATH_SIGNAL, signal.SIGKILL)
    prctl(SET_NAME, ctypes.c_char_p(name.encode()))
    os.environ |= {MARK: name, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def _end(name: str) -> None:
    """End the processes that have a name, and those that they have started: nothing else."""
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if _is_named(folder, name):
                os.kill(int(folder.name), signal.SIGKILL)
                os.waitpid(int(folder.name), 0)  # of the orphans, which are this process's children now


def _is_named(folder: Path, name: str) -> bool:
    own = (folder / "comm").read_text().strip() == name
    return own or f"{MARK}={name}".encode() in (folder / "environ").read_bytes()


class DaskPool:
    """The workers of a dask cluster, each of which runs what it gets in processes of its own machine."""

    def __init__(self, client: Any):
        self._executor = client.get_executor(pure=False, retries=0)
        self.slots = max(1, len(client.scheduler_info()["workers"]))

    def submit(self, job: Job) -> "Future[Any]":
        """Start a job on any worker."""
        return self._executor.submit(isolated, job)

    def give_up(self, serves: str) -> None:
        """Leave it: workers end what passes its limit themselves."""


@contextmanager
def dask(address: str) -> Iterator[DaskPool]:
    """Give the workers of a dask cluster that runs already; it and its workers have to be trusted."""
    from distributed import Client

    try:
        client = Client(address, timeout="15s")  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as problem:
        reason = " ".join(str(problem).split())
        raise ParameterError(
            f"scheduler = {shown(address)} cannot be reached: {reason}; allowed: the address of one that runs"
        ) from None
    with client:
        yield DaskPool(client)


def isolated(job: Job) -> Any:
    """Run a job in a worker process that is kept from call to call; what it raises is raised here."""
    if not _KEPT:
        multiprocessing.current_process()._config["daemon"] = False  # type: ignore[attr-defined]  # dask's has children
        _KEPT.append(LocalPool(1))
    try:
        return _KEPT[0].submit(job).result(job[2] + GRACE)
    except TimeoutError:
        _KEPT[0].give_up(job[3])
        raise


_KEPT: list[LocalPool] = []
"""The pool of a worker of dask."""

Ended = Callable[[dict[Run, Result]], Any]
"""Takes results that have just been computed, or found in the store."""


def run_missing(
    runs: Iterable[Run],
    store: Store,
    pool: Pool,
    ended: Ended = lambda _results: None,
    *,
    seconds_a_run: float = SECONDS_A_RUN,
    retry_failed: bool = False,
) -> dict[Run, Result]:
    """Give the results of all runs: from the store, and of those that are missing there from the pool.

    Every result is stored the moment it is there.

    Parameters
    ----------
    runs, store, pool
        What is asked for, where results are kept, and what computes those that are not there.
    ended
        Is told of results as they come.
    seconds_a_run
        Time limit of a run [s]; what an engine needs to be imported and compiled is not part of it.
    retry_failed
        Run again what an engine failed at before.
    """
    runs = list(dict.fromkeys(runs))
    found = {run: own for run, own in store.known(runs).items() if is_kept(own, retry_failed=retry_failed)}
    found |= {run: own for run in runs if run not in found and (own := not_installed(run.config)) is not None}
    ended(found)
    for results in completed(batches(run for run in runs if run not in found), pool, seconds_a_run):
        store.add(results)
        found |= results
        ended(results)
    return found


def not_installed(config: Config) -> Result | None:
    """Give the result of a run whose engine is not there; ``None`` where it is."""
    reason = config.unavailable_reason
    return None if reason is None else Result(status=Status.UNSUPPORTED, reason=f"not installed: {reason}")


def batches(runs: Iterable[Run]) -> list[list[Run]]:
    """Group runs that one simulation may take together; the slowest kinds, engines with default options, first.

    Any two are neighbours in a batch: an engine that takes one for the other is not to find the same friction there.
    """
    groups: dict[tuple[Config, int, int], list[Run]] = defaultdict(list)
    for run in runs:
        groups[run.config, run.steps, run.case.cells].append(run)
    found = []
    for kind in sorted(groups, key=_quickness):
        size, mixed = kind[0].batch_lanes, sorted(groups[kind], key=lambda run: zlib.crc32(run.text.encode()))
        found += [mixed[first : first + size] for first in range(0, len(mixed), size)]
    return found


def _quickness(kind: tuple[Config, int, int]) -> tuple[bool, bool, int]:
    config, steps, _ = kind
    return config.engine == REFERENCE.engine, config.preset_name == "tuned", steps


class Attempt(NamedTuple):
    """A batch on its way; an empty one prepares its configuration."""

    batch: list[Run]
    config: Config
    last: bool = False

    def job(self, seconds_a_run: float) -> Job:
        """Give what a pool is to do."""
        serves = self.config.capabilities.package
        if self.batch:
            return run_batch, [self.batch], seconds_a_run * len(self.batch), serves
        return prepare, [self.config], preparation_seconds(self.config), serves

    def again(self, problem: BaseException) -> "list[Attempt]":
        """Give what is tried after a problem: every run alone, or a run that has crashed alone once more."""
        if len(self.batch) > 1:
            return [Attempt([run], self.config) for run in self.batch]
        return [] if self.last or isinstance(problem, TimeoutError) else [Attempt(self.batch, self.config, last=True)]


class Running(NamedTuple):
    """An attempt that has begun."""

    attempt: Attempt
    serves: str
    deadline: float


def completed(todo: Iterable[list[Run]], pool: Pool, seconds_a_run: float) -> Iterator[dict[Run, Result]]:
    """Give results as batches end. Runs of a batch that crashes or hangs are run alone; a crash alone, once more.

    The first job of a configuration prepares it, and its batches wait for that.
    """
    waiting: dict[Config, list[Attempt]] = defaultdict(list)
    for batch in todo:
        waiting[batch[0].config].append(Attempt(batch, batch[0].config))
    ready = deque(Attempt([], config) for config in waiting)
    running: dict[Future[Any], Running] = {}
    while ready or running:
        while ready and len(running) < pool.slots:
            attempt = ready.popleft()
            job = attempt.job(seconds_a_run)
            running[pool.submit(job)] = Running(attempt, job[3], time.monotonic() + job[2] + GRACE)
        for (attempt, _, _), outcome in _ended(running, pool):
            if isinstance(outcome, BaseException):
                again, results = _after(attempt, outcome, waiting)
                ready.extendleft(reversed(again))
                yield results
            elif attempt.batch:
                yield dict(zip(attempt.batch, outcome, strict=True))
            else:
                ready.extendleft(reversed(waiting.pop(attempt.config)))


def _after(
    attempt: Attempt, problem: BaseException, waiting: dict[Config, list[Attempt]]
) -> tuple[list[Attempt], dict[Run, Result]]:
    """Give what is tried after a problem, and the results of what is not."""
    if not attempt.batch:
        result = failed(f"the engine could not be prepared: {reason_of(problem)}", circumstance=True)
        return [], {run: result for each in waiting.pop(attempt.config) for run in each.batch}
    if again := attempt.again(problem):
        return again, {}
    return [], {attempt.batch[0]: failed(reason_of(problem), circumstance=was_killed(problem))}


def _ended(running: dict[Future[Any], Running], pool: Pool) -> Iterator[tuple[Running, Any]]:
    """Wait until something has ended; gives that with what it returned or raised. What never ends is given up."""
    first = min(own.deadline for own in running.values())
    done = wait(running, timeout=max(0.0, first - time.monotonic()), return_when=FIRST_COMPLETED).done
    for future in done:
        problem = future.exception()
        yield running.pop(future), future.result() if problem is None else problem
    late = {own.serves for own in running.values() if own.deadline <= time.monotonic()}
    for serves in late:
        pool.give_up(serves)
        for future in [future for future, own in running.items() if own.serves == serves]:
            yield running.pop(future), TimeoutError()


def preparation_seconds(config: Config) -> float:
    """Give the limit on the import of an engine, and on the compilation of its first step [s]."""
    stated = engine(config.engine).preparation
    return max(PREPARATION_SECONDS, 0.0 if stated is None else stated.limit)


def was_killed(problem: BaseException) -> bool:
    """Whether a worker was killed from outside, or for want of memory, which says nothing of its engine."""
    return isinstance(problem, ProcessExpired) and problem.exitcode == -signal.SIGKILL


def reason_of(problem: BaseException) -> str:
    """Say in a line what has ended a worker."""
    if isinstance(problem, TimeoutError):
        return "no result within the time limit: it hangs, or is too slow"
    if isinstance(problem, ProcessExpired):
        code = problem.exitcode or 0
        how = f"by signal {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
        return f"its process has ended {how}"
    return " ".join(f"{type(problem).__name__}: {problem}".split())
