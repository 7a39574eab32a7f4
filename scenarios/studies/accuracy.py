"""Errors of the friction of engines: one row of numbers for every variant, against the exact motion."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from engines.interface.variant import Variant
from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS
from reference_lcp.chain.step_limits import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.observables.transition_matching import match_transitions
from scenarios.execution.evaluator import Evaluator
from scenarios.tasks.parameters import Excitation, OperatingPoint
from scenarios.tasks.result import Result, ResultStatus
from scenarios.tasks.task import DEFAULT_EXCITATION, SteadyStateTask
from scenarios.verdicts.finding import TRANSMITTANCE
from scenarios.verdicts.judge import metric_difference
from scenarios.verdicts.steady_case import EXACT

ACCURACY_FRICTION_RATIOS = (0.1, 0.3, 0.6, 1.0)
ACCURACY_FREQUENCY_RATIOS = tuple(round(0.3 + 0.1 * k, 1) for k in range(14))
"""Where the map of an engine's error is taken: friction ratios of figure 3, frequency ratios from 0.3 to 1.6."""

ACCURACY_MAP: tuple[OperatingPoint, ...] = tuple(
    OperatingPoint(friction, eta) for friction in ACCURACY_FRICTION_RATIOS for eta in ACCURACY_FREQUENCY_RATIOS
)

SIX_POINTS = tuple(OperatingPoint(*point) for point in STICK_SLIP_POINTS)
"""Points at which contacts stick and slip; the order in the time step is fitted there."""

ACCURACY_POINTS: tuple[OperatingPoint, ...] = tuple(dict.fromkeys((*SIX_POINTS, *ACCURACY_MAP)))
"""Every point at which engines are compared with the exact motion."""

ACCURACY_MAP_STEPS = 800
"""Steps a period of the map."""

ORDER_STEPS = (400, 800, 1600)
"""Steps a period of the six points, through which the order in the time step is fitted."""


@dataclass(frozen=True)
class Accuracy:
    """Errors of a variant; worst values over all certified points, NaN where there is none.

    Parameters
    ----------
    variant
        The variant.
    points_db
        Largest transmittance error over the six stick–slip points [dB], by steps a period.
    map_db, worst_point
        Largest transmittance error over the map [dB] and where, as (friction ratio, frequency ratio).
    map_median_db
        Median of them [dB].
    stuck_fraction
        Largest error of a contact's stuck fraction on the map.
    median_transition, largest_transition
        |Time error| of matched transitions on the map, over the period.
    transitions, missed, spurious
        Transitions of the exact motion on the map; those that the variant misses, and those that it has beside them.
    creep
        Largest |ġ_T| within a stick, over ω U0.
    order
        In the time step: −slope of the root mean square error at the six points; NaN unless all are certified.
    points, certified
        Number of points, and of those with a certified steady state.
    blocked
        Reason of the first blocked point; empty if there is none.
    """

    variant: Variant
    points_db: Mapping[int, float]
    map_db: float
    map_median_db: float
    worst_point: OperatingPoint | None
    stuck_fraction: float
    median_transition: float
    largest_transition: float
    transitions: int
    missed: int
    spurious: int
    creep: float
    order: float
    points: int
    certified: int
    blocked: str


def accuracy_tasks(variant: Variant) -> list[SteadyStateTask]:
    """Give the tasks of a variant: the six points at three steps, and the map."""
    runs = [(point, steps) for steps in ORDER_STEPS for point in SIX_POINTS]
    runs += [(point, ACCURACY_MAP_STEPS) for point in ACCURACY_MAP]
    return [task_at(variant, point, steps) for point, steps in dict.fromkeys(runs)]


def exact_tasks() -> dict[OperatingPoint, SteadyStateTask]:
    """Give the tasks of the exact motion at every point."""
    return {point: task_at(EXACT, point, MINIMUM_STEPS_PER_PERIOD) for point in ACCURACY_POINTS}


def task_at(
    variant: Variant, point: OperatingPoint, steps: int, excitation: Excitation = DEFAULT_EXCITATION
) -> SteadyStateTask:
    """Give the task of a variant at a point of the canonical chain."""
    return SteadyStateTask(
        variant=variant,
        friction_ratio=point.friction_ratio,
        frequency_ratio=point.frequency_ratio,
        steps_per_period=steps,
        excitation=excitation,
    )


