"""Cost of accuracy: error, cost of a step and time to the steady state, at several step sizes."""

import math
import platform
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from statistics import median

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.parameters import Excitation, OperatingPoint
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.task import DEFAULT_EXCITATION, SteadyStateTask, versions_of
from multibody_xval.scenarios.studies.accuracy import ORDER_STEPS, SIX_POINTS, error_db, point_of, task_at
from multibody_xval.scenarios.tables import Column, markdown_lines, markdown_list, text_table
from multibody_xval.scenarios.verdicts.proven import with_proven_level
from multibody_xval.scenarios.verdicts.steady_case import EXACT

FINEST_STEPS = (3200, 6400)
"""Steps a period that are worth their time only where the error still falls with the step."""

STUDY_STEPS = (50, 100, 200, *ORDER_STEPS, *FINEST_STEPS)
"""Steps a period of the whole study: from what games take, a few steps a stick, to errors of a thousandth of a dB."""

USUAL_STEPS = (50, 100, 200, 400, 800)
"""Steps a period that take an engine seconds to a minute."""

TIMED_POINT = OperatingPoint(0.3, 0.9)
"""One of the six; its frequency is the median of theirs."""

STILL_FALLS = 0.9
"""Error after twice the steps over the error before: 1/2 for a first-order scheme, 1 where the law itself is off."""


@dataclass(frozen=True)
class StepPoint:
    """One variant at one number of steps a period, over the six stick–slip points."""

    variant: Variant
    steps_per_period: int
    error_db: float
    """Largest error of transmittance against the exact motion [dB], over the certified points; NaN without any."""
    step_seconds: float
    """Wall-clock time of a step of one chain [s], the search for the steady state with all its work over the steps that
    it simulated; the median of the points."""
    seconds: float
    """Wall-clock time to the certified steady state [s], the median of the points."""
    certified: int
    evaluated: int
    """Points that have a result at all, with a steady state or without."""
    reason: str
    """Why the first point that is blocked has no result; empty if there is none."""

    @property
    def simulated_second(self) -> float:
        """Wall-clock time of a simulated second of the chain at `TIMED_POINT` [s]: that of a step over its length."""
        lane, _ = task_at(self.variant, TIMED_POINT, self.steps_per_period).lane()
        return self.step_seconds / lane.time_step

    @property
    def is_complete(self) -> bool:
        """Whether all six are certified: an error over fewer is not comparable."""
        return self.certified == len(SIX_POINTS)

    @property
    def product(self) -> float:
        """Error times time of a simulated second [dB s]; NaN unless it is complete."""
        return self.error_db * self.simulated_second if self.is_complete else math.nan


def step_tasks(
    variant: Variant, excitation: Excitation = DEFAULT_EXCITATION, steps: Sequence[int] = ORDER_STEPS
) -> list[SteadyStateTask]:
    """Give the tasks of a variant: the six points at every number of steps."""
    return [task_at(variant, point, number, excitation) for number in steps for point in SIX_POINTS]


def exact_step_tasks(excitation: Excitation = DEFAULT_EXCITATION) -> list[SteadyStateTask]:
    """Give the tasks of the exact motion at the six points; it has no steps."""
    return step_tasks(EXACT, excitation)[: len(SIX_POINTS)]


def step_study(
    variants: Sequence[Variant],
    evaluator: Evaluator,
    excitation: Excitation = DEFAULT_EXCITATION,
    steps: Sequence[int] = ORDER_STEPS,
) -> tuple[StepPoint, ...]:
    """Compare every variant at the six points with the exact motion, by variant and ascending numbers of steps.

    A point without an exact motion has no error; what has no result at all is there with ``evaluated`` zero.
    """
    exact_tasks = exact_step_tasks(excitation)
    tasks = {variant: step_tasks(variant, excitation, steps) for variant in variants}
    every = [*exact_tasks, *(task for own in tasks.values() for task in own)]
    results = dict(zip(every, evaluator.evaluate(every), strict=True))
    exact = {point_of(task): with_proven_level(task, results[task]) for task in exact_tasks if results[task].converged}
    return tuple(
        _step_point(variant, number, [(task, results[task]) for task in own if task.steps_per_period == number], exact)
        for variant, own in tasks.items()
        for number in steps
    )


def thrifty_step_study(
    variants: Sequence[Variant], evaluator: Evaluator, stored: Evaluator, excitation: Excitation, steps: Sequence[int]
) -> list[StepPoint]:
    """Compare as `step_study` does, at `FINEST_STEPS` only where the error still falls, and with all that is stored."""
    study: dict[tuple[Variant, int], StepPoint] = {}

    def add(source: Evaluator, chosen: Sequence[Variant], numbers: Sequence[int]) -> None:
        if numbers:
            for point in step_study(chosen, source, excitation, numbers):
                study.setdefault((point.variant, point.steps_per_period), point)

    add(evaluator, variants, coarse_steps(steps))
    falling = [variant for variant in variants if _falls([p for p in study.values() if p.variant == variant])]
    add(evaluator, falling, [number for number in steps if number in FINEST_STEPS])
    add(stored, variants, STUDY_STEPS)
    known = (point for point in study.values() if point.evaluated or point.reason)
    return sorted(known, key=lambda point: (variants.index(point.variant), point.steps_per_period))


