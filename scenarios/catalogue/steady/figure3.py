"""Figure 3 of the paper: transmittance of the seven cells, and where the attenuation band begins."""

import dataclasses
import math
from collections.abc import Mapping

from scenarios.catalogue.steady.base import SAME_STEP, SteadyScenario, point_case
from scenarios.runs.result import Result
from scenarios.sweeps.attenuation_band import BandDefinition
from scenarios.verdicts.finding import TRANSMITTANCE, Comparison, Finding, Metric, Verdict
from scenarios.verdicts.judge import Steps, judge
from scenarios.verdicts.steady_case import Evidence, Expected, SteadyCase

LOWER_EDGE = Metric(
    "lower edge",
    "η_r",
    f"of the low-frequency attenuation band ({BandDefinition()}): where the straight line through two points of the "
    "curve, one on either side, crosses the threshold; read alike from the exact curve",
)

HALF_WIDTH = 0.004
"""Distance in η_r of the two points from the edge: the line between them crosses the threshold within 0.0003 of
where the exact curve does."""

LONGEST_EXTRAPOLATION = 0.05
"""Distance in η_r from the two points up to which the line through them is extrapolated."""

LOWER_EDGES = {0.3: 0.637, 1.0: 0.999}
"""Friction ratios of the widest band and of cells that nearly lock; its lower edges, to three digits."""


EDGE_CASES = {
    friction: [point_case(friction, round(edge + side, 6)) for side in (-HALF_WIDTH, HALF_WIDTH)]
    for friction, edge in LOWER_EDGES.items()
}


class Figure3Points(SteadyScenario):
    """The canonical chain at points of figure 3."""

    name = "figure3"
    source = "Sethi, Banerjee, Manna, figure 3: mass and stiffness ratio 1, ζ = 0.01, seven cells"
    cases = (*(case for pair in EDGE_CASES.values() for case in pair), point_case(0.6, 0.9), point_case(0.1, 0.6))
    metrics = (TRANSMITTANCE, SAME_STEP, LOWER_EDGE)

    def judged(self, by_case: Mapping[SteadyCase, Evidence]) -> list[Finding]:
        """Judge transmittance point by point, then the edges."""
        edges = [
            edge_finding(f"friction {friction:g}", by_case[below], by_case[above])
            for friction, (below, above) in EDGE_CASES.items()
        ]
        return [*super().judged(by_case), *edges]


def edge_finding(label: str, below: Evidence, above: Evidence) -> Finding:
    """Compare a lower edge, from the evidence at a point on either side of it."""
    missing = below.missing or above.missing
    if missing is not None:
        return Finding(below.variant, label, LOWER_EDGE, math.nan, math.nan, missing)
    expected, coarse, fine = (
        crossing(below.case, above.case, getattr(below, name), getattr(above, name))
        for name in ("expected", "coarse", "fine")
    )
    if math.isnan(fine):
        reason = f"no edge within {LONGEST_EXTRAPOLATION:g} of {expected:.3f} in η_r"
        return Finding(below.variant, label, LOWER_EDGE, math.nan, expected, Comparison(Verdict.DISAGREE, reason))
    scheme = {
        low.steps_per_period: crossing(below.case, above.case, low, high)
        for low, high in zip(below.scheme, above.scheme, strict=True)
    }
    shifted = crossing(below.case, above.case, *(_shifted(side) for side in (below, above)))
    comparison = judge(
        LOWER_EDGE,
        Steps({below.coarse.steps_per_period: coarse, below.fine.steps_per_period: fine}),
        expected,
        scheme=Steps(scheme, below.scheme[1].steps_per_period),
        resolution=abs(shifted - expected),
    )
    return Finding(below.variant, label, LOWER_EDGE, fine, expected, comparison)


def crossing(below: SteadyCase, above: SteadyCase, low: Result | Expected, high: Result | Expected) -> float:
    """Give η_r where the straight line through two points crosses the threshold; NaN where it does not nearby."""
    threshold = BandDefinition().threshold_db
    fall = low.transmittance_db - high.transmittance_db
    if fall <= 0:
        return math.nan
    width = above.frequency_ratio - below.frequency_ratio
    eta = below.frequency_ratio + width * (low.transmittance_db - threshold) / fall
    middle = (below.frequency_ratio + above.frequency_ratio) / 2
    return eta if abs(eta - middle) <= LONGEST_EXTRAPOLATION else math.nan


def _shifted(evidence: Evidence) -> Expected:
    """Give what is expected, raised by what the engine cannot resolve."""
    rise = evidence.resolution_db(evidence.expected.transmittance_db)
    return dataclasses.replace(evidence.expected, transmittance_db=evidence.expected.transmittance_db + rise)
