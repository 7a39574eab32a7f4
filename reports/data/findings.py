"""What is read from a result of figure 3 in more than one place of the report."""

import math
from collections import Counter
from dataclasses import dataclass
from statistics import median

import numpy as np

from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from reports.formatting import ratio
from scenarios.studies.attenuation_band import Edge
from scenarios.studies.figure3 import CONVERGED, REFERENCE, BandEdge, Figure3, Figure3Result, Point
from scenarios.tasks.result import ResultStatus
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.pointwise import GivenTolerance, baseline
from scenarios.verdicts.verdict import Verdict

OperatingPoint = tuple[float, float]
"""Friction ratio and frequency ratio."""


@dataclass(frozen=True)
class Extreme:
    """The largest difference of its kind, with its sign and its place; NaN where nothing was compared."""

    difference: float = math.nan
    friction_ratio: float = math.nan
    frequency_ratio: float = math.nan


@dataclass(frozen=True)
class VariantFindings:
    """One variant in one row.

    Parameters
    ----------
    variant
        Who.
    verdicts
        Points of the grid by verdict.
    worst_difference
        Of transmittance [dB] where the converged reference is above `FLOOR_DB`, from what the variant is
        compared with.
    worst_edge
        Of the band edges, from the converged reference.
    worst_residual
        Largest periodicity residual of the points that converged.
    median_periods
        Periods simulated until a point converged, the median.
    seconds
        Time of all points of the grid together, on one core, with those that did not converge; refinement of
        edges not counted.
    """

    variant: Variant
    verdicts: dict[str, int]
    worst_difference: Extreme
    worst_edge: Extreme
    worst_residual: float
    median_periods: float
    seconds: float


def findings(result: Figure3Result, variant: Variant) -> VariantFindings:
    """Sum up all points and edges of a variant."""
    points = result.points_of(variant)
    converged = [point.answer for point in points if point.answer.converged]
    seconds = [point.answer.seconds for point in points if not math.isnan(point.answer.seconds)]
    counted = Counter(str(point.comparison.verdict) for point in points)
    return VariantFindings(
        variant=variant,
        verdicts={str(verdict): counted[str(verdict)] for verdict in Verdict},
        worst_difference=_worst_difference(result, points),
        worst_edge=_worst_edge(result, variant),
        worst_residual=max((answer.residual for answer in converged), default=math.nan),
        median_periods=float(median([answer.periods for answer in converged])) if converged else math.nan,
        seconds=sum(seconds) if seconds else math.nan,
    )


def drive_description(asked: Figure3) -> str:
    """Say what drives the chain, and what U0 stands for."""
    drive = asked.excitation
    if drive.kind == "base":
        return f"on a base that moves harmonically (U0 = {drive.amplitude:g} m)"
    scale = f"U0 stands for P0 / k_c = {drive.displacement:g} m"
    return f"driven by a harmonic force on the outer mass of cell 1 (P0 = {drive.amplitude:g} N; {scale})"


def compared_with(variant: Variant, given: GivenTolerance | None = None) -> str:
    """Say what a variant is compared with, how closely, and why so."""
    if given is not None and given.judges(variant):
        whom = "converged reference" if given.baseline == CONVERGED else "reference at equal time step"
        return f"Compared with the {whom}; {given.transmittance_db:g} dB are allowed, as the file of the sweep says."
    if variant == CONVERGED:
        return "The ruler: the reference's scheme with a step so fine that its own error does not show."
    if variant == REFERENCE:
        return (
            "Compared with the converged reference: the difference is the scheme's own first-order step error, and its "
            "own estimate from two step sizes is allowed."
        )
    if baseline(variant) == REFERENCE:
        return (
            "Takes the same semi-implicit Euler step as the reference, and so shares its step error: compared with "
            "the reference at equal time step; nothing is allowed but what neither can resolve."
        )
    return (
        "Has an integrator of its own: compared with the converged reference; its own error is allowed, from two step "
        "sizes, or the reference's at the same step where that is larger."
    )


