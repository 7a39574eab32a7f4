"""Band edges as a forest: differences of all variants from their baselines, with the reference's error bar."""

from typing import Any

import matplotlib as mpl
import pandas as pd
from matplotlib.axes import Axes

from multibody_xval.reports.data.points import by_variant
from multibody_xval.reports.data.report import Report
from multibody_xval.reports.figures.drawing import Drawing, legend, set_difference_axis, set_ticks, small_multiples
from multibody_xval.reports.figures.style import GREY, PRINT_STYLE, RULE, by_panel, compared_variants, preset_style
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE

LINEAR = 1e-4
"""Differences of η_r below are drawn to scale, larger ones by their logarithm."""

TICKS = (0.001, 0.1)

ROW, LETTER = 0.17, 0.055
"""Height of an edge, and width of a letter of its name [inch]."""


@mpl.rc_context(PRINT_STYLE)
def edge_forest(report: Report) -> Drawing:
    """Draw the differences of all band edges from those they are compared with, with what is allowed of each."""
    edges = _rows(report.edges)
    own, names = by_variant(edges), dict(zip(edges["row"], edges["name"], strict=True))
    sizes = edges["difference"].abs() + edges["allowed"].fillna(0.0)
    limit = 1.6 * max(sizes.dropna(), default=TICKS[0])
    variants = [variant for variant in compared_variants(report.result.sweep) if variant not in report.blocked]
    groups = by_panel(variants) or {REFERENCE.title: []}
    count = max(len(names), 1)
    canvas, panels = small_multiples(
        list(groups), ROW * count, columns=3, left=0.2 + LETTER * max(map(len, names.values()), default=0),
        x_label="difference of η_r from the edge compared with [-]",
    )  # fmt: skip
    reference = own.get(REFERENCE, edges.iloc[:0])
    for (axes,), shown in zip(panels, groups.values(), strict=True):
        axes.axvline(0.0, **RULE)
        axes.barh(reference["row"], 2 * reference["allowed"], 0.8, -reference["allowed"], **_bars())
        for place, variant in enumerate(shown, 1):
            _edges(axes, own.get(variant, edges.iloc[:0]), place / (len(shown) + 1) - 0.5, preset_style(variant))
        set_difference_axis(axes, "x", LINEAR, TICKS, limit)
        set_ticks(axes, "y", names)
        axes.set_ylim(count - 0.5, -0.5)
        axes.grid(axis="y", visible=False)
    legend(canvas)
    caption = (
        "Differences of the band edges from those of what each variant is compared with; bars: what is allowed of "
        "each; grey: the reference’s error bar"
    )
    return Drawing("band-edges", caption, canvas)


def _bars() -> dict[str, Any]:
    return {"color": GREY["color"], "linewidth": 0.0, "label": "Reference, error bar"}


def _edges(axes: Axes, edges: pd.DataFrame, offset: float, style: dict[str, Any]) -> None:
    """Mark the edges of a variant, a little above or below the middle of each row."""
    axes.errorbar(
        edges["difference"], edges["row"] + offset, xerr=edges["allowed"], elinewidth=0.6, capsize=1.5,
        **{**style, "linestyle": "none"},
    )  # fmt: skip


def _rows(edges: pd.DataFrame) -> pd.DataFrame:
    """Give the edges that the converged reference has, with the number and the name of their row."""
    converged = edges[(edges["variant"] == CONVERGED) & edges["frequency_ratio"].notna()]
    rows = {place: float(k) for k, place in enumerate(zip(converged["case"], converged["edge"], strict=True))}
    places = pd.Series(list(zip(edges["case"], edges["edge"], strict=True)), index=edges.index)
    names = [f"{case}, {edge}" for case, edge in places]
    return edges.assign(row=places.map(rows), name=names)[places.isin(list(rows))]
