"""Band edges as a forest: differences of all variants from their baselines, with the reference's error bar."""

import math
from dataclasses import replace

import numpy as np

from engines.interface.variant import Variant
from reports.data.variants import blocked_reason
from reports.drawing.figure import Axis, Figure, Mark, Panel, Rule, Series, difference_axis
from reports.drawing.style import RULE, Style, compared_variants, style_of
from scenarios.sweeps.attenuation_band import Edge
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.sweep import Case
from scenarios.verdicts.steady_case import CONVERGED, REFERENCE

LINEAR = 1e-4
"""Differences of η_r below are drawn to scale, larger ones by their logarithm."""

TICKS = (0.001, 0.01, 0.1)

DECIMALS = 7
"""Of the differences on the page."""

ROW_SPREAD = 0.32
"""Largest distance of a variant from the middle of a row, over the distance of rows."""

EdgeRow = tuple[Case, Edge]


def edge_forest(result: ComparedSweep) -> Figure:
    """Draw the differences of all band edges from those they are compared with, with what is allowed of each."""
    rows = _rows(result)
    count, height = len(compared_variants(result.sweep)), max(len(rows), 1)
    names = {float(k): _label(row) for k, row in enumerate(rows)}
    panel = Panel(
        difference_axis("difference of η_r [-]", LINEAR, TICKS, _limit(result, rows), DECIMALS),
        Axis(range=(height - 0.5, -0.5), ticks=names, grid=False),
        [Rule("x", 0.0, RULE), *_marks(result, rows)],
    )
    return Figure(
        "band-edges",
        "Differences of the band edges from those of what each variant is compared with; bars: what is allowed of "
        "each, black around zero: of the reference",
        [panel],
        height=1.2 + 0.13 * math.ceil(count / 2) + max(0.28, 0.035 * count) * height,
        pixels=90 + max(44, 7 * count) * height,
    )


def reference_error(result: ComparedSweep, row: EdgeRow) -> float:
    """Error bar of the reference's edge in η_r: what is allowed of it; NaN where it was not compared."""
    return result.edge(REFERENCE, *row).comparison.tolerance


def _rows(result: ComparedSweep) -> list[EdgeRow]:
    """Edges that the converged reference has."""
    every = [(case, edge) for case in result.cases for edge in Edge]
    etas = [(row, result.edge(CONVERGED, *row).frequency_ratio) for row in every]
    return [row for row, eta in etas if eta is not None and not math.isnan(eta)]


def _limit(result: ComparedSweep, rows: list[EdgeRow]) -> float:
    compared = [result.edge(variant, *row).comparison for variant in result.sweep.variants for row in rows]
    ends = [abs(comparison.difference) + comparison.tolerance for comparison in compared]
    return 1.6 * max((end for end in ends if not math.isnan(end)), default=TICKS[0])


def _label(row: EdgeRow) -> str:
    return f"{row[0]}, {row[1]}"


def _marks(result: ComparedSweep, rows: list[EdgeRow]) -> list[Mark]:
    """Give the reference's error bars, and every variant a little above or below the middle of each row."""
    errors = [reference_error(result, row) for row in rows]
    notes = [f"{_label(row)}\nerror bar ± {error:.4g}" for row, error in zip(rows, errors, strict=True)]
    bars = Series(
        [0.0] * len(rows), range(len(rows)), Style("#000000", "line-ns", 5.0, width=1.4), "Reference, error bar",
        "markers", "%{text}", notes, x_error=errors,
    )  # fmt: skip
    variants = compared_variants(result.sweep)
    offsets = np.linspace(-ROW_SPREAD, ROW_SPREAD, len(variants)) if len(variants) > 1 else [0.0]
    return [
        bars,
        *(
            _variant(result, variant, rows, float(offset))
            for variant, offset in zip(variants, offsets, strict=False)
            if blocked_reason(result, variant) is None
        ),
    ]


def _variant(result: ComparedSweep, variant: Variant, rows: list[EdgeRow], offset: float) -> Series:
    edges = [result.edge(variant, *row) for row in rows]
    etas = ["–" if edge.frequency_ratio is None else f"{edge.frequency_ratio:.4f}" for edge in edges]
    style = replace(style_of(result.sweep, variant), width=0.6)
    return Series(
        [edge.comparison.difference for edge in edges], np.arange(len(rows)) + offset, style, variant.title,
        "markers", "%{text}\ndifference %{x:.4~g}",
        [f"{_label(row)}: {eta}" for row, eta in zip(rows, etas, strict=True)],
        x_error=[edge.comparison.tolerance for edge in edges],
    )  # fmt: skip