def accuracies(variants: Sequence[Variant], evaluator: Evaluator) -> list[Accuracy]:
    """Compare every variant with the exact motion.

    Parameters
    ----------
    variants
        Which ones.
    evaluator
        Gives the results; all tasks go to it at once, those of the exact motion too.

    Returns
    -------
    list of Accuracy
        One a variant, in order.
    """
    tasks = {variant: accuracy_tasks(variant) for variant in variants}
    every = [*exact_tasks().values(), *(task for own in tasks.values() for task in own)]
    results = dict(zip(every, evaluator.evaluate(every), strict=True))
    exact = {point: results[task] for point, task in exact_tasks().items()}
    return [accuracy_of(variant, {task: results[task] for task in own}, exact) for variant, own in tasks.items()]


def accuracy_of(
    variant: Variant, results: Mapping[SteadyStateTask, Result], exact: Mapping[OperatingPoint, Result]
) -> Accuracy:
    """Compare one variant's results of `accuracy_tasks` with the exact motion, where that is certified."""
    certified = {
        task: result for task, result in results.items() if result.converged and exact[point_of(task)].converged
    }
    mapped = {
        point: result
        for task, result in certified.items()
        if (point := point_of(task)) in ACCURACY_MAP and task.steps_per_period == ACCURACY_MAP_STEPS
    }
    errors = {point: transmittance_error_db(result, exact[point]) for point, result in mapped.items()}
    matches = [
        match_transitions(result.transitions, exact[point].transitions, result.period)
        for point, result in mapped.items()
    ]
    times = [abs(error) for match in matches for error in match.time_errors]
    blocked = [result.reason for result in results.values() if result.status is ResultStatus.BLOCKED]
    return Accuracy(
        variant=variant,
        points_db={steps: _largest(_point_errors(certified, exact, steps)) for steps in ORDER_STEPS},
        map_db=_largest(errors.values()),
        map_median_db=float(np.median(list(errors.values()))) if errors else math.nan,
        worst_point=max(errors, key=lambda point: errors[point], default=None),
        stuck_fraction=_largest(_stuck_error(result, exact[point]) for point, result in mapped.items()),
        median_transition=float(np.median(times)) if times else math.nan,
        largest_transition=_largest(times),
        transitions=sum(len(exact[point].transitions) for point in mapped),
        missed=sum(len(match.missed) for match in matches),
        spurious=sum(len(match.spurious) for match in matches),
        creep=_largest(max(result.creep) for result in certified.values()),
        order=_order(certified, exact),
        points=len(results),
        certified=len(certified),
        blocked=blocked[0] if blocked else "",
    )


def transmittance_error_db(result: Result, exact: Result) -> float:
    """|Difference| of transmittance [dB], on the scale of `TRANSMITTANCE`."""
    return abs(metric_difference(TRANSMITTANCE, result.transmittance_db, exact.transmittance_db))


def point_of(task: SteadyStateTask) -> OperatingPoint:
    """Give the friction and the frequency ratio of a task about a chain of equal friction."""
    assert isinstance(task.friction_ratio, float)
    return OperatingPoint(task.friction_ratio, task.frequency_ratio)


def _point_errors(
    certified: Mapping[SteadyStateTask, Result], exact: Mapping[OperatingPoint, Result], steps: int
) -> list[float]:
    """Transmittance errors at those of the six points that are certified at so many steps [dB]."""
    return [
        transmittance_error_db(result, exact[point_of(task)])
        for task, result in certified.items()
        if task.steps_per_period == steps and point_of(task) in SIX_POINTS
    ]


def _order(certified: Mapping[SteadyStateTask, Result], exact: Mapping[OperatingPoint, Result]) -> float:
    errors = [_point_errors(certified, exact, steps) for steps in ORDER_STEPS]
    if any(len(own) < len(SIX_POINTS) for own in errors):
        return math.nan
    size = [math.sqrt(np.mean(np.square(own))) for own in errors]
    if min(size) == 0:
        return math.nan
    return float(-np.polyfit(np.log(ORDER_STEPS), np.log(size), 1)[0])


def _stuck_error(result: Result, exact: Result) -> float:
    return float(np.max(np.abs(np.subtract(result.stuck_fraction, exact.stuck_fraction))))


def _largest(values: Iterable[float]) -> float:
    return max(values, default=math.nan)
