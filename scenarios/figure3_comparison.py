"""What a point of figure 3 is compared with, and how far it may be from it.

Presets that share the Euler scheme solve the reference's own equations: they are compared with the reference at equal
step, and nothing is allowed but what neither can resolve. All others, the reference itself among them, are compared
with the converged reference. They are asked with half as many steps too, so that their own error is known; it is
taken to be no less than the error of the reference at this point and step, which is known from the converged one.
"""

from dataclasses import dataclass

from engines.reference import CONVERGED_SUBSTEPS
from engines.variant import Variant
from scenarios.agreement import (
    FLOOR_DB,
    SAFETY,
    Comparison,
    Tolerance,
    Verdict,
    difference_db,
    missing_steady_state,
)
from scenarios.questions import Answer
from scenarios.steady_case import REFERENCE, resolution_db

CONVERGED = Variant("reference", preset="converged")


def ruler(variant: Variant) -> Variant:
    """Give whom a variant is compared with."""
    return REFERENCE if variant.engine != REFERENCE.engine and variant.options.shares_scheme else CONVERGED


def needs_half_the_steps(variant: Variant) -> bool:
    """Say whether a variant's own error is needed: not where it shares the reference's, or is the ruler itself."""
    return ruler(variant) == CONVERGED != variant


@dataclass(frozen=True, kw_only=True)
class PointAnswers:
    """What is known at one point of the grid.

    Parameters
    ----------
    variant
        Whose point it is.
    answer
        Its answer.
    half
        Its answer with half the steps; ``None`` where it is not needed.
    reference, converged
        The reference's answers at the same point, at equal step and converged.
    """

    variant: Variant
    answer: Answer
    half: Answer | None
    reference: Answer
    converged: Answer


def compare_point(known: PointAnswers) -> Comparison:
    """Compare a point with its ruler."""
    expected = known.reference if ruler(known.variant) == REFERENCE else known.converged
    missing = missing_steady_state("engine", known.answer) or missing_steady_state("reference", expected)
    if missing is not None:
        return missing
    level = expected.transmittance_db
    difference = difference_db(known.answer.transmittance_db, level, level)
    tolerance = _tolerance(known, level)
    reason = f"difference {difference:+.4f} dB, allowed {tolerance}"
    verdict = Verdict.AGREE if abs(difference) <= tolerance.allowed else Verdict.DISAGREE
    if verdict is Verdict.DISAGREE and known.half is not None and not known.half.converged:
        verdict, reason = Verdict.INCONCLUSIVE, f"{reason}; no steady state with half the steps tells its own error"
    return Comparison(verdict, reason, difference, tolerance.allowed)


def _tolerance(known: PointAnswers, level_db: float) -> Tolerance:
    """Derive how far the point may be from its ruler [dB]."""
    resolution = resolution_db(known.variant, known.answer, max(level_db, FLOOR_DB))
    if ruler(known.variant) == REFERENCE:
        return Tolerance(reference=0.0, engine=0.0, resolution=resolution)
    scheme = (
        abs(difference_db(known.reference.transmittance_db, known.converged.transmittance_db, level_db))
        if known.reference.converged
        else 0.0
    )
    own = 0.0
    if known.half is not None and known.half.converged and known.half.steps_per_period < known.answer.steps_per_period:
        # of a first-order scheme with n and m < n steps the difference is the error of the finer one times n / m − 1
        finer = known.answer.steps_per_period / known.half.steps_per_period - 1
        own = abs(difference_db(known.half.transmittance_db, known.answer.transmittance_db, level_db)) / finer
    return Tolerance(
        # the converged reference is the same scheme with so many times the steps
        reference=SAFETY * scheme / (CONVERGED_SUBSTEPS - 1),
        engine=SAFETY * own,
        resolution=resolution,
        # the reference itself is judged by its own two steps alone: its error cannot excuse itself
        scheme=0.0 if known.variant == REFERENCE else SAFETY * scheme,
    )
