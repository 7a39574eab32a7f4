"""Versions of one engine, compared with each other point by point."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from engines.interface.registry import engine
from engines.interface.variant import Variant
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.table import Point
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.steady_case import REFERENCE, amplification, resolution_db


@dataclass(frozen=True)
class VersionPair:
    """Two versions of an engine, with the same formulation and preset.

    Parameters
    ----------
    first, second
        Names with versions.
    points
        Points at which both have a certified steady state.
    one_sided
        Points at which one of them has none.
    differing
        Points at which transmittance differs by more than both leave open: residuals of steady states, round-off.
    largest_db
        Largest difference of transmittance, second less first, signed [dB].
    where
        The point of it; empty without a difference.
    stuck_fraction
        Largest difference of the part of the period for which a cell sticks.
    edge
        Largest difference of a band edge, in η_r; NaN where no edge was found for both.
    """

    first: str
    second: str
    points: int
    one_sided: int
    differing: int
    largest_db: float
    where: str
    stuck_fraction: float
    edge: float


def version_pairs(result: ComparedSweep, described: Mapping[Variant, Mapping[str, Any]]) -> list[VersionPair]:
    """Compare every two versions of an engine in a sweep.

    Parameters
    ----------
    result
        The sweep.
    described
        Package and version by variant.
    """
    return [
        _pair(result, one, other, described)
        for one, other in combinations(result.sweep.variants, 2)
        if one.engine != other.engine and _setup(one) == _setup(other)
    ]


def _setup(variant: Variant) -> tuple[str, str, str, str]:
    """Give what two versions of a variant have in common: all but the version."""
    name = variant.engine.partition("@")[0]
    return name, engine(variant.engine).states_laws_of, variant.formulation, variant.preset_name


def _pair(
    result: ComparedSweep, first: Variant, second: Variant, described: Mapping[Variant, Mapping[str, Any]]
) -> VersionPair:
    sides = list(_sides(result, first, second))
    both = [(one, other) for one, other in sides if one.result.converged and other.result.converged]
    differences = [other.result.transmittance_db - one.result.transmittance_db for one, other in both]
    largest = max(range(len(both)), key=lambda k: abs(differences[k]), default=None)
    return VersionPair(
        first=_name(first, described[first]),
        second=_name(second, described[second]),
        points=len(both),
        one_sided=sum(one.result.converged != other.result.converged for one, other in sides),
        differing=sum(_differs(result, *sides) for sides in both),
        largest_db=math.nan if largest is None else differences[largest],
        where="" if largest is None or differences[largest] == 0 else _place(both[largest][0]),
        stuck_fraction=max((_stuck_difference(one, other) for one, other in both), default=math.nan),
        edge=_edge_difference(result, first, second),
    )


def _sides(result: ComparedSweep, first: Variant, second: Variant) -> Iterator[tuple[Point, Point]]:
    """Give both versions at every point that both have."""
    seconds = {(point.case, point.frequency_ratio): point for point in result.points_of(second)}
    for point in result.points_of(first):
        other = seconds.get((point.case, point.frequency_ratio))
        if other is not None:
            yield point, other


def _differs(result: ComparedSweep, one: Point, other: Point) -> bool:
    """Tell whether transmittances differ by more than is left open; where that is not known, whether at all."""
    difference = abs(other.result.transmittance_db - one.result.transmittance_db)
    return difference > 0 and not difference <= _left_open(result, one, other)


def _left_open(result: ComparedSweep, *points: Point) -> float:
    """Give what residual and round-off leave open of a difference of transmittance [dB]."""
    own = points[0]
    reference = next(
        point for point in result.curve(REFERENCE, own.case) if point.frequency_ratio == own.frequency_ratio
    )
    amplified = amplification(reference.result)
    return sum(
        resolution_db(point.variant, point.result, max(point.result.transmittance_db, FLOOR_DB), amplified)
        for point in points
    )


def _name(variant: Variant, described: Mapping[str, Any]) -> str:
    return f"{variant.title} ({described['package']} {described['version'] or 'not installed'})"


def _edge_difference(result: ComparedSweep, first: Variant, second: Variant) -> float:
    """Give the largest difference of a band edge; NaN where no edge was found for both."""
    edges = {(edge.variant, edge.case, edge.edge): edge.frequency_ratio for edge in result.edges}
    pairs = [
        (ratio, edges.get((second, case, edge))) for (variant, case, edge), ratio in edges.items() if variant == first
    ]
    return max((abs(one - other) for one, other in pairs if one is not None and other is not None), default=math.nan)


def _place(point: Point) -> str:
    return f"{point.case}, η_r = {point.frequency_ratio:g}"


def _stuck_difference(one: Point, other: Point) -> float:
    pairs = zip(one.result.stuck_fraction, other.result.stuck_fraction, strict=True)
    return max((abs(first - second) for first, second in pairs), default=0.0)
