"""Tasks that tests of runs ask for, and the processes that they look at."""

import contextlib
import resource
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.executor import Executor, InProcessExecutor
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.runs.task import SteadyStateTask


def steady(
    frequency_ratio: float = 0.9, variant: Variant | str = "reference", cells: int = 2, **more
) -> SteadyStateTask:
    """Give a task of a short chain, with friction ratio 0.3 unless `more` says otherwise."""
    variant = Variant.parse(variant) if isinstance(variant, str) else variant
    usual = {"friction_ratio": 0.3, "ratios": ChainRatios(cells=cells)}
    return SteadyStateTask(variant=variant, frequency_ratio=frequency_ratio, **(usual | more))


def certified(cells: int = 2, **more) -> Result:
    """Give a certified result of a chain whose contacts slip all the time."""
    usual = {"status": "converged", "stuck_fraction": (0.0,) * cells, "creep": (0.0,) * cells}
    return Result(**(usual | more))


class Invented(InProcessExecutor):
    """Gives results without a computation, and notes what it has run."""

    def __init__(self, result: Callable[[SteadyStateTask], Result]):
        self.result, self.ran = result, []

    def run(self, batches):
        for batch in batches:
            self.ran += batch
            yield batch, [self.result(task) for task in batch]


def running(process: int) -> bool:
    """Whether a process is there, other than as an entry that nobody has read."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def eventually(condition: Callable[[], bool], within: float) -> bool:
    """Whether something comes true within so many seconds."""
    until = time.monotonic() + within
    while not (true := condition()) and time.monotonic() < until:
        time.sleep(0.01)
    return true


def ended(processes: Iterable[int], within: float) -> bool:
    """Whether all of these end within so many seconds."""
    return eventually(lambda: not any(map(running, processes)), within)


def evaluated(
    engines: Iterable[str], ratios: Iterable[float], executor: Executor, store: Path | None = None
) -> dict[tuple[str, float], Result]:
    """Evaluate tasks of these engines at these frequency ratios, all together; gives results by engine and ratio."""
    tasks = {(name, eta): steady(eta, name) for name in engines for eta in ratios}
    with opened_store(store) as opened, Evaluator(opened, executor) as evaluator:
        return dict(zip(tasks, evaluator.evaluate(list(tasks.values())), strict=True))


def statuses(results: dict[tuple[str, float], Result]) -> dict[tuple[str, float], str]:
    """Give how each task ended."""
    return {place: str(result.status) for place, result in results.items()}


def numbers(engines: Iterable[str], ratios: Iterable[float], executor: Executor) -> list[tuple[object, ...]]:
    """Evaluate tasks, see `evaluated`; gives what must not depend on who runs them, bit for bit."""
    results = evaluated(engines, ratios, executor).values()
    return [(result.transmittance_db, result.residual, result.transitions) for result in results]


@contextlib.contextmanager
def files_up_to(size: int) -> Iterator[None]:
    """Let no file become larger than this [bytes]: it stands for a disk that is full."""
    old = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, old[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
