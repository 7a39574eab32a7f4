"""Departures of variants, and what their laws leave of them."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import median

from engines.interface.law import NotModelled
from engines.interface.variant import Variant
from scenarios.sweeps.compared import ComparedSweep
from scenarios.verdicts.failure import unexplained
from scenarios.verdicts.finding import TRANSMITTANCE, Finding

AS_PREDICTED, UNEXPLAINED = "as its law predicts", "unexplained"


@dataclass(frozen=True)
class Departure:
    """How far a transmittance is from what it is compared with, and what the law leaves of that [dB]; signed."""

    departure: float
    left: float

    @property
    def prediction(self) -> float:
        """What the law says of the departure [dB]."""
        return self.departure - self.left


@dataclass(frozen=True)
class Departures:
    """One variant that departs, in one row.

    Parameters
    ----------
    variant
        Which.
    points, edges
        How many of its points and edges depart.
    unexplained
        How many of both no law predicts.
    worst
        The largest departure of transmittance, and what is left of it.
    median
        The medians over the points that depart, of sizes.
    largest_left
        Largest size of what is left [dB]; NaN without a law.
    note
        Why there is no prediction; empty where there is one.
    """

    variant: Variant
    points: int
    edges: int
    unexplained: int
    worst: Departure
    median: tuple[float, float, float]
    largest_left: float
    note: str


def outcome(findings: Sequence[Finding]) -> str:
    """Say whether what departs is as the law predicts; empty where nothing departs."""
    if unexplained(findings):
        return UNEXPLAINED
    return AS_PREDICTED if any(finding.as_predicted for finding in findings) else ""


def departures(result: ComparedSweep, variant: Variant) -> Departures | None:
    """Sum up what departs of a variant; ``None`` where nothing does."""
    points = [point.findings for point in result.points_of(variant) if outcome(point.findings)]
    edges = [(edge.finding,) for edge in result.edges if edge.variant == variant and outcome((edge.finding,))]
    if not points and not edges:
        return None
    sizes = [_departure(own) for findings in points for own in findings if own.metric == TRANSMITTANCE]
    return Departures(
        variant=variant,
        points=len(points),
        edges=len(edges),
        unexplained=sum(outcome(findings) == UNEXPLAINED for findings in [*points, *edges]),
        worst=max(sizes, key=lambda own: abs(own.departure), default=Departure(math.nan, math.nan)),
        median=(
            _median(own.departure for own in sizes),
            _median(own.prediction for own in sizes),
            _median(own.left for own in sizes),
        ),
        largest_left=max((abs(own.left) for own in sizes if not math.isnan(own.left)), default=math.nan),
        note=_note(variant),
    )


def _departure(finding: Finding) -> Departure:
    left = math.nan if finding.prediction is None else finding.prediction.difference
    return Departure(finding.comparison.difference, left)


def _median(values: Iterable[float]) -> float:
    known = [abs(value) for value in values if not math.isnan(value)]
    return median(known) if known else math.nan


def _note(variant: Variant) -> str:
    """Say why a variant has no prediction."""
    if variant.law is not None:
        return ""
    stated = variant.preset.stated_law()
    return f"not modelled: {stated.reason}" if isinstance(stated, NotModelled) else "claims the reference's step"
