"""Sweeps whose curves choose their own frequencies: a curve is one variant and one combination of the other values."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from scenarios.execution.evaluator import Evaluator
from scenarios.execution.store import ResultStore
from scenarios.studies.adaptive_grid import AdaptiveAxis, AdaptiveCurve
from scenarios.studies.figure3 import resonances
from scenarios.sweeps.summary import SweepSummary
from scenarios.sweeps.sweep import Sweep
from scenarios.tasks.result import Result, ResultSummary
from scenarios.tasks.task import SteadyStateTask

Answering = Callable[[Sequence[SteadyStateTask]], Sequence[Result | None]]
"""Gives an answer to each question, or ``None`` where there is none."""


@dataclass(frozen=True)
class AdaptiveSweep:
    """What is asked.

    Parameters
    ----------
    outline
        The sweep; its frequency ratios are replaced by those that each curve needs.
    frequencies
        Their axis.
    """

    outline: Sweep
    frequencies: AdaptiveAxis

    def curves(self) -> Iterator[SteadyStateTask]:
        """Give a question of every curve, at the first frequency."""
        return self._with_frequencies((self.frequencies.first,)).questions()

    def start(self) -> Iterator[SteadyStateTask]:
        """Give the questions with which every curve begins."""
        for curve in self.curves():
            for eta in self.frequencies.start(resonances(curve.ratios).tolist()):
                yield replace(curve, frequency_ratio=eta)

    def grid_of(self, store: ResultStore) -> Sweep:
        """Give the sweep over all frequencies that any curve has come to, as far as the store knows its answers."""
        curves = refined(self, lambda asked: list(store.results(asked)))
        return self._with_frequencies(tuple(sorted({eta for curve in curves.values() for eta in curve.asked})))

    def _with_frequencies(self, values: tuple[float, ...]) -> Sweep:
        return replace(self.outline, axes={**self.outline.axes, "frequency_ratio": values})


def refined(sweep: AdaptiveSweep, answering: Answering) -> dict[SteadyStateTask, AdaptiveCurve]:
    """Ask round by round, all curves together, until every curve is resolved; curves by a question of theirs.

    What is asked depends on nothing but the answers: the same ones lead to the same points.
    """
    curves = {one: AdaptiveCurve(sweep.frequencies, resonances(one.ratios).tolist()) for one in sweep.curves()}
    while due := [(one, eta) for one, curve in curves.items() for eta in curve.due]:
        answers = answering([replace(one, frequency_ratio=eta) for one, eta in due])
        values: dict[SteadyStateTask, dict[float, float]] = {}
        for (one, eta), answer in zip(due, answers, strict=True):
            value = answer.transmittance_db if answer is not None and answer.converged else math.nan
            values.setdefault(one, {})[eta] = value
        for one, found in values.items():
            curves[one].add(found)
    return curves


def run_adaptive_sweep(sweep: AdaptiveSweep, evaluator: Evaluator) -> SweepSummary:
    """Answer what every curve needs and the store does not know yet; every answer is on disk at once."""
    summary = SweepSummary()

    def answering(asked: Sequence[SteadyStateTask]) -> list[Result]:
        answers = evaluator.evaluate(asked)
        for question, answer in zip(asked, answers, strict=True):
            summary.add(question.variant, ResultSummary.of(answer))
        return answers

    for one, curve in refined(sweep, answering).items():
        summary.unresolved[one.variant] += not curve.resolved
    return summary
