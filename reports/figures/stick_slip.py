"""When each contact sticks and slips over one period: every variant beneath the reference, cell by cell."""

import itertools
from dataclasses import dataclass

from engines.interface.variant import Variant
from reference_lcp.observables.stick_slip import Mode
from reports.data.descriptions import file_name
from reports.data.stick_slip import CasePoint
from reports.drawing.figure import Axis, Bars, Figure, Panel
from reports.formatting import ratio
from scenarios.tasks.result import Result

MODE_COLOURS = {Mode.STICK: "#2b2b2b", Mode.FORWARD: "#F0E442", Mode.BACKWARD: "#0072B2"}
"""Dark, light and middle: distinguishable in grey and by colour-blind readers."""

MOST_VECTOR_VARIANTS = 16
"""Variants beyond which the page holds a raster as a picture of pixels."""

NAMED = 8
"""Variants beyond which the strips of the first cell only are named in print."""


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


def phases(result: Result) -> list[Phase]:
    """Give the phases of all contacts that a result's transitions bound; a contact without any sticks throughout.

    A contact without friction has neither transitions nor a stuck fraction above zero, and no phases.
    """
    bounded = []
    for cell, stuck in enumerate(result.stuck_fraction, 1):
        changes = sorted(
            (time / result.period, Mode(kind)) for number, time, kind in result.transitions if number == cell
        )
        if not changes and stuck > 0:
            bounded.append(Phase(cell, 0.0, 1.0, Mode.STICK))
        if changes and changes[0][0] > 0:
            bounded.append(Phase(cell, 0.0, changes[0][0], changes[-1][1]))
        for (start, mode), (end, _) in itertools.pairwise([*changes, (1.0, Mode.STICK)]):
            bounded.append(Phase(cell, start, end - start, mode))
    return bounded


def raster(point: CasePoint, results: dict[Variant, Result]) -> Figure:
    """Draw one point: cells over time, and within each cell a strip for each variant, the first on top.

    Parameters
    ----------
    point
        Case and frequency ratio.
    results
        Certified results, the reference's first.
    """
    rows = {variant: phases(result) for variant, result in results.items()}
    count, cells = len(rows), max(len(result.stuck_fraction) for result in results.values())
    named = range(1, cells + 1 if count <= NAMED else 2)
    panel = Panel(
        Axis("time / period [-]", (0.0, 1.0), decimals=5),
        Axis(range=(cells + 0.5, 0.5), ticks={float(k): f"cell {k}" for k in range(1, cells + 1)}, grid=False),
        [_bars(rows, mode) for mode in MODE_COLOURS],
        names_at_right={_middle(count, strip, k): v.title for k in named for strip, v in enumerate(rows)},
    )
    return Figure(
        f"stick-slip-{file_name(point)}",
        f"Stick and slip at {point[0].title}, η_r = {ratio(point[1])}; in each cell, from top to "
        f"bottom: {'; '.join(variant.title for variant in rows)}",
        [panel],
        height=0.9 + cells * max(0.34, 0.085 * count),
        pixels=100 + round(cells * max(36, 9 * count)),
        legend_columns=3,
        wide=True,
        dense=count > MOST_VECTOR_VARIANTS,
    )


def _height(count: int) -> float:
    """Height of a strip among so many, where a cell takes 1."""
    return 0.86 / count


def _middle(count: int, strip: int, cell: int) -> float:
    """Middle of a strip among so many in a cell, on an axis on which cell k lies about k."""
    return cell + _height(count) * (strip - (count - 1) / 2)


def _bars(rows: dict[Variant, list[Phase]], mode: Mode) -> Bars:
    count = len(rows)
    drawn = [(strip, v, p) for strip, (v, phases) in enumerate(rows.items()) for p in phases if p.mode is mode]
    return Bars(
        start=[phase.start for _, _, phase in drawn],
        length=[phase.length for _, _, phase in drawn],
        middle=[_middle(count, strip, phase.cell) for strip, _, phase in drawn],
        height=0.92 * _height(count),
        colour=MODE_COLOURS[mode],
        name=str(mode),
        notes=[f"cell {p.cell}, {v.title}\n{p.start:.4f} to {p.start + p.length:.4f}" for _, v, p in drawn],
    )
