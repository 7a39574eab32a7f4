"""How wrong the friction of an engine is: one row of numbers for every variant, against the exact motion."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from engines.interface.variant import Variant
from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS
from reference_lcp.observables.transition_matching import match_transitions
from reference_lcp.steady_state import exact_steady_state
from scenarios.execution.evaluator import Evaluator
from scenarios.tasks.parameters import Excitation
from scenarios.tasks.result import Result, ResultStatus
from scenarios.tasks.task import USUAL_EXCITATION, SteadyStateTask
from scenarios.verdicts.verdict import difference_db

MAP_FRICTION_RATIOS = (0.1, 0.3, 0.6, 1.0)
MAP_FREQUENCY_RATIOS = tuple(round(0.3 + 0.1 * k, 1) for k in range(14))
"""Where the map of an engine's error is taken: friction ratios of figure 3, frequency ratios from 0.3 to 1.6."""

OperatingPoint = tuple[float, float]
"""Friction ratio and frequency ratio."""

MAP: tuple[OperatingPoint, ...] = tuple(
    (friction, eta) for friction in MAP_FRICTION_RATIOS for eta in MAP_FREQUENCY_RATIOS
)

PLACES: tuple[OperatingPoint, ...] = tuple(dict.fromkeys((*STICK_SLIP_POINTS, *MAP)))
"""Every place at which engines are asked."""

MAP_STEPS = 800
"""Steps a period of the map."""

ORDER_STEPS = (400, 800, 1600)
"""Steps a period at which the six points are asked, and through which the order in the time step is fitted."""


@dataclass(frozen=True)
class Accuracy:
    """What is wrong with a variant; worst values over all certified points, NaN where there is none.

    Parameters
    ----------
    variant
        Who was asked.
    points_db
        Largest transmittance error over the six stick–slip points [dB], by steps a period.
    map_db, worst_place
        Largest transmittance error over the map [dB] and where, as (friction ratio, frequency ratio).
    stuck_fraction
        Largest error of a contact's stuck fraction on the map.
    median_transition, largest_transition
        |Time error| of matched transitions on the map, over the period.
    transitions, missed, spurious
        Transitions of the exact motion on the map; those not found, and found ones that are none.
    creep
        Largest |ġ_T| within a stick, over ω U0.
    order
        In the time step: −slope of the root mean square error at the six points; NaN unless all are certified.
    points, certified
        How many points were asked, and had a certified steady state.
    blocked
        Reason of the first blocked point; empty if there is none.
    """

    variant: Variant
    points_db: Mapping[int, float]
    map_db: float
    worst_place: tuple[float, float] | None
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


def accuracy_questions(variant: Variant) -> list[SteadyStateTask]:
    """Give everything that is asked of a variant: the six points at three steps, and the map."""
    asked = [
        SteadyStateTask(variant=variant, friction_ratio=friction, frequency_ratio=eta, steps_per_period=steps)
        for steps in ORDER_STEPS
        for friction, eta in STICK_SLIP_POINTS
    ]
    asked += [
        SteadyStateTask(variant=variant, friction_ratio=friction, frequency_ratio=eta, steps_per_period=MAP_STEPS)
        for friction, eta in MAP
    ]
    return list(dict.fromkeys(asked))


def accuracies(
    variants: Sequence[Variant], exact: Mapping[OperatingPoint, Result], evaluator: Evaluator
) -> list[Accuracy]:
    """Ask every variant, and compare each with the exact motion.

    Parameters
    ----------
    variants
        Whom to ask.
    exact
        The exact motion at `PLACES`, by `exact_answer`.
    evaluator
        Who answers; all questions go to it at once.

    Returns
    -------
    list of Accuracy
        One a variant, in order.
    """
    questions = {variant: accuracy_questions(variant) for variant in variants}
    every = [question for asked in questions.values() for question in asked]
    answers = dict(zip(every, evaluator.evaluate(every), strict=True))
    return [
        accuracy(variant, {question: answers[question] for question in questions[variant]}, exact)
        for variant in variants
    ]


