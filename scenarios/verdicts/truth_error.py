"""One ruler for all variants: how far a transmittance is from the truth.

The truth at a point is that of the exact motion, event by event, where it is certified, and that of the converged
reference elsewhere. It is one number for all variants, whatever each of them is judged by, and has an error itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from reference_lcp.steady.richardson import amplitude_in_db, unresolved_amplitude
from scenarios.runs.result import Result
from scenarios.verdicts.finding import FLOOR_DB, TRANSMITTANCE
from scenarios.verdicts.judge import Steps, metric_difference
from scenarios.verdicts.pointwise import CONVERGED, PointResults, point_resolution, scheme_by_steps
from scenarios.verdicts.steady_case import amplification

WRONG_DB = 3.0
"""Error from which on a variant is wrong [dB]: the amplitude is off by the root of two, the power by two. That is the
half-power by which bands are commonly bounded, so that a band may end elsewhere."""


class ErrorClass(StrEnum):
    """How far a variant is from the truth."""

    WITHIN_STEP = "within the step's error"
    """Nowhere farther from the truth than the reference's scheme is with as many steps, and what nothing resolves."""
    VISIBLE = "visible"
    """Farther than that somewhere, and off by less than `WRONG_DB` everywhere."""
    WRONG = "wrong"
    """Off by `WRONG_DB` or more somewhere."""


@dataclass(frozen=True)
class TrueTransmittance:
    """The true transmittance of a point."""

    transmittance_db: float
    """20 log10 |U_n| / U0 [dB]."""
    error_db: float
    """Its own error bar [dB]."""
    exact: bool
    """Whether it is that of the exact motion, and not that of the converged reference."""

    @property
    def above_floor(self) -> bool:
        """Whether a difference from it in dB says something, see `FLOOR_DB`."""
        return self.transmittance_db > FLOOR_DB


@dataclass(frozen=True)
class TruthError:
    """How far a variant is from the truth at a point."""

    error_db: float
    """Transmittance less the true one [dB], on the scale of `TRANSMITTANCE`."""
    step_db: float
    """What the scheme errs by with as many steps, and what neither the variant nor the truth resolves [dB]; NaN where
    the reference has no steady state."""

    @property
    def within_step(self) -> bool:
        """Whether it is no farther from the truth than the scheme is."""
        return abs(self.error_db) <= self.step_db


def truth_of(known: PointResults, exact: Result) -> TrueTransmittance | None:
    """Give the truth at a point; ``None`` where neither the exact motion nor the converged reference is certified."""
    if exact.converged:
        steps = max(exact.periods, 1) * exact.steps_per_period
        left_open = unresolved_amplitude(exact.residual, amplification(known.reference), steps, exact.transmittance_db)
        level = max(exact.transmittance_db, FLOOR_DB)
        return TrueTransmittance(exact.transmittance_db, amplitude_in_db(left_open, level), exact=True)
    if known.converged.converged:
        values = Steps(scheme_by_steps(known, _level))
        return TrueTransmittance(known.converged.transmittance_db, values.error(TRANSMITTANCE), exact=False)
    return None


def truth_error(known: PointResults, truth: TrueTransmittance) -> TruthError | None:
    """Compare a variant with the truth at a point; ``None`` where it has no steady state that can be compared."""
    if not known.is_known:
        return None
    error = metric_difference(TRANSMITTANCE, known.result.transmittance_db, truth.transmittance_db)
    resolution = point_resolution(known, CONVERGED, TRANSMITTANCE)
    return TruthError(error, _scheme_error(known, truth) + truth.error_db + resolution)


def error_class(errors: Sequence[TruthError]) -> ErrorClass | None:
    """Give the class of a variant with these errors; ``None`` where none of them is known."""
    if not errors:
        return None
    if any(abs(error.error_db) >= WRONG_DB for error in errors):
        return ErrorClass.WRONG
    return ErrorClass.WITHIN_STEP if all(error.within_step for error in errors) else ErrorClass.VISIBLE


def _scheme_error(known: PointResults, truth: TrueTransmittance) -> float:
    """Give what the reference's scheme errs by with the steps of the variant [dB]: measured, the truth being known."""
    values = scheme_by_steps(known, _level)
    steps = known.reference.steps_per_period
    if steps not in values:
        return float("nan")
    return Steps(values, steps, truth.transmittance_db).error(TRANSMITTANCE)


def _level(result: Result) -> float:
    return result.transmittance_db
