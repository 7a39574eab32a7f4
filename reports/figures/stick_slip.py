"""When each contact sticks and slips over one period: every variant beneath the reference, cell by cell."""

import itertools
from dataclasses import dataclass
from typing import Any

from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from engines.interface.variant import Variant
from reference_lcp.observables.stick_slip import Mode
from reports.data.findings import CasePoint, file_name
from reports.figures.figure import Picture, axis, layout
from reports.figures.style import PAGE_WIDTH
from reports.formatting import ratio
from scenarios.tasks.result import Result

MODE_COLOURS = {Mode.STICK: "#2b2b2b", Mode.FORWARD: "#F0E442", Mode.BACKWARD: "#0072B2"}
"""Dark, light and middle: told apart in grey and by colour-blind readers."""


CROWD = 16
"""Variants beyond which the page holds a raster as a picture of pixels."""


@dataclass(frozen=True)
class Phase:
    """An uninterrupted mode of one contact.

    Parameters
    ----------
    cell
        Number of the cell, from 1.
    start, length
        Over the period; a phase that passes the end of the period is two.
    mode
        Stick, forward or backward slip.
    """

    cell: int
    start: float
    length: float
    mode: Mode


def phases(answer: Result) -> list[Phase]:
    """Give the phases of all contacts that an answer's transitions bound; a contact without any sticks throughout.

    A contact without friction has neither transitions nor a stuck fraction above zero, and no phases.
    """
    found = []
    for cell, stuck in enumerate(answer.stuck_fraction, 1):
        changes = sorted(
            (time / answer.period, Mode(kind)) for number, time, kind in answer.transitions if number == cell
        )
        if not changes and stuck > 0:
            found.append(Phase(cell, 0.0, 1.0, Mode.STICK))
        if changes and changes[0][0] > 0:
            found.append(Phase(cell, 0.0, changes[0][0], changes[-1][1]))
        for (start, mode), (end, _) in itertools.pairwise([*changes, (1.0, Mode.STICK)]):
            found.append(Phase(cell, start, end - start, mode))
    return found


def raster(place: CasePoint, answers: dict[Variant, Result]) -> Picture:
    """Draw one point: cells over time, and within each cell a strip for each variant, the first on top.

    Parameters
    ----------
    place
        Case and frequency ratio.
    answers
        Certified answers, the reference's first.
    """
    rows = {variant: phases(answer) for variant, answer in answers.items()}
    cells = max(len(answer.stuck_fraction) for answer in answers.values())
    return Picture(
        f"stick-slip-{file_name(place)}",
        f"Stick and slip at {place[0].title}, η_r = {ratio(place[1])}; in each cell, from top to "
        f"bottom: {'; '.join(variant.title for variant in rows)}",
        lambda: _printed(rows, cells),
        {"data": _traces(rows), "layout": _layout(rows, cells)},
        wide=True,
        dense=len(rows) > CROWD,
    )


def _height(rows: dict[Variant, list[Phase]]) -> float:
    """Height of a strip, where a cell takes 1."""
    return 0.86 / len(rows)


def _middle(rows: dict[Variant, list[Phase]], strip: int, cell: int) -> float:
    """Middle of the strip of a variant in a cell, on an axis on which cell k lies about k."""
    return cell + _height(rows) * (strip - (len(rows) - 1) / 2)


def _printed(rows: dict[Variant, list[Phase]], cells: int) -> Figure:
    figure = Figure(figsize=(PAGE_WIDTH, 0.9 + cells * max(0.34, 0.085 * len(rows))), layout="constrained")
    axes = figure.subplots()
    for mode, colour in MODE_COLOURS.items():
        bars = [
            _corners(phase, _middle(rows, strip, phase.cell), 0.46 * _height(rows))
            for strip, found in enumerate(rows.values())
            for phase in found
            if phase.mode is mode
        ]
        axes.add_collection(PolyCollection(bars, facecolors=colour, linewidths=0))
    axes.set_yticks(range(1, cells + 1), [f"cell {cell}" for cell in range(1, cells + 1)])
    axes.set_ylim(cells + 0.5, 0.5)
    axes.set_xlim(0, 1)
    axes.set_xlabel("time / period [-]")
    axes.grid(axis="y", visible=False)
    _name_strips(figure, rows, cells)
    handles = [Patch(facecolor=colour, label=str(mode)) for mode, colour in MODE_COLOURS.items()]
    figure.legend(handles=handles, loc="outside upper center", ncols=3)
    return figure


def _corners(phase: Phase, middle: float, half: float) -> list[tuple[float, float]]:
    """Give the corners of the bar of a phase."""
    left, right = phase.start, phase.start + phase.length
    return [(left, middle - half), (left, middle + half), (right, middle + half), (right, middle - half)]


def _name_strips(figure: Figure, rows: dict[Variant, list[Phase]], cells: int) -> None:
    """Name the strips of every cell at the right where there is room for it, else those of the first cell only."""
    (axes,) = figure.axes
    right = axes.twinx()
    right.set_ylim(axes.get_ylim())
    named = range(1, cells + 1) if len(rows) <= 8 else range(1, 2)
    labels = {_middle(rows, strip, cell): v.title for cell in named for strip, v in enumerate(rows)}
    right.set_yticks(list(labels), list(labels.values()), fontsize=4.6)
    right.tick_params(length=0, pad=2)
    right.grid(visible=False)
    right.spines[:].set_visible(False)


def _traces(rows: dict[Variant, list[Phase]]) -> list[dict[str, Any]]:
    """Give the phases of each mode as horizontal bars."""
    traces = []
    for mode, colour in MODE_COLOURS.items():
        bars = [(strip, v, p) for strip, (v, found) in enumerate(rows.items()) for p in found if p.mode is mode]
        traces.append(
            {
                "type": "bar", "orientation": "h", "name": str(mode),
                "y": [round(_middle(rows, strip, phase.cell), 4) for strip, _, phase in bars],
                "base": [round(phase.start, 5) for _, _, phase in bars],
                "x": [round(phase.length, 5) for _, _, phase in bars],
                "width": round(0.92 * _height(rows), 4),
                "marker": {"color": colour, "line": {"width": 0}},
                "text": [f"cell {p.cell}, {v.title}<br>{p.start:.4f} to {p.start + p.length:.4f}" for _, v, p in bars],
                "textposition": "none",
                "hovertemplate": "%{text}",
            }
        )  # fmt: skip
    return traces


def _layout(rows: dict[Variant, list[Phase]], cells: int) -> dict[str, Any]:
    names = {"tickvals": list(range(1, cells + 1)), "ticktext": [f"cell {cell}" for cell in range(1, cells + 1)]}
    return layout(
        100 + round(cells * max(36, 9 * len(rows))),
        barmode="overlay",
        xaxis=axis("time / period [-]", range=[0, 1]),
        yaxis={"range": [cells + 0.5, 0.5], "showgrid": False, "zeroline": False, "automargin": True, **names},
    )
