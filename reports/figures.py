"""Figures of the report, as SVG that stands in the page itself.

Figures are made without pyplot: nothing is left behind, whatever the caller draws besides. Text
becomes outlines, so that it is where it was put on every machine and in print.
"""

import io
import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from engines.contract.tolerances import CONVERGED_TOLERANCE_DB
from engines.variant import Variant
from reports.findings import blocked_reason, differences, reference_line
from reports.numbers import ratio
from scenarios.agreement import EDGE_TOLERANCE
from scenarios.attenuation_band import Edge
from scenarios.figure3 import CONVERGED, REFERENCE, Figure3Result

FREQUENCY_LABEL = r"frequency ratio $\eta_r = \omega/\omega_r$ [-]"
WIDTH = 6.4
"""Width of a figure [inch]: two stand side by side on a wide screen, one fills a telephone's or a printed page's."""

LOWEST_DB = -80.0
"""Lowest transmittance that is drawn: beyond, the motion is less than the ten-thousandth part of the base's."""

STYLE: dict[Any, Any] = {
    "font.size": 11.0,
    "axes.titlesize": 11.5,
    "axes.labelsize": 11.0,
    "legend.fontsize": 10.0,
    "xtick.labelsize": 10.0,
    "ytick.labelsize": 10.0,
    "axes.grid": True,
    "grid.color": "0.88",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.fonttype": "path",
    "svg.hashsalt": "multibody-xval",
}


@dataclass(frozen=True)
class Look:
    """How one variant is drawn: colour, shape and size all differ, so that any one of them is enough."""

    colour: str
    marker: str
    size: float

    def keywords(self) -> dict[str, Any]:
        """Keywords of `Axes.plot`: hollow markers, the earlier ones around the later ones."""
        return {
            "color": self.colour,
            "marker": self.marker,
            "markersize": self.size,
            "markerfacecolor": "none",
            "markeredgewidth": 1.1,
            "linestyle": "none",
        }


# Okabe and Ito's palette, which colour-blind readers can tell apart.
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_SHAPES = ("o", "s", "^", "D", "v", "P", "X", "*")
_SIZES = (8.5, 6.5, 6.0, 4.5, 6.0, 5.0)


def compared_variants(result: Figure3Result) -> list[Variant]:
    """Variants of engines other than the reference, in the order asked."""
    return [variant for variant in result.asked.all_variants if variant.engine != REFERENCE.engine]


def look_of(result: Figure3Result, variant: Variant) -> Look:
    """Give a variant its look, the same in every figure."""
    place = compared_variants(result).index(variant)
    return Look(_COLOURS[place % len(_COLOURS)], _SHAPES[place % len(_SHAPES)], _SIZES[place % len(_SIZES)])


def overview(result: Figure3Result) -> str:
    """Draw the reference's curves of all friction ratios: the paper's Figure 3."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 4.8), layout="constrained")
        axes = figure.subplots()
        axes.axhline(result.asked.band.threshold_db, color="0.4", linewidth=0.8)
        lines = ("-", (0, (6, 2)), "-.", (0, (1, 1.2)), (0, (4, 1, 1, 1, 1, 1)), (0, (9, 2)))
        colours = ("black", *_COLOURS)
        for friction, line, colour in zip(
            result.asked.friction_ratios, itertools.cycle(lines), itertools.cycle(colours), strict=False
        ):
            axes.plot(
                *reference_line(result, friction), linestyle=line, color=colour, linewidth=1.5, label=ratio(friction)
            )
        _transmittance_axis(axes, result, "transmittance [dB]")
        axes.set_xlabel(FREQUENCY_LABEL)
        figure.legend(
            title=r"friction ratio $\mu\tilde{\lambda}_N$ [-]", loc="outside upper center", frameon=False,
            ncols=min(len(result.asked.friction_ratios), 6), handlelength=2.4, columnspacing=1.2,
        )  # fmt: skip
        return _svg(figure, "overview")


def panel(result: Figure3Result, friction_ratio: float) -> str:
    """Draw one friction ratio: every variant over the reference, and below it their differences."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 6.2), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        axes_of = {"transmittance": upper, "difference": lower}
        _draw_edges(list(axes_of.values()), result, friction_ratio)
        upper.axhline(result.asked.band.threshold_db, color="0.4", linewidth=0.8)
        upper.plot(*reference_line(result, friction_ratio), color="black", linewidth=1.3, label=REFERENCE.title)
        _draw_step_error(lower, result, friction_ratio)
        for variant in compared_variants(result):
            _draw_variant(upper, lower, result, variant, friction_ratio)
        _transmittance_axis(upper, result, "transmittance [dB]")
        _difference_axis(lower, result)
        lower.set_xlabel(FREQUENCY_LABEL)
        handles = [one for axes in axes_of.values() for one in axes.get_legend_handles_labels()[0]]
        named = {str(handle.get_label()): handle for handle in handles}
        figure.legend(named.values(), named.keys(), loc="outside upper center", ncols=2, frameon=False)
        return _svg(figure, f"panel-{friction_ratio:g}")


