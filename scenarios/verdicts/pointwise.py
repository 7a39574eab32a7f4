"""What a point of figure 3 is compared with, and how far it may be from it.

Presets that share the Euler scheme solve the reference's own equations: they are compared with the reference at equal
step, and nothing is allowed but what neither can resolve. All others, the reference itself among them, are compared
with the converged reference. They are asked with half as many steps too, so that their own error is known; it is
taken to be no less than the error bar of the reference at this point and step, since one difference of two steps may
vanish by chance: the reference is asked with twice and four times as many steps, and is judged by them itself.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from engines.interface.variant import Variant
from engines.reference import CONVERGED_SUBSTEPS
from scenarios.tasks.result import Result
from scenarios.verdicts.steady_case import REFERENCE, resolution_db
from scenarios.verdicts.verdict import (
    FLOOR_DB,
    SAFETY,
    Comparison,
    Tolerance,
    Verdict,
    compare_transmittance,
    difference_db,
    missing_steady_state,
)

CONVERGED = Variant("reference", preset_name="converged")


@dataclass(frozen=True, kw_only=True)
class GivenTolerance:
    """A tolerance that is given, instead of one that is derived at every point.

    Parameters
    ----------
    transmittance_db
        Largest difference that counts as agreement [dB] > 0, see `compare_transmittance`.
    ruler
        Whom variants are compared with: the reference or its converged preset.
    """

    transmittance_db: float
    baseline: Variant

    def judges(self, variant: Variant) -> bool:
        """Say whether it is for this variant: for everybody but whom others are compared with."""
        return variant not in (self.baseline, CONVERGED)


def baseline(variant: Variant, given: GivenTolerance | None = None) -> Variant:
    """Give whom a variant is compared with."""
    if given is not None and given.judges(variant):
        return given.baseline
    return REFERENCE if variant.engine != REFERENCE.engine and variant.preset.shares_scheme else CONVERGED


def refinements(variant: Variant, given: GivenTolerance | None = None) -> tuple[float, ...]:
    """Give with how many times the steps a variant is asked too, for the sake of its own error.

    With none where it shares the reference's error, is the ruler itself, or is judged by a tolerance that is given.
    """
    if given is not None and given.judges(variant):
        return ()
    if variant == REFERENCE:
        return (2.0, 4.0)
    return (0.5,) if baseline(variant) == CONVERGED != variant else ()


@dataclass(frozen=True, kw_only=True)
class PointResults:
    """What is known at one point of the grid.

    Parameters
    ----------
    variant
        Whose point it is.
    answer
        Its answer.
    others
        Its answers with other numbers of steps, see `refinements`.
    reference, converged
        The reference's answers at the same point, at equal step and converged.
    amplified
        How many times farther from its steady state the answer may be than its residual, see `amplification`.
    refined
        The reference's answers at the same point with other numbers of steps.
    given
        The tolerance, where it is given; without it, it is derived.
    """

    variant: Variant
    answer: Result
    others: tuple[Result, ...]
    reference: Result
    converged: Result
    amplified: float
    refined: tuple[Result, ...] = ()
    given: GivenTolerance | None = None


def compare_point(known: PointResults) -> Comparison:
    """Compare a point with its ruler."""
    given = known.given
    expected = known.reference if baseline(known.variant, given) == REFERENCE else known.converged
    if given is not None and given.judges(known.variant):
        return compare_transmittance(known.answer, expected, given.transmittance_db)
    missing = missing_steady_state("engine", known.answer) or missing_steady_state("reference", expected)
    if missing is not None:
        return missing
    level = expected.transmittance_db
    difference = difference_db(known.answer.transmittance_db, level, level)
    tolerance = _tolerance(known, level)
    reason = f"difference {difference:+.4f} dB, allowed {tolerance}"
    verdict = Verdict.AGREE if abs(difference) <= tolerance.allowed else Verdict.DISAGREE
    if verdict is Verdict.DISAGREE and not all(other.converged for other in known.others):
        verdict, reason = Verdict.INCONCLUSIVE, f"{reason}; no steady state with other steps tells its own error"
    return Comparison(verdict, reason, difference, tolerance.allowed)


def _tolerance(known: PointResults, level_db: float) -> Tolerance:
    """Derive how far the point may be from its ruler [dB]."""
    resolution = resolution_db(known.variant, known.answer, max(level_db, FLOOR_DB), known.amplified)
    if baseline(known.variant) == REFERENCE:
        return Tolerance(reference=0.0, engine=0.0, resolution=resolution)
    scheme = 0.0
    if known.reference.converged:
        scheme = max(
            abs(difference_db(known.reference.transmittance_db, known.converged.transmittance_db, level_db)),
            _step_error(known.reference, known.refined, level_db),
        )
    return Tolerance(
        # the converged reference is the same scheme with so many times the steps
        reference=SAFETY * scheme / (CONVERGED_SUBSTEPS - 1),
        engine=SAFETY * _step_error(known.answer, known.others, level_db),
        resolution=resolution,
        # the reference itself is judged by its own steps alone: its error cannot excuse itself
        scheme=0.0 if known.variant == REFERENCE else SAFETY * scheme,
    )


def _step_error(answer: Result, others: Sequence[Result], level_db: float) -> float:
    """Estimate the error of an answer [dB] from what other steps give: the largest of all neighbouring pairs.

    The errors of a first-order scheme with a < b steps differ by c (1 / a − 1 / b), and c / n is that with n.
    """
    answers = sorted((one for one in (answer, *others) if one.converged), key=lambda one: one.steps_per_period)
    steps, errors = answer.steps_per_period, [0.0]
    for coarse, fine in itertools.pairwise(answers):
        parts = 1 / coarse.steps_per_period - 1 / fine.steps_per_period
        if parts > 0:
            difference = difference_db(coarse.transmittance_db, fine.transmittance_db, level_db)
            errors.append(abs(difference) / (parts * steps))
    return max(errors)
