"""Whether the engines of a sweep agree with the reference, point by point."""

import math
from collections import Counter
from dataclasses import dataclass, field, replace

from engines.interface.variant import Variant
from scenarios.execution.store import ResultStore
from scenarios.sweeps.sweep import Sweep
from scenarios.tasks.result import Result
from scenarios.tasks.task import SteadyStateTask
from scenarios.verdicts.finding import TRANSMITTANCE
from scenarios.verdicts.judge import decide, missing
from scenarios.verdicts.verdict import Comparison, Tolerance, Verdict

BASELINES = (Variant("reference", preset_name="converged"), Variant("reference"))
"""Whom engines are compared with: the first of these that takes part."""


def baseline_of(sweep: Sweep) -> Variant | None:
    """Give whom the engines of a sweep are compared with; ``None`` if the reference takes no part."""
    return next((baseline for baseline in BASELINES if baseline in sweep.variants), None)


@dataclass
class Verdicts:
    """How one variant compares.

    Parameters
    ----------
    counts
        Points by verdict; those that either has not answered are not among them.
    largest
        Largest difference [dB] where both have a steady state, and where it is; ``None`` without any.
    """

    counts: Counter[Verdict] = field(default_factory=Counter)
    largest: tuple[float, SteadyStateTask] | None = None

    def add(self, question: SteadyStateTask, comparison: Comparison) -> None:
        """Count a point."""
        self.counts[comparison.verdict] += 1
        size = abs(comparison.difference)
        if not math.isnan(size) and (self.largest is None or size > self.largest[0]):
            self.largest = size, question


def verdicts(sweep: Sweep, store: ResultStore, tolerance_db: float) -> dict[Variant, Verdicts]:
    """Compare what the store knows of every variant with the reference at the same points.

    Parameters
    ----------
    sweep
        The points; the reference takes part.
    store
        Where the answers are.
    tolerance_db
        Largest difference that counts as agreement [dB], on the scale of `TRANSMITTANCE`.
    """
    baseline = baseline_of(sweep)
    if baseline is None:
        return {}
    found = {variant: Verdicts() for variant in sweep.variants if variant != baseline}
    for variant, counted in found.items():
        own = list(replace(sweep, variants=(variant,)).questions())
        others = replace(sweep, variants=(baseline,)).questions()
        for question, answer, right in zip(own, store.results(own), store.results(others), strict=True):
            if answer is not None and right is not None:
                counted.add(question, _compare(answer, right, tolerance_db))
    return found


def _compare(result: Result, expected: Result, tolerance_db: float) -> Comparison:
    """Compare two steady states at one point, by a tolerance that is given."""
    gap = missing("engine", [result]) or missing("reference", [expected])
    if gap is not None:
        return gap
    numbers = result.transmittance_db, expected.transmittance_db
    return decide(TRANSMITTANCE, *numbers, Tolerance(given=tolerance_db))
