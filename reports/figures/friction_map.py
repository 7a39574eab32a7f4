"""Transmittance over friction and frequency, with the contour of the attenuation band."""

from reference_lcp.validation import FloatArray
from reports.drawing.figure import Axis, Figure, HeatMap, Panel, Series
from reports.drawing.style import DASHED, SOLID, Style
from reports.figures.transmittance import FREQUENCY_LABEL
from scenarios.studies.friction_map import FrictionMap

LOWEST_DB, HIGHEST_DB = -60.0, 20.0
"""Range of the colours: beyond, curves show more."""


def friction_map_figure(data: FrictionMap) -> Figure:
    """Draw the map, with both edges of the band over friction."""
    colours = HeatMap(
        data.frequency_ratios, data.friction_ratios, data.transmittance_db, LOWEST_DB, HIGHEST_DB,
        "transmittance [dB]", "friction %{y}\nη_r %{x}\n%{z} dB",
    )  # fmt: skip
    first, last = data.frequency_ratios[[0, -1]]
    panel = Panel(
        Axis(FREQUENCY_LABEL, (first, last), grid=False),
        Axis("friction ratio μλ̃_N [-]", grid=False),
        [
            colours,
            *_edge(data, "lower edge", data.lower, SOLID),
            *_edge(data, "upper edge", data.upper, DASHED),
        ],
    )
    return Figure(
        "friction-map",
        "Transmittance of the reference over friction and frequency [dB]; lines: lower (solid) and upper (dashed) "
        "edge of the attenuation band",
        [panel],
        height=2.9,
        pixels=430,
        legend_columns=0,
    )


def _edge(data: FrictionMap, name: str, edge: FloatArray, dash: tuple[float, ...]) -> list[Series]:
    """Draw an edge in white on black, to be seen on every colour."""
    friction = data.friction_ratios
    return [
        Series(edge, friction, Style("#000000", size=3.8, width=2.6), draw="lines+markers"),
        Series(edge, friction, Style("#ffffff", size=2.6, dash=dash, width=1.4), name, "lines+markers",
               "friction %{y}\nη_r %{x:.3f}"),
    ]  # fmt: skip
