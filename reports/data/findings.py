"""Numbers and sentences that several parts of a report read from a compared sweep."""

import math
from collections import Counter
from dataclasses import dataclass
from statistics import median

import numpy as np

from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from reports.formatting import ratio
from scenarios.sweeps.attenuation_band import Edge
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.edges import BandEdge
from scenarios.sweeps.sweep import Case, Sweep, baseline_of
from scenarios.sweeps.table import Point
from scenarios.tasks.result import ResultStatus
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.pointwise import CONVERGED, GivenTolerance, baseline
from scenarios.verdicts.steady_case import REFERENCE
from scenarios.verdicts.verdict import Verdict

CasePoint = tuple[Case, float]
"""Case and frequency ratio."""


@dataclass(frozen=True)
class Extreme:
    """The largest difference of its kind, with its sign and its point; NaN where nothing was compared."""

    difference: float = math.nan
    case: Case | None = None
    frequency_ratio: float = math.nan


@dataclass(frozen=True)
class VariantFindings:
    """One variant in one row.

    Parameters
    ----------
    variant
        Which.
    verdicts
        Points of the grid by verdict.
    worst_difference
        Of transmittance [dB] where the baseline is above `FLOOR_DB`, from what the variant is
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


def findings(result: ComparedSweep, variant: Variant) -> VariantFindings:
    """Sum up all points and edges of a variant."""
    points = result.points_of(variant)
    converged = [point.result for point in points if point.result.converged]
    seconds = [point.result.seconds for point in points if not math.isnan(point.result.seconds)]
    counted = Counter(str(point.comparison.verdict) for point in points)
    return VariantFindings(
        variant=variant,
        verdicts={str(verdict): counted[str(verdict)] for verdict in Verdict},
        worst_difference=_worst_difference(result, points),
        worst_edge=_worst_edge(result, variant),
        worst_residual=max((result.residual for result in converged), default=math.nan),
        median_periods=float(median([result.periods for result in converged])) if converged else math.nan,
        seconds=sum(seconds) if seconds else math.nan,
    )


def drive_description(sweep: Sweep) -> str:
    """Describe the drive of the chain, and the meaning of U0."""
    drive = sweep.excitation
    if drive.kind == "base":
        return f"on a base that moves harmonically (U0 = {drive.amplitude:g} m)"
    scale = f"U0 stands for P0 / k_c = {drive.displacement:g} m"
    return f"driven by a harmonic force on the outer mass of cell 1 (P0 = {drive.amplitude:g} N; {scale})"


def compared_with(variant: Variant, given: GivenTolerance | None = None) -> str:
    """Describe the baseline of a variant, its tolerance, and the reason for both."""
    if given is not None and given.judges(variant):
        against = "converged reference" if given.baseline == CONVERGED else "reference at equal time step"
        return f"Compared with the {against}; {given.transmittance_db:g} dB are allowed, the tolerance of the sweep."
    if variant == CONVERGED:
        return "The baseline: the reference's scheme with a step so fine that its own error does not show."
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


def named_axes(sweep: Sweep, *, plural: bool = True) -> str:
    """Name what is varied beside the frequency ratio, such as ``friction ratios and mass ratios``."""
    *first, last = (axis_name(name, plural=plural) for name in sweep.case_axes)
    return f"{', '.join(first)} and {last}" if first else last


def axis_name(name: str, *, plural: bool = False) -> str:
    """Name an axis of a sweep in words."""
    if name in ("cells", "steps_per_period"):
        what = "cells" if name == "cells" else "steps"
        return f"number{'s' if plural else ''} of {what}"
    return name.replace("_", " ") + ("s" if plural else "")


def file_name(point: tuple[Case, *tuple[float, ...]]) -> str:
    """Give the values of a case, and what follows it, as part of the name of a file, such as ``0.3-0.9``."""
    case, *rest = point
    return "-".join(f"{value:g}" for value in (*case.by_axis.values(), *rest))


def baseline_curve(result: ComparedSweep, case: Case) -> dict[float, float]:
    """Transmittance [dB] by η_r of the converged reference, or of the reference where that takes no part."""
    reference = baseline_of(result.sweep.variants)
    curve = [] if reference is None else result.curve(reference, case)
    return {point.frequency_ratio: point.result.transmittance_db for point in curve if point.result.converged}


def differences(result: ComparedSweep, variant: Variant, case: Case) -> tuple[FloatArray, FloatArray]:
    """η_r, and transmittance less the converged reference's [dB]; NaN where that is below `FLOOR_DB` or unknown."""
    baseline = baseline_curve(result, case)
    pairs = []
    for point in result.curve(variant, case):
        known = point.result.converged and baseline.get(point.frequency_ratio, -math.inf) > FLOOR_DB
        difference = point.result.transmittance_db - baseline[point.frequency_ratio] if known else math.nan
        pairs.append((point.frequency_ratio, difference))
    etas, all_differences = np.array(pairs).reshape(-1, 2).T
    return etas, all_differences


