"""Edges of the attenuation band, beside those of what a variant is compared with.

An edge is where a curve crosses a threshold: a change δ of the transmittance [dB] moves it by δ / slope. What is
allowed at the edge itself and at the two points of the grid around it, over the slope of the baseline's curve there, is
therefore what is allowed of the edge, and the widths to which both edges are bracketed besides. The baseline is that of
the points: presets that share the Euler scheme are compared at equal step, where nothing but resolution is allowed.
"""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

from engines.interface.variant import Variant
from scenarios.verdicts.finding import Metric
from scenarios.verdicts.judge import decide
from scenarios.verdicts.pointwise import CONVERGED, PointResults, point_tolerance, unless_own_error_is_unknown
from scenarios.verdicts.verdict import Comparison, Tolerance, Verdict

BAND_EDGE = Metric("band edge", "in η_r", "where the transmittance crosses the threshold of the attenuation band")


@dataclass(frozen=True)
class Crossing:
    """Where a curve crosses the threshold, found by refinement with simulations.

    Parameters
    ----------
    frequency_ratio
        η_r; NaN where the refinement met a point without a steady state.
    slope
        Of the transmittance between the ends of the bracket [dB]; per unit of η_r.
    width
        Of the bracket in η_r.
    residual_db
        What motions that decided a side without being certified leave open of their transmittance [dB].
    level_db
        The threshold [dB].
    """

    frequency_ratio: float
    slope: float = math.nan
    width: float = 0.0
    residual_db: float = 0.0
    level_db: float = 0.0


def compare_edge(
    edge: Crossing | None,
    expected: Crossing | None,
    around: Sequence[PointResults] = (),
    against: Variant = CONVERGED,
) -> Comparison:
    """Compare a band edge with that of the baseline.

    Parameters
    ----------
    edge, expected
        Of the variant and of its baseline; ``None`` is an edge outside the grid.
    around
        Results at the expected edge, and at the points of the grid on either side of it.
    against
        The baseline, see `scenarios.verdicts.pointwise.baseline`.
    """
    if edge is None and expected is None:
        return Comparison(Verdict.AGREE, "no such edge on the grid, for the reference neither")
    if edge is None or expected is None:
        which = "reference" if edge is None else "engine"
        return Comparison(Verdict.DISAGREE, f"only the {which} has this edge on the grid")
    if math.isnan(edge.frequency_ratio) or math.isnan(expected.frequency_ratio):
        return Comparison(Verdict.INCONCLUSIVE, "the refinement met a point without a steady state")
    known = [point for point in around if point.is_known and point.expected(against).converged]
    tolerance = _edge_tolerance(edge, expected, known, against)
    comparison = decide(BAND_EDGE, edge.frequency_ratio, expected.frequency_ratio, tolerance)
    comparison = dataclasses.replace(comparison, per_amplitude=_per_amplitude(expected))
    if comparison.verdict is Verdict.DISAGREE and not known:
        reason = f"{comparison.reason}; no steady state beside it gives its own error"
        return dataclasses.replace(comparison, verdict=Verdict.INCONCLUSIVE, reason=reason)
    for point in known:
        comparison = unless_own_error_is_unknown(point, comparison)
    return comparison


def _edge_tolerance(edge: Crossing, expected: Crossing, known: Sequence[PointResults], against: Variant) -> Tolerance:
    """Derive how far an edge may be from the expected one in η_r: of every part, the largest around it counts."""
    sides = [dataclasses.asdict(point_tolerance(point, against)) for point in known]
    largest = {part: max((side[part] for side in sides), default=0.0) for part in dataclasses.asdict(Tolerance())}
    largest["resolution"] += edge.residual_db + expected.residual_db
    tolerance = Tolerance(**largest).over(expected.slope)
    return dataclasses.replace(tolerance, resolution=tolerance.resolution + edge.width + expected.width)


def _per_amplitude(expected: Crossing) -> float:
    """By how much a small change of the amplitude moves the edge in η_r, per displacement scale."""
    return 20 / math.log(10) * 10 ** (-expected.level_db / 20) / abs(expected.slope)
