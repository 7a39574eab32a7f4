"""What a point of figure 3 is compared with, and how far it may be from it.

Presets that share the Euler scheme solve the reference's own equations: they are compared with the reference at equal
step, and nothing is allowed but what neither can resolve. All others, the reference itself among them, are compared
with the converged reference. They are simulated with half as many steps too, so that their own error is known; the
reference is simulated with twice and four times as many, and is judged by them itself.
"""

import math
from dataclasses import dataclass

from engines.interface.variant import Variant
from engines.reference import CONVERGED_SUBSTEPS
from scenarios.tasks.result import Result
from scenarios.verdicts.finding import FLOOR_DB, TRANSMITTANCE
from scenarios.verdicts.judge import Steps, decide, missing
from scenarios.verdicts.steady_case import REFERENCE, resolution_db
from scenarios.verdicts.verdict import Comparison, Tolerance, Verdict

CONVERGED = Variant("reference", preset_name="converged")


@dataclass(frozen=True, kw_only=True)
class GivenTolerance:
    """A tolerance that is given, instead of one that is derived at every point.

    Parameters
    ----------
    transmittance_db
        Largest difference of transmittance that counts as agreement [dB] > 0.
    baseline
        What variants are compared with: the reference or its converged preset.
    """

    transmittance_db: float
    baseline: Variant

    def judges(self, variant: Variant) -> bool:
        """Whether it is for this variant: for all but what others are compared with."""
        return variant not in (self.baseline, CONVERGED)


def baseline(variant: Variant, given: GivenTolerance | None = None) -> Variant:
    """Give what a variant is compared with."""
    if given is not None and given.judges(variant):
        return given.baseline
    return REFERENCE if variant.engine != REFERENCE.engine and variant.preset.shares_scheme else CONVERGED


def refinements(variant: Variant, given: GivenTolerance | None = None) -> tuple[float, ...]:
    """Give with how many times the steps a variant is simulated too, for the sake of its own error.

    With none where it shares the reference's error, is the baseline itself, or is judged by a tolerance that is given.
    """
    if given is not None and given.judges(variant):
        return ()
    if variant == REFERENCE:
        return (2.0, 4.0)
    return (0.5,) if baseline(variant) == CONVERGED != variant else ()


@dataclass(frozen=True, kw_only=True)
class PointResults:
    """Results at one point of the grid.

    Parameters
    ----------
    variant
        The one that is compared.
    result
        Its result.
    others
        Its results with other numbers of steps, see `refinements`.
    reference, converged
        The reference's results at the same point, at equal step and converged.
    amplified
        How many times farther from its steady state the result may be than its residual, see `amplification`.
    refined
        The reference's results at the same point with other numbers of steps.
    given
        The tolerance, where it is given; without it, it is derived.
    """

    variant: Variant
    result: Result
    others: tuple[Result, ...]
    reference: Result
    converged: Result
    amplified: float
    refined: tuple[Result, ...] = ()
    given: GivenTolerance | None = None

    def expected(self, against: Variant) -> Result:
        """Give the result of the baseline."""
        return self.reference if against == REFERENCE else self.converged


def compare_point(known: PointResults) -> Comparison:
    """Compare a point with its baseline."""
    against = baseline(known.variant, known.given)
    expected = known.expected(against)
    gap = missing("engine", [known.result]) or missing("reference", [expected])
    if gap is not None:
        return gap
    tolerance = point_tolerance(known, against)
    comparison = decide(TRANSMITTANCE, known.result.transmittance_db, expected.transmittance_db, tolerance)
    return unless_own_error_is_unknown(known, comparison)


def unless_own_error_is_unknown(known: PointResults, comparison: Comparison) -> Comparison:
    """Leave a disagreement open where the variant's own error is unknown: no steady state with other steps."""
    if comparison.verdict is not Verdict.DISAGREE or all(other.converged for other in known.others):
        return comparison
    reason = f"{comparison.reason}; no steady state with other steps gives its own error"
    return Comparison(Verdict.INCONCLUSIVE, reason, comparison.difference, comparison.tolerance)


def point_tolerance(known: PointResults, against: Variant) -> Tolerance:
    """Derive how far the transmittance of a point may be from that of the reference or of its converged preset [dB]."""
    if known.given is not None and known.given.judges(known.variant):
        return Tolerance(given=known.given.transmittance_db)
    level = max(known.expected(against).transmittance_db, FLOOR_DB)
    resolution = resolution_db(known.variant, known.result, level, known.amplified)
    if against == REFERENCE:
        return Tolerance(resolution=resolution)
    scheme = _by_steps(known.reference, *known.refined)
    finest = known.converged.steps_per_period * CONVERGED_SUBSTEPS
    scheme[finest] = known.converged.transmittance_db
    own = _by_steps(known.result, *known.others)
    at = known.reference.steps_per_period if known.reference.converged else finest
    return Tolerance(
        reference=Steps(scheme, finest).error(TRANSMITTANCE),
        engine=Steps(own, known.result.steps_per_period).error(TRANSMITTANCE),
        resolution=resolution,
        # the reference itself is judged by its own steps alone: its error cannot excuse itself
        scheme=0.0 if known.variant == REFERENCE else Steps(scheme, at).error(TRANSMITTANCE),
    )


def own_error_db(known: PointResults) -> float:
    """Estimate the error of a point from its own steps [dB]; NaN where it is known with one number of steps only."""
    own = _by_steps(known.result, *known.others)
    if not known.result.converged or len(own) < 2:
        return math.nan
    return Steps(own, known.result.steps_per_period).error(TRANSMITTANCE)


def _by_steps(*results: Result) -> dict[int, float]:
    """Transmittance [dB] of those that have a steady state, by steps a period."""
    return {result.steps_per_period: result.transmittance_db for result in results if result.converged}