def converged_curve(result: Figure3Result, friction_ratio: float) -> dict[float, float]:
    """Transmittance [dB] of the converged reference by η_r, where it has a steady state."""
    curve = result.curve(CONVERGED, friction_ratio)
    return {point.frequency_ratio: point.answer.transmittance_db for point in curve if point.answer.converged}


def differences(result: Figure3Result, variant: Variant, friction_ratio: float) -> tuple[FloatArray, FloatArray]:
    """η_r, and transmittance less the converged reference's [dB]; NaN where that is below `FLOOR_DB` or unknown."""
    baseline = converged_curve(result, friction_ratio)
    pairs = []
    for point in result.curve(variant, friction_ratio):
        known = point.answer.converged and baseline.get(point.frequency_ratio, -math.inf) > FLOOR_DB
        difference = point.answer.transmittance_db - baseline[point.frequency_ratio] if known else math.nan
        pairs.append((point.frequency_ratio, difference))
    eta, found = np.array(pairs).reshape(-1, 2).T
    return eta, found


def reference_line(result: Figure3Result, friction_ratio: float) -> tuple[FloatArray, FloatArray]:
    """η_r and transmittance [dB] of the reference: its dense curve, and the grid with the resonances in it."""
    eta, curve = result.dense_reference[friction_ratio]
    known = dict(zip(eta.tolist(), curve.tolist(), strict=True))
    for point in result.curve(REFERENCE, friction_ratio):
        known[point.frequency_ratio] = point.answer.transmittance_db if point.answer.converged else math.nan
    ascending = sorted(known.items())
    return np.array([place for place, _ in ascending]), np.array([value for _, value in ascending])


def blocked_reason(result: Figure3Result, variant: Variant) -> str | None:
    """Say why a variant has not a single answer; ``None`` if it has one."""
    answers = [point.answer for point in result.points_of(variant)]
    if not answers or any(answer.status is not ResultStatus.BLOCKED for answer in answers):
        return None
    return answers[0].reason


def absent_edge(result: Figure3Result, edge: BandEdge) -> str:
    """Say where an edge is that the grid does not hold."""
    curve = [point for point in result.curve(edge.variant, edge.friction_ratio) if point.answer.converged]
    if not curve:
        return "unknown"
    if all(point.answer.transmittance_db >= result.asked.band.depth_db for point in curve):
        return "none"
    if edge.edge is Edge.LOWER:
        return f"below {curve[0].frequency_ratio:g}"
    return f"above {curve[-1].frequency_ratio:g}"


def band_definition(result: Figure3Result) -> str:
    """Give the definition of the attenuation band in a sentence."""
    band = result.asked.band
    return (
        "The low-frequency attenuation band is the interval of η_r that holds the first deep attenuation "
        f"(transmittance below {ratio(band.depth_db)} dB), extended both ways to where the transmittance crosses "
        f"{ratio(band.threshold_db)} dB."
    )


def _worst_difference(result: Figure3Result, points: list[Point]) -> Extreme:
    baselines = {friction: converged_curve(result, friction) for friction in result.asked.friction_ratios}
    compared = [
        Extreme(point.comparison.difference, point.friction_ratio, point.frequency_ratio)
        for point in points
        if not math.isnan(point.comparison.difference)
        and baselines[point.friction_ratio].get(point.frequency_ratio, -math.inf) > FLOOR_DB
    ]
    return _largest(compared)


def _worst_edge(result: Figure3Result, variant: Variant) -> Extreme:
    compared = [
        Extreme(edge.comparison.difference, edge.friction_ratio, edge.frequency_ratio)
        for edge in result.edges
        if edge.variant == variant and edge.frequency_ratio is not None and not math.isnan(edge.comparison.difference)
    ]
    return _largest(compared)


def _largest(compared: list[Extreme]) -> Extreme:
    return max(compared, key=lambda extreme: abs(extreme.difference), default=Extreme())
