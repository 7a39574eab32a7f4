"""Runs and their results: a crash, a hang or an exit is the result of its run alone."""

import signal
import time
import zlib
from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from typing import Any, NamedTuple

from pebble import ProcessExpired

from multibody_xval.engines.interface.registry import engine
from multibody_xval.scenarios.compute import SECONDS_A_RUN
from multibody_xval.scenarios.compute.batch import prepare, run_batch
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Result, Run, Status, failed
from multibody_xval.scenarios.running.processes import EXITED, GRACE, LOOK_SECONDS, Job, Pool
from multibody_xval.scenarios.store import Store, is_kept

PREPARATION_SECONDS = 300.0
"""Time limit of an engine's import, and of the compilation of its first step, unless it states its own."""

STEPS_OF_A_SEARCH = 24_000
"""Of a search for a steady state: sixty periods of 400."""

Kind = tuple[Config, int, int, str]
"""Configuration, steps, cells and kind of case that one simulation may take together."""

Ended = Callable[[dict[Run, Result]], Any]
"""Takes results."""


def run_missing(
    runs: Iterable[Run],
    store: Store,
    pool: Pool,
    ended: Ended = lambda _results: None,
    *,
    known: Ended = lambda _results: None,
    seconds_a_run: float = SECONDS_A_RUN,
    retry_failed: bool = False,
) -> dict[Run, Result]:
    """Give the results of all runs: from the store, and of those that are missing there from the pool.

    Every result is stored the moment it is there.

    Parameters
    ----------
    runs, store, pool
        What is asked for, where results are kept, and what computes those that are not there.
    ended, known
        Are told of results as they come, and before of those that need no run.
    seconds_a_run
        Time limit of a run [s]; what an engine needs to be imported and compiled is not part of it.
    retry_failed
        Run again what an engine failed at before.
    """
    runs = list(dict.fromkeys(runs))
    found = {run: own for run, own in store.known(runs).items() if is_kept(own, retry_failed=retry_failed)}
    found |= {run: own for run in runs if run not in found and (own := not_installed(run.config)) is not None}
    known(found)
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
    """Group runs that one simulation may take together, in the order in which they begin.

    The reference is first, which has results within a second; then the slowest, engines with default options. Any two
    are neighbours in a batch: an engine that takes one for the other is not to find the same friction there.
    """
    groups: dict[Kind, list[Run]] = defaultdict(list)
    for run in runs:
        groups[run.config, run.steps, run.case.cells, run.case.kind].append(run)
    found = []
    for kind in sorted(groups, key=_order):
        size, mixed = kind[0].batch_lanes, sorted(groups[kind], key=lambda run: zlib.crc32(run.text.encode()))
        found += [mixed[first : first + size] for first in range(0, len(mixed), size)]
    return found


def _order(kind: Kind) -> tuple[bool, bool, bool, int]:
    config, steps, *_ = kind
    return config != REFERENCE, config.engine == REFERENCE.engine, config.preset_name == "tuned", steps


class Attempt(NamedTuple):
    """A batch on its way; an empty one prepares its configuration."""

    batch: list[Run]
    config: Config
    last: bool = False

    @property
    def serves(self) -> str:
        """Give what its process serves."""
        return self.config.capabilities.package

    def job(self, seconds_a_run: float) -> Job:
        """Give what a pool is to do."""
        if self.batch:
            return run_batch, [self.batch], seconds_a_run * sum(map(length, self.batch)), self.serves
        return prepare, [self.config], preparation_seconds(self.config), self.serves

    def again(self, problem: BaseException) -> "list[Attempt]":
        """Give what is tried after a problem: every run alone; what has crashed alone, once more."""
        if len(self.batch) > 1:
            return [Attempt([run], self.config) for run in self.batch]
        return [] if self.last or isinstance(problem, TimeoutError) else [self._replace(last=True)]


def length(run: Run) -> float:
    """Give how many times as long as a steady state a run may take: a motion is as long as it is."""
    return 1.0 if isinstance(run.case, Case) else max(1.0, run.steps / STEPS_OF_A_SEARCH)


