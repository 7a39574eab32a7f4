"""Versions of one engine, compared with each other point by point."""

import math
from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any

from engines.interface.registry import engine
from engines.interface.variant import Variant
from scenarios.runs.result import Result
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.point import Point
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.steady_case import REFERENCE, amplification, resolution_db


def version_pairs(result: ComparedSweep, described: Mapping[Variant, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Compare every two versions of an engine in a sweep that have the same formulation and preset.

    They differ at a point where their transmittance does by more than both leave open: residuals of steady states and
    round-off. ``largest_db`` is second less first, ``edge`` of the edges that both have.
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
) -> dict[str, Any]:
    sides = list(_sides(result, first, second))
    both = [(one, other) for one, other in sides if one.result.converged and other.result.converged]
    differences = [other.result.transmittance_db - one.result.transmittance_db for one, other in both]
    largest = max(range(len(both)), key=lambda k: abs(differences[k]), default=None)
    return {
        "first": _name(first, described[first]),
        "second": _name(second, described[second]),
        "points": len(both),
        "one_sided": sum(one.result.converged != other.result.converged for one, other in sides),
        "differing": sum(_differs(result, *sides) for sides in both),
        "largest_db": math.nan if largest is None else differences[largest],
        "where": "" if largest is None or differences[largest] == 0 else _place(both[largest][0]),
        "stuck_fraction": max((one.result.stuck_difference(other.result) for one, other in both), default=math.nan),
        "edge": _edge_difference(result, first, second),
    }


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
    """Give what residual and round-off leave open of a difference of transmittance [dB]; NaN without the reference."""
    curve, eta = result.curve(REFERENCE, points[0].case), points[0].frequency_ratio
    reference = next((point.result for point in curve if point.frequency_ratio == eta), Result.missing())
    amplified = amplification(reference)
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