def reference_line(result: ComparedSweep, case: Case) -> tuple[FloatArray, FloatArray]:
    """η_r and transmittance [dB] of the reference: its dense curve, and the grid with the resonances in it."""
    eta, curve = result.dense_reference.get(case, (np.empty(0), np.empty(0)))
    known = dict(zip(eta.tolist(), curve.tolist(), strict=True))
    for point in result.curve(REFERENCE, case):
        known[point.frequency_ratio] = point.result.transmittance_db if point.result.converged else math.nan
    ascending = sorted(known.items())
    return np.array([eta for eta, _ in ascending]), np.array([value for _, value in ascending])


def converged_edges(result: ComparedSweep, case: Case) -> list[float]:
    """η_r of the edges of the converged reference that are known."""
    etas = [edge.frequency_ratio for edge in result.edges if (edge.variant, edge.case) == (CONVERGED, case)]
    return [eta for eta in etas if eta is not None and not math.isnan(eta)]


def blocked_reason(result: ComparedSweep, variant: Variant) -> str | None:
    """Give the reason why a variant has no result at all; ``None`` if it has one."""
    results = [point.result for point in result.points_of(variant)]
    if not results or any(own.status is not ResultStatus.BLOCKED for own in results):
        return None
    return results[0].reason


def absent_edge(result: ComparedSweep, edge: BandEdge) -> str:
    """Describe an edge that the grid does not hold."""
    curve = [point for point in result.curve(edge.variant, edge.case) if point.result.converged]
    if not curve:
        return "unknown"
    if all(point.result.transmittance_db >= result.sweep.band.depth_db for point in curve):
        return "none"
    if edge.edge is Edge.LOWER:
        return f"below {curve[0].frequency_ratio:g}"
    return f"above {curve[-1].frequency_ratio:g}"


def band_definition(result: ComparedSweep) -> str:
    """Give the definition of the attenuation band in a sentence."""
    band = result.sweep.band
    return (
        "The low-frequency attenuation band is the interval of η_r that holds the first deep attenuation "
        f"(transmittance below {ratio(band.depth_db)} dB), extended both ways to where the transmittance crosses "
        f"{ratio(band.threshold_db)} dB."
    )


def _worst_difference(result: ComparedSweep, points: list[Point]) -> Extreme:
    baselines = {case: baseline_curve(result, case) for case in result.cases}
    compared = [
        Extreme(point.comparison.difference, point.case, point.frequency_ratio)
        for point in points
        if not math.isnan(point.comparison.difference)
        and baselines[point.case].get(point.frequency_ratio, -math.inf) > FLOOR_DB
    ]
    return _largest(compared)


def _worst_edge(result: ComparedSweep, variant: Variant) -> Extreme:
    compared = [
        Extreme(edge.comparison.difference, edge.case, edge.frequency_ratio)
        for edge in result.edges
        if edge.variant == variant and edge.frequency_ratio is not None and not math.isnan(edge.comparison.difference)
    ]
    return _largest(compared)


def _largest(compared: list[Extreme]) -> Extreme:
    return max(compared, key=lambda extreme: abs(extreme.difference), default=Extreme())
