"""What a point of figure 3 is compared with, and how far it may be from it.

Presets that share the Euler scheme solve the reference's own equations: they are compared with the reference at equal
step, and nothing is allowed but what neither can resolve. All others, the reference itself among them, are compared
with the converged reference. They are simulated with half as many steps too, so that their own error is known; the
reference is simulated with twice and four times as many, and is judged by them itself.

The transmittance is a complex number: its level and its phase are judged alike, and the worse of both decides.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from engines.interface.variant import Variant
from engines.reference import CONVERGED_SUBSTEPS
from reference_lcp.steady.richardson import amplitude_in_db
from scenarios.runs.result import Result
from scenarios.verdicts.finding import (
    FLOOR_DB,
    PHASE,
    TRANSMITTANCE,
    Comparison,
    Finding,
    Metric,
    Tolerance,
    Verdict,
    amplitude_in_degrees,
    phase_reader,
)
from scenarios.verdicts.judge import FrictionEffect, Number, Steps, certified, decide, missing
from scenarios.verdicts.steady_case import REFERENCE, amplification, is_resolved, resolution

CONVERGED = Variant("reference", preset_name="converged")

POINT_METRICS = (TRANSMITTANCE, PHASE)
"""What is judged at a point."""

UNBOUNDED = FrictionEffect(math.inf, math.inf)
"""No step is too coarse for it."""


@dataclass(frozen=True, kw_only=True)
class GivenTolerance:
    """A tolerance that is given, instead of one that is derived at every point."""

    transmittance_db: float
    """Largest difference of transmittance that counts as agreement [dB] > 0."""
    baseline: Variant
    """What variants are compared with: the reference or its converged preset."""

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
    """Results at one point of the grid."""

    variant: Variant
    result: Result
    others: tuple[Result, ...]
    """Its results with other numbers of steps, see `refinements`."""
    reference: Result
    converged: Result
    """The reference's results at the same point, at equal step and converged."""
    refined: tuple[Result, ...] = ()
    """The reference's results at the same point with other numbers of steps."""
    given: GivenTolerance | None = None
    """The tolerance, where it is given; without it, it is derived."""
    effect: FrictionEffect = UNBOUNDED

    @property
    def against(self) -> Variant:
        """The baseline of the variant."""
        return baseline(self.variant, self.given)

    def expected(self, against: Variant) -> Result:
        """Give the result of the baseline."""
        return self.reference if against == REFERENCE else self.converged

    @property
    def is_known(self) -> bool:
        """Whether the result is certified, or repeats well enough to be compared all the same."""
        return self.result.converged or is_resolved(self.result, amplification(self.reference))


def point_findings(known: PointResults, label: str = "") -> tuple[Finding, ...]:
    """Compare a point with its baseline: a finding for each of `POINT_METRICS`; no phase where none is expected."""
    expected = known.expected(known.against)
    readers = _readers(expected)
    gap = (None if known.is_known else missing("engine", [known.result])) or missing("reference", [expected])
    if gap is not None:
        return tuple(Finding.without_numbers(known.variant, label, readers, gap))
    findings = (
        Finding(known.variant, label, metric, read(known.result), read(expected), _compared(known, metric, read))
        for metric, read in readers.items()
    )
    certain = certified([known.result])
    return tuple(finding if certain else finding.uncertified() for finding in findings)


Read = Callable[[Result], float]
"""Gives a number of a result."""


def _readers(expected: Result) -> dict[Metric, Read]:
    """Give what is read of results, by metric."""
    readers: dict[Metric, Read] = {TRANSMITTANCE: lambda result: result.transmittance_db}
    if not math.isnan(expected.phase):
        readers[PHASE] = phase_reader(expected.phase, expected.transmittance_db)
    return readers


def _compared(known: PointResults, metric: Metric, read: Read) -> Comparison:
    """Compare one number of a point."""
    expected = known.expected(known.against)
    tolerance = _tolerance(known, known.against, metric, read)
    effect = known.effect.transmittance_db if metric == TRANSMITTANCE else known.effect.phase
    comparison = decide(metric, read(known.result), read(expected), tolerance, effect)
    comparison = unless_own_error_is_unknown(known, comparison)
    if metric == TRANSMITTANCE:
        return comparison
    per_amplitude = amplitude_in_degrees(1.0, expected.transmittance_db)
    return replace(comparison, per_amplitude=per_amplitude, reason=f"{metric.name}: {comparison.reason}")