def edge_forest(result: Figure3Result) -> str:
    """Draw the differences of all band edges from the converged reference's, with the tolerance."""
    rows = [(f, edge) for f in result.asked.friction_ratios for edge in Edge if _exists(result, f, edge)]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 1.6 + 0.5 * max(len(rows), 1)), layout="constrained")
        axes = figure.subplots()
        axes.axvspan(-EDGE_TOLERANCE, EDGE_TOLERANCE, color="0.92", label=f"tolerance ±{EDGE_TOLERANCE:g}", zorder=0)
        axes.axvline(0, color="0.4", linewidth=0.8)
        drawn = [REFERENCE, *compared_variants(result)]
        for offset, variant in zip(np.linspace(-0.28, 0.28, len(drawn)), drawn, strict=True):
            _draw_edge_differences(axes, result, variant, rows, float(offset))
        axes.set_yticks(range(len(rows)), [f"friction {ratio(f)}, {edge}" for f, edge in rows])
        axes.set_ylim(max(len(rows), 1) - 0.5, -0.5)
        axes.grid(axis="y", visible=False)
        axes.set_xlabel(r"edge less converged reference's, difference of $\eta_r$ [-]")
        _edge_axis(axes)
        figure.legend(loc="outside upper center", ncols=2, frameon=False)
        return _svg(figure, "edges")


def _exists(result: Figure3Result, friction_ratio: float, edge: Edge) -> bool:
    return result.edge(CONVERGED, friction_ratio, edge).frequency_ratio is not None


def _draw_edge_differences(
    axes: Axes, result: Figure3Result, variant: Variant, rows: list[tuple[float, Edge]], offset: float
) -> None:
    """Mark the differences of one variant, a little above or below the middle of each row."""
    if blocked_reason(result, variant) is not None:
        return
    values = [result.edge(variant, friction, edge).comparison.difference for friction, edge in rows]
    places = np.arange(len(rows)) + offset
    if variant == REFERENCE:
        axes.plot(
            values, places, "|", color="black", markersize=11, markeredgewidth=1.6, label="Reference (step error)"
        )
    else:
        axes.plot(values, places, label=variant.title, **look_of(result, variant).keywords())


def _edge_axis(axes: Axes) -> None:
    """Scale differences of edges so that the tolerance and what is far below it are both seen."""
    limit = max(1.6 * EDGE_TOLERANCE, 1.6 * float(np.max(np.abs(axes.dataLim.intervalx), initial=0.0)))
    axes.set_xscale("symlog", linthresh=1e-4, linscale=0.8)
    ticks = [tick for tick in (1e-4, EDGE_TOLERANCE, 5e-2, 5e-1) if tick <= limit]
    axes.set_xticks([*(-tick for tick in reversed(ticks)), 0, *ticks])
    axes.set_xticks([], minor=True)
    axes.set_xlim(-limit, limit)
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}".replace("-", "−")))


def _draw_variant(upper: Axes, lower: Axes, result: Figure3Result, variant: Variant, friction_ratio: float) -> None:
    """Mark the points of one variant and their differences from the converged reference."""
    points = [point for point in result.curve(variant, friction_ratio) if point.answer.converged]
    if not points:
        return
    look = look_of(result, variant).keywords()
    eta = [point.frequency_ratio for point in points]
    upper.plot(eta, [point.answer.transmittance_db for point in points], label=variant.title, **look)
    lower.plot(*differences(result, variant, friction_ratio), label=variant.title, **look)


