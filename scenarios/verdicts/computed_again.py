"""A random part of a store, computed again here: whether what somebody proposes comes out elsewhere too."""

import math
import random
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from pydantic import TypeAdapter, ValidationError

from reference_lcp.errors import ParameterError
from reference_lcp.validation import checked_count, checked_scalar
from scenarios.runs.result import Result
from scenarios.runs.store import ResultStore
from scenarios.runs.task import SteadyStateTask
from scenarios.verdicts.regression import StoreComparison, compare_stores
from scenarios.verdicts.stored import read_all

_TASK = TypeAdapter(SteadyStateTask)


def sampled(file: Path, part: float, seed: int) -> list[tuple[SteadyStateTask, Result]]:
    """Draw steady states of a store, at least one.

    Raises
    ------
    ParameterError
        If a number is outside its range, or the store has no steady state that this suite can compute.
    """
    checked_scalar("part", part, "> 0")
    checked_count("seed", seed, 0)
    if part > 1:
        raise ParameterError(f"part = {part:g}; allowed: > 0, <= 1")
    known = []
    for stored in read_all(file).values():
        try:
            known.append((_TASK.validate_python(dict(stored.task)), stored.result))
        except (ValidationError, ParameterError):
            continue  # a motion, or an engine that is not registered here
    if not known:
        raise ParameterError(f"{file} has no steady state that can be computed here; allowed: another store")
    return random.Random(seed).sample(known, math.ceil(part * len(known)))


def compared_again(
    sample: Sequence[tuple[SteadyStateTask, Result]], compute: Callable[[list[SteadyStateTask]], Sequence[Result]]
) -> StoreComparison:
    """Compare results of a store with what their tasks give now."""
    tasks = [task for task, _ in sample]
    with TemporaryDirectory() as folder:
        before, now = Path(folder, "before.sqlite"), Path(folder, "now.sqlite")
        with ResultStore(before) as stored:
            stored.keep(sample)
        with ResultStore(now) as stored:
            stored.keep(zip(tasks, compute(tasks), strict=True))
        return compare_stores(before, now)
