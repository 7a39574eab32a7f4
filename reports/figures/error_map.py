"""Error to the truth over the cases of a sweep and frequency: a small map a variant, in colours common to all."""

from collections.abc import Sequence

import numpy as np

from reports.data.error_maps import ErrorMap
from reports.drawing.figure import Axis, Figure, HeatMap, Mark, Panel, Series
from reports.drawing.style import Style
from reports.formatting import signed

LOWEST_DB = 1e-3
HIGHEST_DB = 10.0
"""Ends of the colours, the same in every report: what no curve shows, and thrice what is wrong."""

UNSTEADY = Style("#d55e00", "x-thin", 3.0)

COLUMNS = 3
"""Most maps side by side."""

INCHES_A_ROW, PIXELS_A_ROW = 0.13, 17
"""Height of a case in a map, in print and on the page."""


def error_map_figure(maps: Sequence[ErrorMap], rows: str) -> Figure:
    """Draw the maps of all variants; `rows` names what their rows are."""
    columns = min(COLUMNS, len(maps))
    lines = -(-len(maps) // columns)
    cases = len(maps[0].cases)
    return Figure(
        "error-map",
        f"Error of transmittance to the truth over {rows} and frequency: size, in colours that are common to all "
        "variants",
        [_panel(own) for own in maps],
        height=0.6 + lines * (0.65 + INCHES_A_ROW * cases),
        pixels=40 + lines * (95 + PIXELS_A_ROW * cases),
        columns=columns,
        legend_columns=int(any(own.unsteady for own in maps)),
        x_label="frequency ratio η_r [-]",
        y_label=rows,
        wide=True,
        dense=True,
    )


def _panel(own: ErrorMap) -> Panel:
    rows = np.arange(len(own.cases), dtype=float)
    size = np.maximum(np.abs(own.error_db), LOWEST_DB)
    notes = [
        [f"{case.numbers}: {signed(error, 4)} dB" for error in row]
        for case, row in zip(own.cases, own.error_db, strict=True)
    ]
    marks: list[Mark] = [
        HeatMap(
            own.frequency_ratios,
            rows,
            size,
            LOWEST_DB,
            HIGHEST_DB,
            "error to truth [dB]",
            "η_r %{x}\n%{text}",
            "log",
            notes,
        )
    ]
    if own.unsteady:
        places, etas = zip(*own.unsteady, strict=True)
        marks.append(Series(etas, places, UNSTEADY, "no steady state", "markers", "no steady state at η_r %{x}"))
    ticks = {float(row): case.numbers for row, case in zip(rows, own.cases, strict=True)}
    return Panel(
        Axis(range=(own.frequency_ratios[0], own.frequency_ratios[-1]), grid=False),
        Axis(ticks=ticks, grid=False),
        marks,
        own.variant.title,
    )
