"""Longer chains: 7 to 50 cells."""

import math
from collections.abc import Sequence

from engines.variant import Variant
from scenarios.agreement import Comparison, Verdict, scheme_bar, step_estimate
from scenarios.evaluation import Evaluator
from scenarios.questions import Answer, ChainRatios, Question
from scenarios.scenario import Finding
from scenarios.steady_case import COARSE, FINE, FINEST, REFERENCE, Case, Expected, evidence, questions_of
from scenarios.steady_scenario import TRANSMITTANCE, SteadyScenario

CONVERGED = Variant("reference", preset="converged")

LENGTHS = (7, 15, 30, 50)

FRICTION_RATIO, FREQUENCY_RATIO = 0.1, 0.5
"""In the pass band, where friction takes most of the motion from the longest chain and hardly any from the shortest."""

LONGEST_SECONDS = 60.0
"""Seconds that a length may take an engine by what the last one took; a longer one is not asked."""

GROWTH = 2.0
"""Power of the length by which seconds grow: a step costs as much more as there are more cells, and the longer a
chain is, the more periods its steady state takes."""


def _case(cells: int) -> Case:
    return Case(
        label=f"{cells} cells",
        friction_ratio=FRICTION_RATIO,
        frequency_ratio=FREQUENCY_RATIO,
        ratios=ChainRatios(cells=cells),
    )


class LongChain(SteadyScenario):
    """The canonical chain with more and more cells."""

    name = "long-chain"
    question = "How many cells can an engine take, and is it as right with fifty as with seven?"
    source = "the canonical case with more cells, at friction ratio 0.1 and η_r 0.5"
    expects = "the reference with 32 times the steps, and its error bar"
    cases = tuple(_case(cells) for cells in LENGTHS)

    def questions(self, variants: Sequence[Variant]) -> list[Question]:
        """Give what is asked first; see `run`."""
        return [*self._ruler(), *(q for variant in variants for q in questions_of(variant, self.cases[0]))]

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Ask length after length; an engine that was too slow for one is not asked the next. See `Scenario.run`."""
        ruler = self._ruler()
        answers = dict(zip(ruler, evaluator.evaluate(ruler), strict=True))
        expected = {case: expected_of([answers[q] for q in _refined(case)]) for case in self.cases}
        findings: dict[Variant, list[Finding]] = {variant: [] for variant in variants}
        for place, case in enumerate(self.cases):
            refused = {variant: self._refusal(variant, place, answers) for variant in variants}
            asked = [q for variant in variants if refused[variant] is None for q in questions_of(variant, case)]
            answers.update(zip(asked, evaluator.evaluate(asked), strict=True))
            for variant, refusal in refused.items():
                if refusal is None:
                    findings[variant] += self.findings(evidence(variant, case, expected[case], answers))
                else:
                    expects = expected[case].transmittance_db
                    findings[variant].append(Finding(variant, case.label, TRANSMITTANCE, math.nan, expects, refusal))
        return [finding for variant in variants for finding in findings[variant]]

    def _ruler(self) -> list[Question]:
        """What the reference is asked, whoever is judged."""
        return [q for case in self.cases for q in (*questions_of(REFERENCE, case), *_refined(case))]

    def _refusal(self, variant: Variant, place: int, answers: dict[Question, Answer]) -> Comparison | None:
        """Say why a variant is not asked about a length; ``None`` if it is."""
        if place == 0:
            return None
        shorter, longer = self.cases[place - 1].ratios.cells, self.cases[place].ratios.cells
        own = [answers.get(question) for question in questions_of(variant, self.cases[place - 1])]
        known = [answer for answer in own if answer is not None]
        if len(known) < len(own):
            return Comparison(Verdict.INCONCLUSIVE, f"not asked, as {shorter} cells were not")
        if any(answer.status == "blocked" for answer in known):
            return Comparison(Verdict.BLOCKED, f"not asked: blocked with {shorter} cells")
        seconds = sum(answer.seconds for answer in known)
        predicted = seconds * (longer / shorter) ** GROWTH
        if predicted <= LONGEST_SECONDS:
            return None
        reason = f"not asked: {shorter} cells took {seconds:.0f} s, {longer} would take some {predicted:.0f} s, allowed"
        return Comparison(Verdict.INCONCLUSIVE, f"{reason} {LONGEST_SECONDS:g} s")


def _refined(case: Case) -> list[Question]:
    """Ask the converged reference with three step sizes."""
    return [case.question(CONVERGED, refinement) for refinement in (COARSE, FINE, FINEST)]


def expected_of(refined: Sequence[Answer]) -> Expected:
    """Give the converged reference's transmittance and its error bar, from three step sizes."""
    coarse, fine, finest = (answer.transmittance_db if answer.converged else math.nan for answer in refined)
    # half of what three steps say of the middle one; no less than what the last two say of the finest
    bar = max(scheme_bar(coarse, fine, finest) / 2, step_estimate(fine, finest))
    return Expected(transmittance_db=finest, bar_db=bar)