def _draw_step_error(axes: Axes, result: Figure3Result, friction_ratio: float) -> None:
    """Shade what the scheme itself errs by at the common time step, and mark the tolerance."""
    eta, error = differences(result, REFERENCE, friction_ratio)
    axes.fill_between(eta, 0, error, color="0.8", linewidth=0)
    axes.plot(eta, error, color="black", linewidth=0.8, marker=".", markersize=3, label="scheme's own step error")
    for sign in (-1, 1):
        axes.axhline(sign * CONVERGED_TOLERANCE_DB, color="0.4", linewidth=0.8, linestyle=(0, (5, 4)))


def _draw_edges(axes: Sequence[Axes], result: Figure3Result, friction_ratio: float) -> None:
    """Mark the edges of the band of the converged reference."""
    for edge in Edge:
        found = result.edge(CONVERGED, friction_ratio, edge).frequency_ratio
        if found is not None:
            for one in axes:
                one.axvline(found, color="0.35", linewidth=0.9, linestyle=(0, (2, 2)))


def _transmittance_axis(axes: Axes, result: Figure3Result, label: str) -> None:
    """Cut the axis off where nothing is to be seen, the same for all panels."""
    every = np.concatenate([reference_line(result, friction)[1] for friction in result.asked.friction_ratios])
    known = np.append(every[np.isfinite(every)], result.asked.band.threshold_db)
    axes.set_ylim(max(LOWEST_DB, float(known.min()) - 5), float(known.max()) + 5)
    axes.set_xlim(result.asked.frequency_ratios[0] - 0.03, result.asked.frequency_ratios[-1] + 0.03)
    axes.set_ylabel(label)


def _difference_axis(axes: Axes, result: Figure3Result) -> None:
    """Scale all panels of differences alike: linear as far as the tolerance, logarithmic where they go beyond."""
    largest = _largest_difference(result)
    limit = max(1.2 * CONVERGED_TOLERANCE_DB, 1.25 * largest)
    if limit > 2 * CONVERGED_TOLERANCE_DB:
        axes.set_yscale("symlog", linthresh=CONVERGED_TOLERANCE_DB, linscale=1.5)
        beyond = [tick for tick in (1, 5, 20, 100) if tick <= limit]
        ticks = [CONVERGED_TOLERANCE_DB, *beyond]
        axes.set_yticks([*(-tick for tick in reversed(ticks)), 0, *ticks])
        axes.set_yticks([], minor=True)
    axes.set_ylim(-limit, limit)
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}".replace("-", "−")))
    axes.axhline(0, color="0.4", linewidth=0.8)
    axes.set_ylabel("difference [dB]")


def _largest_difference(result: Figure3Result) -> float:
    """Largest difference of any variant from the converged reference at any friction ratio [dB]."""
    found = [
        differences(result, variant, friction)[1]
        for variant in (REFERENCE, *compared_variants(result))
        for friction in result.asked.friction_ratios
    ]
    every = np.concatenate(found)
    return float(np.max(np.abs(every[np.isfinite(every)]), initial=0.0))


def _svg(figure: Figure, name: str) -> str:
    """Give a figure as an SVG element for a page: no prologue, no addresses, identifiers of its own."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata=dict.fromkeys(("Creator", "Date", "Format", "Type")))
    svg = text.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r'\sxmlns(:\w+)?="[^"]*"', "", svg)
    svg = re.sub(r'(<svg[^>]*?)\swidth="[^"]*"', r"\1", svg, count=1)
    svg = re.sub(r'(<svg[^>]*?)\sheight="[^"]*"', r"\1", svg, count=1)
    # Several figures stand in one document, and matplotlib gives each the same identifiers.
    svg = re.sub(r'\bid="', f'id="{name}-', svg)
    svg = re.sub(r'xlink:href="#', f'href="#{name}-', svg)
    return svg.replace("url(#", f"url(#{name}-")