def accuracy(
    variant: Variant, answers: Mapping[SteadyStateTask, Result], exact: Mapping[OperatingPoint, Result]
) -> Accuracy:
    """Compare one variant's answers to `accuracy_questions` with the exact motion."""
    certified = {question: answer for question, answer in answers.items() if answer.converged}
    places = {place: a for q, a in certified.items() if (place := _place(q)) in MAP and q.steps_per_period == MAP_STEPS}
    errors = {place: transmittance_error_db(answer, exact[place]) for place, answer in places.items()}
    matches = [
        match_transitions(answer.transitions, exact[place].transitions, answer.period)
        for place, answer in places.items()
    ]
    times = [abs(error) for match in matches for error in match.time_errors]
    blocked = [answer.reason for answer in answers.values() if answer.status is ResultStatus.BLOCKED]
    return Accuracy(
        variant=variant,
        points_db={steps: _largest(_point_errors(certified, exact, steps)) for steps in ORDER_STEPS},
        map_db=_largest(errors.values()),
        worst_place=max(errors, key=lambda place: errors[place], default=None),
        stuck_fraction=_largest(_stuck_error(answer, exact[place]) for place, answer in places.items()),
        median_transition=float(np.median(times)) if times else math.nan,
        largest_transition=_largest(times),
        transitions=sum(len(exact[place].transitions) for place in places),
        missed=sum(len(match.missed) for match in matches),
        spurious=sum(len(match.spurious) for match in matches),
        creep=_largest(max(answer.creep) for answer in certified.values()),
        order=_order(certified, exact),
        points=len(answers),
        certified=len(certified),
        blocked=blocked[0] if blocked else "",
    )


def exact_answer(place: OperatingPoint, excitation: Excitation = USUAL_EXCITATION) -> Result:
    """Answer by the event-driven solver, which has no error of a time step; takes about a second."""
    friction, eta = place
    asked = SteadyStateTask(
        variant=Variant("reference"), friction_ratio=friction, frequency_ratio=eta, excitation=excitation
    )
    chain, drive = asked.setting()
    found = exact_steady_state(chain, drive)
    return Result(
        status=ResultStatus(found.orbit.status),
        transmittance_db=found.transmittance_db,
        residual=found.orbit.residual,
        period=drive.period,
        stuck_fraction=tuple(found.stuck_fraction.tolist()),
        transitions=tuple((change.cell, change.time, str(change.kind)) for change in found.transitions),
    )


def transmittance_error_db(answer: Result, exact: Result) -> float:
    """|Difference| of transmittance [dB]; below `FLOOR_DB`, what the difference of amplitudes makes at the floor."""
    return abs(difference_db(answer.transmittance_db, exact.transmittance_db, exact.transmittance_db))


def _place(question: SteadyStateTask) -> OperatingPoint:
    assert isinstance(question.friction_ratio, float)
    return question.friction_ratio, question.frequency_ratio


def _point_errors(
    certified: Mapping[SteadyStateTask, Result], exact: Mapping[OperatingPoint, Result], steps: int
) -> list[float]:
    """Transmittance errors at those of the six points that are certified at so many steps [dB]."""
    return [
        transmittance_error_db(answer, exact[_place(question)])
        for question, answer in certified.items()
        if question.steps_per_period == steps and _place(question) in STICK_SLIP_POINTS
    ]


def _order(certified: Mapping[SteadyStateTask, Result], exact: Mapping[OperatingPoint, Result]) -> float:
    """Fit the order in the time step."""
    errors = [_point_errors(certified, exact, steps) for steps in ORDER_STEPS]
    if any(len(one) < len(STICK_SLIP_POINTS) for one in errors):
        return math.nan
    size = [math.sqrt(np.mean(np.square(one))) for one in errors]
    if min(size) == 0:
        return math.nan
    return float(-np.polyfit(np.log(ORDER_STEPS), np.log(size), 1)[0])


def _stuck_error(answer: Result, exact: Result) -> float:
    return float(np.max(np.abs(np.subtract(answer.stuck_fraction, exact.stuck_fraction))))


def _largest(values: Iterable[float]) -> float:
    """Largest value, NaN without any."""
    return max(values, default=math.nan)
