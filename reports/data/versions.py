"""Versions of one engine, compared with each other point by point."""

import math
from collections.abc import Mapping
from itertools import combinations
from typing import Any

from engines.interface.registry import engine
from engines.interface.variant import Variant
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.point import Point
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.steady_case import amplification, resolution_db


def version_pairs(result: ComparedSweep, described: Mapping[Variant, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Compare every two versions of an engine in a sweep that have the same formulation and preset.

    They differ at a point where their transmittance does by more than both leave open: residuals of steady states and
    round-off. ``largest_db`` is second less first, ``edge`` of the edges that both have.
    """
    return [
        _pair(result, (one, other), described)
        for one, other in combinations(result.sweep.variants, 2)
        if one.engine != other.engine and _setup(one) == _setup(other)
    ]


def _setup(variant: Variant) -> tuple[str, str, str, str]:
    """Give what two versions of a variant have in common: all but the version."""
    name = variant.engine.partition("@")[0]
    return name, engine(variant.engine).states_laws_of, variant.formulation, variant.preset_name


def _pair(
    result: ComparedSweep, pair: tuple[Variant, Variant], described: Mapping[Variant, Mapping[str, Any]]
) -> dict[str, Any]:
    first, second = ({point.place[1:]: point for point in result.points_of(variant)} for variant in pair)
    sides = [(point, second[place]) for place, point in first.items() if place in second]
    both = [(one, other) for one, other in sides if one.result.converged and other.result.converged]
    worst = max(both, key=lambda points: abs(_difference(*points)), default=None)
    largest = math.nan if worst is None else _difference(*worst)
    names = [f"{v.title} ({described[v]['package']} {described[v]['version'] or 'not installed'})" for v in pair]
    return {
        "first": names[0],
        "second": names[1],
        "points": len(both),
        "one_sided": sum(one.result.converged != other.result.converged for one, other in sides),
        "differing": sum(_differs(*points) for points in both),
        "largest_db": largest,
        "where": f"{worst[0].case}, η_r = {worst[0].frequency_ratio:g}" if worst is not None and largest != 0 else "",
        "stuck_fraction": max((one.result.stuck_difference(other.result) for one, other in both), default=math.nan),
        "edge": _edge_difference(result, pair),
    }


def _difference(one: Point, other: Point) -> float:
    return other.result.transmittance_db - one.result.transmittance_db


def _differs(*points: Point) -> bool:
    """Tell whether transmittances differ by more than is left open; without the reference, whether at all."""
    left_open = sum(
        resolution_db(
            point.variant, point.result, max(point.result.transmittance_db, FLOOR_DB), amplification(point.reference)
        )
        for point in points
    )
    difference = abs(_difference(*points))
    return difference > 0 and not difference <= left_open


def _edge_difference(result: ComparedSweep, pair: tuple[Variant, Variant]) -> float:
    """Give the largest difference of a band edge; NaN where no edge was found for both."""
    first, second = (
        {(edge.case, edge.edge): edge.frequency_ratio for edge in result.edges if edge.variant == variant}
        for variant in pair
    )
    ratios = [(ratio, second.get(place)) for place, ratio in first.items()]
    return max((abs(one - other) for one, other in ratios if one is not None and other is not None), default=math.nan)
