"""Variants at a few points of a compared sweep beside those of its grid: as installed, or with one option changed.

They have no verdict: they are compared with the truth alone, and decide about nothing.
"""

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any

from engines.interface.presets import Formulation
from engines.interface.registry import engine
from engines.interface.variant import Variant
from reference_lcp.errors import ParameterError
from scenarios.runs.parameters import OperatingPoint
from scenarios.runs.result import ResultStatus
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.point import GivesResults, Point
from scenarios.sweeps.sweep import Case
from scenarios.verdicts.steady_case import CONVERGED

FEW_POINTS = (*(OperatingPoint(0.1, eta) for eta in (0.6, 1.1, 1.4, 1.6)), OperatingPoint(1.0, 0.6))
"""Within the band and on both its flanks with little friction, where engines differ most, and with much friction. They
are few since presets that never settle take seconds a point."""

QUICK_POINTS = (OperatingPoint(0.3, 0.9), OperatingPoint(0.3, 1.6))
"""Likewise, of the grid of a preview."""


def few_points(
    result: ComparedSweep, variants: Sequence[Variant], points: Sequence[OperatingPoint], evaluator: GivesResults
) -> tuple[Point, ...]:
    """Evaluate variants at those of the points that the grid of the sweep holds; without those that have no result."""
    places = [place for point in points if (place := _place(result, point)) is not None]
    known = {point.place: point for point in result.points_of(CONVERGED)}
    beside = [replace(known[CONVERGED, *place], variant=variant) for variant in variants for place in places]
    results = evaluator.evaluate([result.sweep.task(*point.place) for point in beside])
    return tuple(
        replace(point, result=own, others=(), findings=())
        for point, own in zip(beside, results, strict=True)
        if own.status != ResultStatus.MISSING
    )


def _place(result: ComparedSweep, point: OperatingPoint) -> tuple[Case, float] | None:
    """Give case and frequency ratio of a point of the grid, where they are there to round-off."""
    for case in result.cases:
        for eta in result.sweep.frequency_ratios:
            if case.friction_ratio == point.friction_ratio and math.isclose(eta, point.frequency_ratio):
                return case, eta
    return None


def one_option_variants(judged: Collection[Variant], beside: Collection[Variant] = ()) -> tuple[Variant, ...]:
    """Give the variants that show what single options decide.

    Those are presets at other values of the options that they vary (`Preset.varied`), and defaults with one option of
    the tuned preset each: only of engines whose default is judged on the whole grid, for a law predicts it there.
    """
    settling = {variant.engine for variant in judged if variant.preset_name == "default"}
    chosen = []
    for variant in (*judged, *beside):
        if variant.preset_name == "default" and variant.engine in settling:
            chosen += with_single_options(variant)
        values = variant.preset.varied
        chosen += [variant.changed(option, value) for option, own in values.items() for value in own]
    return tuple(dict.fromkeys(chosen))


def with_single_options(default: Variant) -> list[Variant]:
    """Give a default preset with each of the options of the tuned one alone; without those that it cannot set."""
    if "tuned" not in default.capabilities.presets[Formulation(default.formulation)]:
        return []
    variants = []
    for option, value in tuned_options(default.engine, default.formulation).items():
        try:
            variants.append(default.changed(option, value))
        except ParameterError:
            continue
    return variants


def tuned_options(name: str, formulation: str) -> dict[str, Any]:
    """Give the options of the tuned preset of an engine whose values are others than in its default preset."""
    tuned, default = (engine(name).preset(formulation, preset).engine_options for preset in ("tuned", "default"))
    return {
        option: own.value
        for option, own in tuned.items()
        if own.value != (default[option].value if option in default else own.default)
    }
