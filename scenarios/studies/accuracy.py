"""Errors of the friction of engines: one row of numbers for every variant, against the exact motion."""

import math
import platform
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.parameters import Excitation, OperatingPoint
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.task import DEFAULT_EXCITATION, SteadyStateTask, versions_of
from multibody_xval.scenarios.tables import Column, markdown_lines, markdown_list, text_table
from multibody_xval.scenarios.verdicts.finding import TRANSMITTANCE
from multibody_xval.scenarios.verdicts.judge import metric_difference
from multibody_xval.scenarios.verdicts.proven import with_proven_level
from multibody_xval.scenarios.verdicts.steady_case import EXACT
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD, STICK_SLIP_POINTS

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
    """Errors of a variant; worst values over all certified points, NaN where there is none."""

    variant: Variant
    points_db: Mapping[int, float]
    """Largest transmittance error over the six stick–slip points [dB], by steps a period."""
    map_db: float
    map_median_db: float
    """Median of them [dB]."""
    worst_point: OperatingPoint | None
    """Largest transmittance error over the map [dB] and where, as (friction ratio, frequency ratio)."""
    stuck_fraction: float
    """Largest error of a contact's stuck fraction on the map."""
    median_transition: float
    largest_transition: float
    """|Time error| of matched transitions on the map, over the period."""
    transitions: int
    missed: int
    spurious: int
    """Transitions of the exact motion on the map; those that the variant misses, and those that it has beside them."""
    creep: float
    """Largest |ġ_T| within a stick, over ω U0."""
    order: float
    """In the time step: −slope of the root mean square error at the six points; NaN unless all are certified."""
    points: int
    certified: int
    """Number of points, and of those with a certified steady state."""
    blocked: str
    """Reason of the first blocked point; empty if there is none."""


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
    """Compare every variant with the exact motion."""
    tasks = {variant: accuracy_tasks(variant) for variant in variants}
    every = [*exact_tasks().values(), *(task for own in tasks.values() for task in own)]
    # Some engines take lanes of one time step together: neighbours in a batch have the same.
    every.sort(key=lambda task: (task.steps_per_period, task.frequency_ratio))
    results = dict(zip(every, evaluator.evaluate(every), strict=True))
    exact = {point: with_proven_level(task, results[task]) for point, task in exact_tasks().items()}
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
    errors = {point: error_db(result, exact[point]) for point, result in mapped.items()}
    matches = [result.matched(exact[point].transitions) for point, result in mapped.items()]
    times = [abs(error) for match in matches for error in match.time_errors]
    blocked = [result.reason for result in results.values() if result.status is ResultStatus.BLOCKED]
    return Accuracy(
        variant=variant,
        points_db={steps: _largest(_point_errors(certified, exact, steps)) for steps in ORDER_STEPS},
        map_db=_largest(errors.values()),
        map_median_db=float(np.median(list(errors.values()))) if errors else math.nan,
        worst_point=max(errors, key=lambda point: errors[point], default=None),
        stuck_fraction=_largest(result.stuck_difference(exact[point]) for point, result in mapped.items()),
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


def error_db(result: Result, exact: Result) -> float:
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
        error_db(result, exact[point_of(task)])
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


def _largest(values: Iterable[float]) -> float:
    return max(values, default=math.nan)


def _points(steps: int) -> Callable[[Accuracy], float]:
    return lambda row: row.points_db[steps]


ACCURACY_COLUMNS: tuple[Column[Accuracy], ...] = (
    Column("engine", lambda row: row.variant.engine),
    Column("formulation", lambda row: row.variant.formulation),
    Column("preset", lambda row: row.variant.preset_name),
    *(Column(f"points_{n}_db", _points(n), f"six points, {n} [dB]", "{:.3f}") for n in ORDER_STEPS[:2]),
    Column("map_db", lambda row: row.map_db, f"map, {ACCURACY_MAP_STEPS} [dB]", "{:.3f}"),
    Column("stuck_fraction_error", lambda row: row.stuck_fraction, "stuck fraction", "{:.3f}"),
    Column("median_transition_percent", lambda row: 100 * row.median_transition, "median [% T]", "{:.3f}"),
    Column("largest_transition_percent", lambda row: 100 * row.largest_transition, "max [% T]", "{:.2f}"),
    Column("missed", lambda row: row.missed),
    Column("spurious", lambda row: row.spurious),
    Column("transitions", lambda row: row.transitions, "of"),
    Column("creep", lambda row: row.creep, "creep [ω U0]", "{:.1e}"),
    Column("order", lambda row: row.order, pattern="{:.2f}"),
    Column("certified", lambda row: f"{row.certified}/{row.points}"),
)

PRINTED_COLUMNS: tuple[Column[Accuracy], ...] = (
    Column("variant", lambda row: str(row.variant), "engine:formulation:preset"),
    *ACCURACY_COLUMNS[3:],
)
"""On a terminal a variant has one column."""

ACCURACY_LEGEND = f"""\
How large are the errors of each engine, formulation and preset? An error is the largest absolute difference from the
exact, event-driven motion, over the points with a certified steady state. The columns:

- *six points*: error of the transmittance at six stick–slip points, with 400 and {ORDER_STEPS[1]} steps a period;
- *map*: the same at 4 friction ratios (0.1 … 1) × 14 frequency ratios (0.3 … 1.6), with {ACCURACY_MAP_STEPS} steps;
- *stuck fraction*: error of a contact's stuck fraction, on the map;
- *median*, *max*: error of the times of transitions between stick and slip, in percent of the period T, on the map;
- *missed*, *spurious*, *of*: transitions that the engine lacks, that only the engine has, and all of the exact motion;
- *creep*: largest velocity within a stick, over ω U0;
- *order*: order of the error in the time step, from {", ".join(map(str, ORDER_STEPS))} steps;
- *certified*: points whose steady state repeats to the engine's residual.
"""


def accuracy_document(rows: Sequence[Accuracy], command: str) -> str:
    """Give the table as a document, with how it was made."""
    lines = ["# Accuracy of the engines", "", ACCURACY_LEGEND, f"Made by `{command}`.", ""]
    lines += markdown_lines(text_table(ACCURACY_COLUMNS, rows))
    lines += ["", "Where the largest error on the map is, and what has no certified steady state:", ""]
    lines += markdown_list(text for row in rows if (text := remark(row)))
    lines += [
        "",
        f"Versions: {versions_of(row.variant.engine for row in rows)}; Python {platform.python_version()}.",
        "",
    ]
    return "\n".join(lines)


def remark(accuracy: Accuracy) -> str:
    """Give the worst point, uncertified points and the reason of blocked ones, in words."""
    parts = []
    if accuracy.worst_point is not None:
        parts.append(f"worst at ({accuracy.worst_point[0]:g}, {accuracy.worst_point[1]:g})")
    if accuracy.certified < accuracy.points:
        parts.append(f"{accuracy.points - accuracy.certified} of {accuracy.points} points are not certified")
    if accuracy.blocked:
        parts.append(f"blocked: {accuracy.blocked}")
    return f"{accuracy.variant}: {'; '.join(parts)}" if parts else ""
