"""Band edges as a forest: differences of all variants from their baselines, with the reference's error bar."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd

from engines.interface.variant import Variant
from reports.data.points import by_variant, rows_of
from reports.data.report import Report
from reports.drawing.figure import Axis, Figure, Mark, Panel, Rule, Series, difference_axis
from reports.drawing.style import RULE, Style, compared_variants, style_of
from scenarios.verdicts.steady_case import CONVERGED, REFERENCE

LINEAR = 1e-4
"""Differences of η_r below are drawn to scale, larger ones by their logarithm."""

TICKS = (0.001, 0.01, 0.1)

DECIMALS = 7
"""Of the differences on the page."""

ROW_SPREAD = 0.32
"""Largest distance of a variant from the middle of a row, over the distance of rows."""


def edge_forest(report: Report) -> Figure:
    """Draw the differences of all band edges from those they are compared with, with what is allowed of each."""
    edges = _rows(report.edges)
    sweep, names = report.result.sweep, dict(zip(edges["row"], edges["name"], strict=True))
    count, height = len(compared_variants(sweep)), max(len(names), 1)
    limit = 1.6 * max((edges["difference"].abs() + edges["allowed"]).dropna(), default=TICKS[0])
    axis = difference_axis("difference of η_r [-]", LINEAR, TICKS, limit, DECIMALS)
    panel = Panel(
        axis,
        Axis(range=(height - 0.5, -0.5), ticks=names, grid=False),
        [Rule("x", 0.0, RULE), *_marks(report, edges)],
    )
    return Figure(
        "band-edges",
        "Differences of the band edges from those of what each variant is compared with; bars: what is allowed of "
        "each, black around zero: of the reference",
        [panel],
        height=1.2 + 0.13 * math.ceil(count / 2) + max(0.28, 0.035 * count) * height,
        pixels=90 + max(44, 7 * count) * height,
    )


def _rows(edges: pd.DataFrame) -> pd.DataFrame:
    """Give the edges that the converged reference has, with the number and the name of their row."""
    converged = edges[(edges["variant"] == CONVERGED) & edges["frequency_ratio"].notna()]
    rows = {place: float(k) for k, place in enumerate(zip(converged["case"], converged["edge"], strict=True))}
    places = pd.Series(list(zip(edges["case"], edges["edge"], strict=True)), index=edges.index)
    names = [f"{case}, {edge}" for case, edge in places]
    return edges.assign(row=places.map(rows), name=names)[places.isin(list(rows))]


def _marks(report: Report, edges: pd.DataFrame) -> list[Mark]:
    """Give the reference's error bars, and every variant a little above or below the middle of each row."""
    own = by_variant(edges)
    reference = own.get(REFERENCE, edges.iloc[:0])
    bars = Series(
        [0.0] * len(reference), reference["row"], Style("#000000", "line-ns", 5.0, width=1.4), "Reference, error bar",
        "markers", "%{text}", [f"{row.name}\nerror bar ± {row.allowed:.4g}" for row in rows_of(reference)],
        x_error=reference["allowed"],
    )  # fmt: skip
    variants = compared_variants(report.result.sweep)
    offsets = np.linspace(-ROW_SPREAD, ROW_SPREAD, len(variants)) if len(variants) > 1 else [0.0]
    drawn = zip(variants, offsets, strict=False)
    return [
        bars,
        *(
            _variant(report, variant, own.get(variant, edges.iloc[:0]), float(offset))
            for variant, offset in drawn
            if variant not in report.blocked
        ),
    ]


def _variant(report: Report, variant: Variant, edges: pd.DataFrame, offset: float) -> Series:
    return Series(
        edges["difference"], edges["row"] + offset, replace(style_of(report.result.sweep, variant), width=0.6),
        variant.title, "markers", "%{text}\ndifference %{x:.4~g}",
        [f"{row.name}: {'–' if row.absent else format(row.frequency_ratio, '.4f')}" for row in rows_of(edges)],
        x_error=edges["allowed"],
    )  # fmt: skip