def coarse_steps(steps: Iterable[int]) -> list[int]:
    """Give the numbers of steps at which every variant is simulated."""
    return [number for number in steps if number not in FINEST_STEPS]


def _falls(points: Sequence[StepPoint]) -> bool:
    """Whether the error falls from the last but one number of steps to the last, or is not known."""
    if len(points) < 2:
        return True
    before, last = points[-2:]
    doublings = math.log2(last.steps_per_period / before.steps_per_period)
    return not last.error_db > STILL_FALLS**doublings * before.error_db


def _step_point(
    variant: Variant,
    steps: int,
    results: Sequence[tuple[SteadyStateTask, Result]],
    exact: Mapping[OperatingPoint, Result],
) -> StepPoint:
    certified = [(point_of(task), result) for task, result in results if result.converged]
    errors = [error_db(result, exact[point]) for point, result in certified if point in exact]
    timed = [result for _, result in certified if not math.isnan(result.seconds)]
    return StepPoint(
        variant=variant,
        steps_per_period=steps,
        error_db=max(errors, default=math.nan),
        step_seconds=_median(result.seconds / (result.periods * result.steps_per_period) for result in timed),
        seconds=_median(result.seconds for result in timed),
        certified=len(certified),
        evaluated=sum(result.status not in (ResultStatus.MISSING, ResultStatus.BLOCKED) for _, result in results),
        reason=next((result.reason for _, result in results if result.status is ResultStatus.BLOCKED), ""),
    )


def remarks(points: Iterable[StepPoint]) -> list[str]:
    """Say of each variant why points are missing, and where its error falls no more: the law itself is off."""
    texts = []
    for variant, own in groupby(points, key=lambda point: point.variant):
        every = list(own)
        reason = next((point.reason for point in every if point.reason), "")
        lost = [str(point.steps_per_period) for point in every if not point.is_complete]
        if reason:
            texts.append(f"{variant}: blocked: {reason}")
        elif lost:
            texts.append(f"{variant}: not all of the six points are certified at {', '.join(lost)} steps a period")
        complete = [point for point in every if point.is_complete]
        if not _falls(complete):
            before, last = (f"{p.error_db:.3g} dB at {p.steps_per_period}" for p in complete[-2:])
            texts.append(f"{variant}: the error does not fall with the step: {before} steps a period, {last}")
    return texts


STEP_COLUMNS: tuple[Column[StepPoint], ...] = (
    Column("engine", lambda point: point.variant.engine),
    Column("formulation", lambda point: point.variant.formulation),
    Column("preset", lambda point: point.variant.preset_name),
    Column("steps_per_period", lambda point: point.steps_per_period, "steps a period"),
    Column("largest_error_db", lambda point: point.error_db, "error [dB]", "{:.3g}"),
    Column("step_s", lambda point: point.step_seconds),
    Column("steady_state_s", lambda point: point.seconds),
    Column("points_certified", lambda point: point.certified),
    Column("points_evaluated", lambda point: point.evaluated),
    Column("reason", lambda point: point.reason),
)
"""For programs, in full; times are those of the search."""

WORK_COLUMNS: tuple[Column[StepPoint], ...] = (
    *STEP_COLUMNS,
    Column("simulated_second_s", lambda point: point.simulated_second),
)

PRINTED_COLUMNS: tuple[Column[StepPoint], ...] = (
    Column("variant", lambda point: str(point.variant), "engine:formulation:preset"),
    *STEP_COLUMNS[3:5],
    Column("", lambda point: 1e3 * point.simulated_second, "ms a second", "{:.3g}"),
    Column("", lambda point: 1e3 * point.product, "error × time [dB ms]", "{:.3g}"),
    Column("", lambda point: f"{point.certified}/{len(SIX_POINTS)}", "certified"),
)

LEGEND = """\
What does accuracy cost? Every variant is simulated at six stick–slip points, with several numbers of steps a period:

- *error*: the largest of the transmittance, to the proven truth;
- *ms a second*: wall-clock time of a simulated second of the chain of seven cells (friction ratio 0.3, frequency ratio
  0.9): the search for a steady state with all its work, over the steps that it simulated; the median of the points.
  Other workers of the same run, and the machine, change it;
- *error × time*: of a scheme of first order nearly the same at every step; the less, the better;
- *certified*: points whose steady state repeats to the engine's residual.
"""


def document(points: Sequence[StepPoint], command: str) -> str:
    """Give the table as a document, with how it was made."""
    lines = ["# Work and precision", "", LEGEND, f"Made by `{command}`.", ""]
    lines += [*markdown_lines(text_table(PRINTED_COLUMNS, points)), "", *markdown_list(remarks(points))]
    versions = versions_of(point.variant.engine for point in points)
    return "\n".join([*lines, "", f"Versions: {versions}; Python {platform.python_version()}.", ""])


def _median(values: Iterable[float]) -> float:
    every = list(values)
    return median(every) if every else math.nan