Running = dict["Future[Any]", tuple[Attempt, float]]
"""Attempts that have begun, with their deadlines."""


def completed(todo: Iterable[list[Run]], pool: Pool, seconds_a_run: float) -> Iterator[dict[Run, Result]]:
    """Give results as batches end. Runs of a batch that crashes or hangs are run alone; a crash alone, once more.

    The first job of a configuration prepares it, and its batches wait for that.
    """
    waiting: dict[Config, list[Attempt]] = defaultdict(list)
    for batch in todo:
        waiting[batch[0].config].append(Attempt(batch, batch[0].config))
    ready = deque(Attempt([], config) for config in waiting)
    running: Running = {}
    while ready or running:
        while ready and _may_begin(ready[0], running, pool.slots):
            attempt = ready.popleft()
            job = attempt.job(seconds_a_run)
            running[pool.submit(job)] = attempt, time.monotonic() + job[2] + GRACE
        for attempt, outcome in _ended(running, pool):
            if isinstance(outcome, BaseException):
                again, results = _after(attempt, outcome, waiting)
                ready.extendleft(reversed(again))
                yield results
            elif attempt.batch:
                yield dict(zip(attempt.batch, outcome, strict=True))
            else:
                ready.extendleft(reversed(waiting.pop(attempt.config)))


def _may_begin(attempt: Attempt, running: Running, slots: int) -> bool:
    """Whether an attempt may begin: a last one when nothing else runs, so that what it breaks is its own."""
    alone = attempt.last or any(own.last for own, _ in running.values())
    return not running if alone else len(running) < slots


def _after(
    attempt: Attempt, problem: BaseException, waiting: dict[Config, list[Attempt]]
) -> tuple[list[Attempt], dict[Run, Result]]:
    """Give what is tried after a problem, and the results of what is not."""
    if again := attempt.again(problem):
        return again, {}
    if not attempt.batch:
        result = failed(f"the engine could not be prepared: {reason_of(problem)}", circumstance=True)
        return [], {run: result for each in waiting.pop(attempt.config) for run in each.batch}
    return [], {attempt.batch[0]: failed(reason_of(problem), circumstance=was_killed(problem))}


def _ended(running: Running, pool: Pool) -> Iterator[tuple[Attempt, Any]]:
    """Wait until something has ended; gives that with what it returned or raised.

    Pools end what passes its limit themselves: one that does not is given up.
    """
    done, lost = set[Future[Any]](), set[str]()
    while not done and not lost:
        done = wait(running, timeout=LOOK_SECONDS, return_when=FIRST_COMPLETED).done
        now = time.monotonic()
        lost = {own.serves for own, end in running.values() if end <= now or pool.is_lost(own.serves)}
    for future in done:
        if future.cancelled():
            lost.add(running[future][0].serves)
            continue
        problem = future.exception()
        yield running.pop(future)[0], future.result() if problem is None else problem
    for serves in lost:
        pool.give_up(serves)
        for future in [future for future, (own, _) in running.items() if own.serves == serves]:
            yield running.pop(future)[0], BrokenExecutor()


def preparation_seconds(config: Config) -> float:
    """Give the limit on the import of an engine, and on the compilation of its first step [s]."""
    stated = engine(config.engine).preparation
    return max(PREPARATION_SECONDS, 0.0 if stated is None else stated.limit)


def was_killed(problem: BaseException) -> bool:
    """Whether a worker was killed from outside, or for want of memory, or is lost: it says nothing of its engine."""
    killed = isinstance(problem, ProcessExpired) and problem.exitcode == -signal.SIGKILL
    return killed or isinstance(problem, BrokenExecutor)


def reason_of(problem: BaseException) -> str:
    """Say in a line what has ended a worker."""
    if isinstance(problem, TimeoutError):
        return "no result within the time limit: it hangs, or is too slow"
    if isinstance(problem, BrokenExecutor):
        return "its process is lost, or what it sends is garbled"
    if isinstance(problem, ProcessExpired):
        code = 0 if problem.exitcode == EXITED else problem.exitcode or 0
        how = f"by signal {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
        return f"its process has ended {how}"
    return " ".join(f"{type(problem).__name__}: {problem}".split())
