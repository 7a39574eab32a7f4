"""Transmittance over friction and frequency, with the contour of the attenuation band."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from reference_lcp.validation import FloatArray
from reports.figures.figure import Picture, axis, layout, rounded
from reports.figures.style import COLUMN
from reports.figures.transmittance import FREQUENCY_LABEL, FREQUENCY_TITLE
from scenarios.studies.friction_map import FrictionMap

LOWEST_DB, HIGHEST_DB = -60.0, 20.0
"""Range of the colours: beyond, curves tell more."""

FRICTION_TITLE = "friction ratio μλ̃<sub>N</sub> [-]"

COLOURS = "Cividis"
"""Even in lightness: read alike in colour, by colour-blind readers, and in grey."""


def friction_map_picture(found: FrictionMap) -> Picture:
    """Draw the map, with both edges of the band over friction."""
    return Picture(
        "friction-map",
        "Transmittance of the reference over friction and frequency [dB]; lines: lower (solid) and upper (dashed) "
        "edge of the attenuation band",
        lambda: _printed(found),
        {"data": _traces(found), "layout": _layout()},
    )


def _lines(found: FrictionMap) -> list[tuple[str, FloatArray, str]]:
    return [("lower edge", found.lower, "solid"), ("upper edge", found.upper, "dash")]


def _printed(found: FrictionMap) -> Figure:
    figure = Figure(figsize=(COLUMN, 2.9), layout="constrained")
    axes = figure.subplots()
    axes.grid(visible=False)
    mesh = axes.pcolormesh(
        found.frequency_ratios, found.friction_ratios, found.transmittance_db, cmap=COLOURS.lower(), vmin=LOWEST_DB,
        vmax=HIGHEST_DB, shading="nearest", rasterized=True,
    )  # fmt: skip
    for name, edge, dash in _lines(found):
        line = "-" if dash == "solid" else (0, (4, 2))
        axes.plot(edge, found.friction_ratios, color="black", linewidth=2.6)
        axes.plot(edge, found.friction_ratios, color="white", linewidth=1.4, linestyle=line, marker=".", markersize=3.5,
                  markeredgecolor="black", markeredgewidth=0.3, label=name)  # fmt: skip
    axes.set_xlabel(FREQUENCY_LABEL)
    axes.set_ylabel(r"friction ratio $\mu\tilde{\lambda}_N$ [-]")
    axes.set_xlim(found.frequency_ratios[0], found.frequency_ratios[-1])
    figure.colorbar(mesh, ax=axes, label="transmittance [dB]", extend="both")
    return figure


def _traces(found: FrictionMap) -> list[dict[str, Any]]:
    heat = {
        "type": "heatmap", "name": "transmittance", "x": rounded(found.frequency_ratios),
        "y": rounded(found.friction_ratios), "z": [rounded(row, 2) for row in found.transmittance_db],
        "zmin": LOWEST_DB, "zmax": HIGHEST_DB, "colorscale": COLOURS,
        "colorbar": {"title": {"text": "dB"}, "thickness": 14},
        "hovertemplate": "friction %{y}<br>η<sub>r</sub> %{x}<br>%{z} dB<extra></extra>",
    }  # fmt: skip
    return [heat, *(_edge(found, *line) for line in _lines(found))]


def _edge(found: FrictionMap, name: str, edge: FloatArray, dash: str) -> dict[str, Any]:
    known = np.isfinite(edge)
    return {
        "type": "scatter", "mode": "lines+markers", "name": name, "x": rounded(edge[known]),
        "y": rounded(found.friction_ratios[known]), "line": {"color": "#fff", "width": 2.5, "dash": dash},
        "marker": {"size": 6, "line": {"color": "#000", "width": 1}},
        "hovertemplate": "friction %{y}<br>" + name + " at η<sub>r</sub> %{x:.3f}<extra></extra>",
        "showlegend": False,
    }  # fmt: skip


def _layout() -> dict[str, Any]:
    return layout(430, xaxis=axis(FREQUENCY_TITLE, showgrid=False), yaxis=axis(FRICTION_TITLE, showgrid=False))
