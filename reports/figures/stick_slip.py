"""Stick and slip over one period, and hysteresis loops: friction force over relative displacement of every contact."""

import itertools
from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from engines.interface.variant import Variant
from reference_lcp.observables.stick_slip import Mode
from reference_lcp.validation import FloatArray
from reports.data.descriptions import file_name
from reports.data.stick_slip import CasePoint
from reports.drawing.figure import Axis, Bars, Figure, Panel, Series
from reports.drawing.style import style_of
from reports.formatting import ratio
from scenarios.runs.recorded import RecordedPeriod
from scenarios.runs.result import Result
from scenarios.sweeps.sweep import Sweep
from scenarios.verdicts.steady_case import REFERENCE

MODE_COLOURS = {Mode.STICK: "#2b2b2b", Mode.FORWARD: "#F0E442", Mode.BACKWARD: "#0072B2"}
"""Dark, light and middle: distinguishable in grey and by colour-blind readers."""

MOST_VECTOR_VARIANTS = 16
"""Variants beyond which the page holds a raster as a picture of pixels."""

NAMED = 8
"""Variants beyond which the strips of the first cell only are named in print."""


class Phase(NamedTuple):
    """An uninterrupted mode of one contact."""

    cell: int
    start: float
    length: float
    """Over the period; a phase that passes the end of the period is two."""
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
    """Draw one point: cells over time, and within each cell a strip for each variant, the first on top."""
    count, cells = len(results), max(len(result.stuck_fraction) for result in results.values())
    named = range(1, cells + 1 if count <= NAMED else 2)
    height = 0.86 / count  # of a strip, on an axis on which cell k takes 1 and lies about k
    above = {variant: height * (strip - (count - 1) / 2) for strip, variant in enumerate(results)}
    every = [(variant, phase) for variant, result in results.items() for phase in phases(result)]
    bars = [_bars(mode, [own for own in every if own[1].mode is mode], above, 0.92 * height) for mode in MODE_COLOURS]
    panel = Panel(
        Axis("time / period [-]", (0.0, 1.0), decimals=5),
        Axis(range=(cells + 0.5, 0.5), ticks={float(k): f"cell {k}" for k in range(1, cells + 1)}, grid=False),
        bars,
        names_at_right={k + above[variant]: variant.title for k in named for variant in results},
    )
    return Figure(
        f"stick-slip-{file_name(point)}",
        f"Stick and slip at {point[0].title}, η_r = {ratio(point[1])}; in each cell, from top to "
        f"bottom: {'; '.join(variant.title for variant in results)}",
        [panel],
        height=0.9 + cells * max(0.34, 0.085 * count),
        pixels=100 + round(cells * max(36, 9 * count)),
        legend_columns=3,
        wide=True,
        dense=count > MOST_VECTOR_VARIANTS,
    )


def _bars(mode: Mode, drawn: list[tuple[Variant, Phase]], above: Mapping[Variant, float], height: float) -> Bars:
    return Bars(
        start=[phase.start for _, phase in drawn],
        length=[phase.length for _, phase in drawn],
        middle=[phase.cell + above[variant] for variant, phase in drawn],
        height=height,
        colour=MODE_COLOURS[mode],
        name=str(mode),
        notes=[f"cell {p.cell}, {v.title}\n{p.start:.4f} to {p.start + p.length:.4f}" for v, p in drawn],
    )


CORNER = 0.003
"""Points of a loop nearer than this to the straight line between their neighbours are left out.

Over the width and height of the loop: a third of a pixel of a plot of a hundred pixels.
"""

PANELS_A_ROW = 4


def hysteresis(sweep: Sweep, point: CasePoint, periods: Mapping[Variant, RecordedPeriod]) -> Figure:
    """Draw the loops of all contacts at one point."""
    cells = max(period.outer.shape[1] for period in periods.values())
    rows = -(-cells // PANELS_A_ROW)
    return Figure(
        f"hysteresis-{file_name(point)}",
        f"Hysteresis loops at {point[0].title}, η_r = {ratio(point[1])}: "
        "friction over its bound, over relative displacement",
        [_panel(sweep, periods, cell) for cell in range(cells)],
        height=0.6 + 1.55 * rows,
        pixels=60 + 230 * rows,
        columns=PANELS_A_ROW,
        legend_columns=4,
        x_label="relative displacement / U_0 [-]",
        y_label="friction / bound [-]",
        wide=True,
    )


def _panel(sweep: Sweep, periods: Mapping[Variant, RecordedPeriod], cell: int) -> Panel:
    hover = f"cell {cell + 1}\n%{{x:.4f}} U_0\n%{{y:.3f}} of the bound"
    loops = [
        Series(
            *_loop(period, cell), replace(style_of(sweep, variant), width=1.6 if variant == REFERENCE else 0.9),
            variant.title, hover=hover,
        )
        for variant, period in periods.items() if cell < period.outer.shape[1]
    ]  # fmt: skip
    return Panel(
        Axis(most_ticks=4, decimals=7), Axis(range=(-1.15, 1.15), most_ticks=5), loops, title=f"cell {cell + 1}"
    )


def _loop(period: RecordedPeriod, cell: int) -> tuple[FloatArray, FloatArray]:
    """Relative displacement from the middle of the loop, and friction; closed, and only the points that it needs.

    The middle is taken out: stuck offsets are not unique, and a loop may lie anywhere.
    """
    displacement, friction = period.relative[:, cell], period.friction[:, cell]
    displacement = displacement - (displacement.max() + displacement.min()) / 2
    displacement, friction = np.append(displacement, displacement[0]), np.append(friction, friction[0])
    indices = corners(displacement, friction)
    return displacement[indices], friction[indices]


def corners(x: FloatArray, y: FloatArray, tolerance: float = CORNER) -> NDArray[np.intp]:
    """Give the indices of the points that a curve needs, by Ramer's and by Douglas and Peucker's method."""
    scaled = np.column_stack([_unit(x), _unit(y)])
    indices = {0, len(x) - 1}
    waiting = [(0, len(x) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        distance = _distance(scaled[first + 1 : last], scaled[first], scaled[last])
        worst = first + 1 + int(np.argmax(distance))
        if distance[worst - first - 1] > tolerance:
            indices.add(worst)
            waiting += [(first, worst), (worst, last)]
    return np.array(sorted(indices))


def _unit(values: FloatArray) -> FloatArray:
    extent = float(np.ptp(values))
    return values / extent if extent > 0 else np.zeros_like(values)


def _distance(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Distance of points from the straight line between two others."""
    along = end - start
    length = float(np.hypot(*along))
    if length == 0:
        return np.hypot(*(points - start).T)
    across = points - start
    return np.abs(along[0] * across[:, 1] - along[1] * across[:, 0]) / length
