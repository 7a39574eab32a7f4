"""What accuracy costs: error, cost of a step and time to the steady state, at several step sizes."""

import math
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import repeat
from multiprocessing import get_context
from statistics import median
from typing import Any

from engines.interface.variant import Variant
from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS
from scenarios.execution.evaluator import Evaluator
from scenarios.execution.store import ResultStore
from scenarios.studies.accuracy import ORDER_STEPS, OperatingPoint, exact_answer, transmittance_error_db
from scenarios.tasks.parameters import Excitation
from scenarios.tasks.result import Result, ResultStatus
from scenarios.tasks.task import USUAL_EXCITATION, SteadyStateTask


@dataclass(frozen=True)
class StepPoint:
    """One variant at one number of steps a period, over the six stick–slip points.

    Parameters
    ----------
    variant, steps_per_period
        Who was asked, and how finely.
    error_db
        Largest error of transmittance against the exact motion [dB], over the certified points; NaN without any.
    step_seconds
        Wall-clock time of a step of one chain [s], the search for the steady state with all its work over the steps
        that it simulated; the median of the points.
    seconds
        Wall-clock time to the certified steady state [s], the median of the points.
    certified
        Points whose steady state was found.
    answered
        Points that were answered at all, with a steady state or without.
    reason
        Why the first point that is blocked has no answer; empty if there is none.
    """

    variant: Variant
    steps_per_period: int
    error_db: float
    step_seconds: float
    seconds: float
    certified: int
    answered: int
    reason: str


@dataclass(frozen=True, kw_only=True)
class ExactTask(SteadyStateTask):
    """A question to the event-driven solver, which has no time step."""

    def content(self) -> dict[str, Any]:
        """Everything that the answer depends on."""
        return {**super().content(), "solver": "event-driven"}


def step_questions(variant: Variant, excitation: Excitation = USUAL_EXCITATION) -> list[SteadyStateTask]:
    """Give what is asked of a variant: the six points at every number of steps."""
    return [
        SteadyStateTask(
            variant=variant, friction_ratio=friction, frequency_ratio=eta, steps_per_period=steps,
            excitation=excitation,
        )
        for steps in ORDER_STEPS
        for friction, eta in STICK_SLIP_POINTS
    ]  # fmt: skip


def step_study(
    variants: Sequence[Variant],
    exact: Mapping[OperatingPoint, Result],
    evaluator: Evaluator,
    excitation: Excitation = USUAL_EXCITATION,
) -> tuple[StepPoint, ...]:
    """Ask every variant the six points at every number of steps, and compare with the exact motion.

    Parameters
    ----------
    variants
        Whom to ask.
    exact
        The exact motion at the six points, by `exact_answers`; a place that is not there has no error.
    evaluator
        Who answers.
    excitation
        What drives the chain, here and in the exact motion.

    Returns
    -------
    tuple of StepPoint
        By variant, then by number of steps; what has no answer at all is there with ``answered`` zero.
    """
    questions = {variant: step_questions(variant, excitation) for variant in variants}
    every = [question for own in questions.values() for question in own]
    answers = dict(zip(every, evaluator.evaluate(every), strict=True))
    return tuple(
        _step_point(variant, steps, [(q, answers[q]) for q in own if q.steps_per_period == steps], exact)
        for variant, own in questions.items()
        for steps in ORDER_STEPS
    )


def _step_point(
    variant: Variant,
    steps: int,
    answered: Sequence[tuple[SteadyStateTask, Result]],
    exact: Mapping[OperatingPoint, Result],
) -> StepPoint:
    """Sum up one number of steps."""
    certified = [(place_of(question), answer) for question, answer in answered if answer.converged]
    errors = [transmittance_error_db(answer, exact[place]) for place, answer in certified if place in exact]
    timed = [answer for _, answer in certified if not math.isnan(answer.seconds)]
    return StepPoint(
        variant=variant,
        steps_per_period=steps,
        error_db=max(errors, default=math.nan),
        step_seconds=_median(answer.seconds / (answer.periods * answer.steps_per_period) for answer in timed),
        seconds=_median(answer.seconds for answer in timed),
        certified=len(certified),
        answered=sum(answer.status not in (ResultStatus.MISSING, ResultStatus.BLOCKED) for _, answer in answered),
        reason=next((answer.reason for _, answer in answered if answer.status is ResultStatus.BLOCKED), ""),
    )


def place_of(question: SteadyStateTask) -> OperatingPoint:
    """Give the friction and the frequency ratio of a question about a chain of equal friction."""
    assert isinstance(question.friction_ratio, float)
    return question.friction_ratio, question.frequency_ratio


def exact_answers(
    places: Sequence[OperatingPoint],
    store: ResultStore,
    *,
    excitation: Excitation = USUAL_EXCITATION,
    ask: bool = True,
    workers: int | None = None,
) -> dict[OperatingPoint, Result]:
    """Give the exact motion at every place: from the store, or computed there and kept; takes a second each.

    Without `ask`, what the store does not know is left out.
    """
    questions = {
        (friction, eta): ExactTask(
            variant=Variant("reference"), friction_ratio=friction, frequency_ratio=eta, excitation=excitation
        )
        for friction, eta in places
    }
    found = {place: store.find(question) for place, question in questions.items()}
    unknown = [place for place, answer in found.items() if answer is None]
    if ask and unknown:
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            for place, answer in zip(unknown, pool.map(exact_answer, unknown, repeat(excitation)), strict=True):
                store.keep([(questions[place], answer)])
                found[place] = answer
    return {place: answer for place, answer in found.items() if answer is not None}


def _median(values: Iterable[float]) -> float:
    every = list(values)
    return median(every) if every else math.nan