_SEVERITY = (Verdict.AGREE, Verdict.INCONCLUSIVE, Verdict.TOO_COARSE, Verdict.DISAGREE, Verdict.BLOCKED)


def decisive(findings: Sequence[Finding]) -> Finding:
    """Give the worst finding of a point: by its verdict, then by its difference over what is allowed."""
    return max(findings, key=lambda own: (_SEVERITY.index(own.comparison.verdict), own.excess))


def unless_own_error_is_unknown(known: PointResults, comparison: Comparison) -> Comparison:
    """Leave a disagreement open where the variant's own error is unknown: no steady state with other steps."""
    if comparison.verdict is not Verdict.DISAGREE or all(other.converged for other in known.others):
        return comparison
    reason = f"{comparison.reason}; no steady state with other steps gives its own error"
    return replace(comparison, verdict=Verdict.INCONCLUSIVE, reason=reason)


def point_tolerance(known: PointResults, against: Variant) -> Tolerance:
    """Derive how far the transmittance of a point may be from that of the reference or of its converged preset [dB]."""
    return _tolerance(known, against, TRANSMITTANCE, _readers(known.expected(against))[TRANSMITTANCE])


def _tolerance(known: PointResults, against: Variant, metric: Metric, read: Read) -> Tolerance:
    """Derive how far a number of a point may be from that of the baseline."""
    if known.given is not None and known.given.judges(known.variant):
        return Tolerance(given=_given(known.given.transmittance_db, metric))
    left_open = point_resolution(known, against, metric)
    if against == REFERENCE:
        return Tolerance(resolution=left_open)
    scheme = scheme_by_steps(known, read)
    finest = max(scheme)
    own = {known.result.steps_per_period: read(known.result)} | _by_steps(read, *known.others)
    at = known.reference.steps_per_period if known.reference.converged else finest
    return Tolerance(
        reference=Steps(scheme, finest).error(metric),
        engine=Steps(own, known.result.steps_per_period).error(metric),
        resolution=left_open,
        # the reference itself is judged by its own steps alone: its error cannot excuse itself
        scheme=0.0 if known.variant == REFERENCE else Steps(scheme, at).error(metric),
    )


def scheme_by_steps(known: PointResults, read: Read) -> dict[int, Number]:
    """Read a number of the reference's results by steps a period; that of the converged reference is the finest."""
    scheme = _by_steps(read, known.reference, *known.refined)
    if known.converged.converged:
        scheme[known.converged.steps_per_period * CONVERGED_SUBSTEPS] = read(known.converged)
    return scheme


def point_resolution(known: PointResults, against: Variant, metric: Metric) -> float:
    """Give what a result leaves open of a number, in the unit of the metric."""
    level = max(known.expected(against).transmittance_db, FLOOR_DB)
    return (amplitude_in_db if metric == TRANSMITTANCE else amplitude_in_degrees)(amplitude_left_open(known), level)


def amplitude_left_open(known: PointResults) -> float:
    """Give what a result leaves open of its amplitude, over the displacement scale."""
    return resolution(known.variant, known.result, known.result.transmittance_db, amplification(known.reference))


def _given(transmittance_db: float, metric: Metric) -> float:
    """Give a tolerance of the transmittance for a metric: a change of amplitude of that size, in any direction."""
    if metric == TRANSMITTANCE:
        return transmittance_db
    return min(180.0, math.degrees(10 ** (transmittance_db / 20) - 1))


def own_error_db(known: PointResults) -> float:
    """Estimate the error of a point from its own steps [dB]; NaN where it is known with one number of steps only."""
    own = _by_steps(lambda result: result.transmittance_db, known.result, *known.others)
    if not known.result.converged or len(own) < 2:
        return math.nan
    return Steps(own, known.result.steps_per_period).error(TRANSMITTANCE)


def _by_steps(read: Read, *results: Result) -> dict[int, Number]:
    """Read a number of those that have a steady state, by steps a period."""
    return {result.steps_per_period: read(result) for result in results if result.converged}
