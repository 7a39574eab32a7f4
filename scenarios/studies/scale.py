"""Error over the scale of time: a chain whose ratios are all the same, and whose springs are softer or stiffer.

The exact motion and the reference's know no scale; an engine whose friction has a time constant in seconds does.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from engines.interface.variant import Variant
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.parameters import OperatingPoint
from scenarios.runs.task import SteadyStateTask
from scenarios.studies.accuracy import error_db, task_at
from scenarios.verdicts.proven import with_proven_level
from scenarios.verdicts.steady_case import EXACT

SCALE_POINT = OperatingPoint(0.1, 1.6)
"""Where the defaults of MuJoCo and PyBullet err most; see `scenarios.studies.accuracy`."""

STIFFNESSES = (0.01, 0.1, 1.0, 10.0, 100.0)
"""Of all springs over those of the canonical chain, 1 kN/m: the drive is at 0.8, 2.5, 8.1, 25 and 80 Hz."""

STEPS = 400
"""A period, at every frequency."""


@dataclass(frozen=True)
class ScalePoint:
    """A variant at one scale."""

    variant: Variant
    hertz: float
    """Frequency of the drive [Hz]."""
    error_db: float
    """Of transmittance to the exact motion [dB]; NaN without a certified steady state."""


def scaled_task(variant: Variant, stiffness: float) -> SteadyStateTask:
    """Give the task at `SCALE_POINT` with springs, dashpots and friction for so many times the stiffness."""
    task = task_at(variant, SCALE_POINT, STEPS)
    ratios = replace(task.ratios, chain_stiffness_ratio=stiffness)
    # the friction ratio is over the canonical stiffness
    return replace(task, ratios=ratios, friction_ratio=SCALE_POINT.friction_ratio * stiffness)


def scale_tasks(variants: Sequence[Variant]) -> list[SteadyStateTask]:
    """Give the tasks of all variants at all scales."""
    return [scaled_task(variant, stiffness) for variant in variants for stiffness in STIFFNESSES]


def scale_study(variants: Sequence[Variant], evaluator: Evaluator) -> tuple[ScalePoint, ...]:
    """Compare variants with the exact motion, by variant and ascending frequency."""
    if not variants:
        return ()  # nothing is asked for then
    tasks, truth = scale_tasks(variants), task_at(EXACT, SCALE_POINT, STEPS)
    motion, *results = evaluator.evaluate([truth, *tasks])
    exact = with_proven_level(truth, motion)
    return tuple(
        ScalePoint(
            task.variant,
            task.setting()[1].angular_frequency / (2 * math.pi),
            error_db(result, exact) if result.converged and exact.converged else math.nan,
        )
        for task, result in zip(tasks, results, strict=True)
    )
