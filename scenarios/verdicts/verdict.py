"""When two simulations agree."""

import math
from dataclasses import dataclass
from enum import StrEnum

from scenarios.tasks.result import Result, ResultStatus, repetition

FLOOR_DB = -60.0
"""Below this transmittance the tolerance is absolute: what it is, as an amplitude, at the floor.

A thousandth of the base's motion is where creep of regularised friction and bristle oscillations,
both proportional to the friction bound and not to the response, become as large as the response.
"""

EDGE_TOLERANCE = 0.005
"""Largest difference of a band edge from the converged reference in η_r, five times the resolution of the edges."""


SAFETY = 1.25
"""Factor on estimated errors, that of `reference_lcp.accuracy.error_bar`, calibrated on random chains."""


class Verdict(StrEnum):
    """The outcome of a comparison."""

    AGREE = "agree"
    DISAGREE = "disagree"
    INCONCLUSIVE = "inconclusive"
    BLOCKED = "blocked"


@dataclass(frozen=True)
class Comparison:
    """A verdict with its reason and its numbers.

    Parameters
    ----------
    verdict
        The outcome.
    reason
        What was compared with what, or why it could not be.
    difference
        Engine less reference, in dB or in η_r; NaN where there is none.
    tolerance
        Largest difference allowed.
    """

    verdict: Verdict
    reason: str
    difference: float = math.nan
    tolerance: float = math.nan


def compare_transmittance(answer: Result, reference: Result, tolerance_db: float) -> Comparison:
    """Compare two steady states at the same point.

    Parameters
    ----------
    answer, reference
        Of the engine and of the reference.
    tolerance_db
        Allowed difference [dB] above `FLOOR_DB`.
    """
    missing = missing_steady_state("engine", answer) or missing_steady_state("reference", reference)
    if missing is not None:
        return missing
    difference = answer.transmittance_db - reference.transmittance_db
    allowed = allowed_difference_db(reference.transmittance_db, tolerance_db)
    verdict = Verdict.AGREE if abs(difference) <= allowed else Verdict.DISAGREE
    return Comparison(verdict, f"difference {difference:+.4f} dB, allowed {allowed:.3g} dB", difference, allowed)


def missing_steady_state(whose: str, answer: Result) -> Comparison | None:
    """Say why there is nothing to compare; ``None`` where there is a certified steady state."""
    if answer.status is ResultStatus.BLOCKED:
        return Comparison(Verdict.BLOCKED, answer.reason)
    if answer.converged:
        return None
    if answer.status is ResultStatus.MISSING:
        return Comparison(Verdict.INCONCLUSIVE, f"{whose.split(maxsplit=1)[0]}: {answer.reason}")
    reason = f"{whose}: {answer.status} after {answer.periods} periods, residual {answer.residual:.1e}"
    reason += repetition(answer.multiple)
    return Comparison(Verdict.INCONCLUSIVE, reason)


def allowed_difference_db(reference_db: float, tolerance_db: float) -> float:
    """Tolerance at a point [dB]: constant above `FLOOR_DB`, the same amplitude below it."""
    below = max(0.0, FLOOR_DB - reference_db)
    return 20 * math.log10(1 + (10 ** (tolerance_db / 20) - 1) * 10 ** (below / 20))


def difference_db(found_db: float, other_db: float, level_db: float) -> float:
    """Difference of two transmittances [dB] near a level; below `FLOOR_DB`, what that of amplitudes is at the floor."""
    if level_db >= FLOOR_DB:
        return found_db - other_db
    found, other, floor = (10 ** (db / 20) for db in (found_db, other_db, FLOOR_DB))
    return math.copysign(20 * math.log10(1 + abs(found - other) / floor), found - other)


def compare_edge(edge: float | None, converged: float | None) -> Comparison:
    """Compare a band edge with the converged reference's; ``None`` is an edge outside the grid."""
    if edge is None and converged is None:
        return Comparison(Verdict.AGREE, "no such edge on the grid, for the reference neither")
    if edge is None or converged is None:
        which = "reference" if edge is None else "engine"
        return Comparison(Verdict.DISAGREE, f"only the {which} has this edge on the grid")
    if math.isnan(edge) or math.isnan(converged):
        return Comparison(Verdict.INCONCLUSIVE, "the refinement met a point without a steady state")
    difference = edge - converged
    verdict = Verdict.AGREE if abs(difference) <= EDGE_TOLERANCE else Verdict.DISAGREE
    return Comparison(
        verdict, f"difference {difference:+.4f} in η_r, allowed {EDGE_TOLERANCE:g}", difference, EDGE_TOLERANCE
    )


@dataclass(frozen=True)
class Tolerance:
    """How far two answers may be apart, derived from how far either may be from the truth.

    The difference of two step sizes may vanish by chance where the error does not. The error of the step is therefore
    taken to be no smaller than that of the reference at the same step, where that is known from three of its steps:
    no engine is asked to be better than the scheme.

    Parameters
    ----------
    reference
        Error bar of the expected value, in the value's unit, >= 0; zero for a closed form.
    engine
        Estimated error of the engine's value, from its answers with two step sizes, >= 0.
    resolution
        What neither can resolve (a step of time, the residual of a steady state, round-off), >= 0.
    scheme
        Error bar of the reference's value at the same step as the engine's, >= 0.
    """

    reference: float
    engine: float
    resolution: float = 0.0
    scheme: float = 0.0

    @property
    def allowed(self) -> float:
        """Largest difference that counts as agreement."""
        return self.reference + max(self.engine, self.scheme) + self.resolution

    def __str__(self) -> str:
        parts = {
            "the reference's error bar": self.reference,
            "the engine's own step": self.engine,
            "the error of the reference's scheme at this step": self.scheme,
            "resolution": self.resolution,
        }
        larger = max(parts, key=lambda what: parts[what])
        return f"{self.allowed:.2g}, mostly {larger} ({parts[larger]:.2g})"


def step_estimate(coarse: float, fine: float) -> float:
    """Error of the finer of two values, the step of the coarser one being twice as long, of a first-order scheme."""
    return SAFETY * abs(fine - coarse)


def scheme_bar(coarse: float, middle: float, fine: float) -> float:
    """Error bar of the middle one of three values of a first-order scheme, whose steps are 1, 1/2 and 1/4.

    As in `reference_lcp.accuracy.error_bar`: if the errors are e, e/2, e/4, either difference gives e/2. Where the
    first-order part is small and the second-order part is not, both may be too small; extrapolation with
    both parts then gives the error. The largest of the three is taken, lest one of them vanishes by chance.
    """
    first, second = middle - coarse, fine - middle
    return SAFETY * max(abs(first), 2 * abs(second), abs(8 * second - first) / 3)


def compare(value: float, expected: float, tolerance: Tolerance, unit: str = "") -> Comparison:
    """Compare a value with what is expected of it; NaN on either side is inconclusive.

    Parameters
    ----------
    value, expected
        Of the engine, and of whom it is compared with.
    tolerance
        How far they may be apart.
    unit
        Printed after the numbers; empty for none.
    """
    difference = value - expected
    if math.isnan(difference) or math.isnan(tolerance.allowed):
        return Comparison(Verdict.INCONCLUSIVE, "there is no number to compare", difference)
    verdict = Verdict.AGREE if abs(difference) <= tolerance.allowed else Verdict.DISAGREE
    space = f" {unit}" if unit else ""
    reason = f"difference {difference:+.2g}{space}, allowed {tolerance}"
    return Comparison(verdict, reason, difference, tolerance.allowed)
