"""The one number by which engines are compared: the largest error of transmittance at five points.

README, page and documentation quote it. The five points are those of `accuracy.ACCURACY_MAP` at which one preset
of an engine or another is farthest from the truth, so that the largest error there is that of the whole map.
"""

from collections.abc import Sequence

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.parameters import Excitation, OperatingPoint
from multibody_xval.scenarios.runs.result import ResultStatus
from multibody_xval.scenarios.runs.task import DEFAULT_EXCITATION, SteadyStateTask
from multibody_xval.scenarios.studies.accuracy import ACCURACY_MAP_STEPS
from multibody_xval.scenarios.studies.figure3 import figure3
from multibody_xval.scenarios.sweeps.compared import ComparedSweep
from multibody_xval.scenarios.sweeps.point import GivesResults, Point
from multibody_xval.scenarios.sweeps.sweep import Case, GridPoint, Sweep
from multibody_xval.scenarios.sweeps.truths import with_truths
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE

HEADLINE_POINTS = (
    *(OperatingPoint(0.1, eta) for eta in (1.4, 1.5, 1.6)),
    OperatingPoint(0.3, 1.5),
    OperatingPoint(1.0, 1.4),
)
"""Deep within the band: with little friction, where engines differ most, and with much."""

HEADLINE_STEPS = ACCURACY_MAP_STEPS
"""Steps a period."""


def headline_sweep(variants: Sequence[Variant], excitation: Excitation = DEFAULT_EXCITATION) -> Sweep:
    """Give the sweep of the reference and variants whose grid holds the five points."""
    frictions, etas = (sorted(set(values)) for values in zip(*HEADLINE_POINTS, strict=True))
    return figure3(variants, frictions, etas, steps_per_period=HEADLINE_STEPS, excitation=excitation)


def headline_tasks(sweep: Sweep) -> dict[GridPoint, SteadyStateTask]:
    """Give the tasks of a `headline_sweep` at the five points."""
    places = [(own, Case.of(friction_ratio=f), eta) for own in sweep.variants for f, eta in HEADLINE_POINTS]
    return {place: sweep.task(*place) for place in places}


def headline_points(
    variants: Sequence[Variant], evaluator: GivesResults, excitation: Excitation = DEFAULT_EXCITATION
) -> tuple[Point, ...]:
    """Evaluate the reference and variants at the five points, with the truth; without those that have no result."""
    sweep = headline_sweep(variants, excitation)
    tasks = headline_tasks(sweep)
    results = dict(zip(tasks, evaluator.evaluate(list(tasks.values())), strict=True))
    points = [
        Point(
            variant=variant, case=case, frequency_ratio=eta, result=result,
            reference=results[REFERENCE, case, eta], converged=results[CONVERGED, case, eta],
        )
        for (variant, case, eta), result in results.items()
    ]  # fmt: skip
    known = with_truths(ComparedSweep(sweep, points), evaluator).points
    return tuple(point for point in known if point.result.status is not ResultStatus.MISSING)
