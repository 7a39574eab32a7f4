"""Stick and slip over one period, and hysteresis loops: friction force over relative displacement of every contact."""

import itertools
import math
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.descriptions import file_name
from multibody_xval.reports.data.stick_slip import CasePoint
from multibody_xval.reports.figures.drawing import Drawing, legend, set_ticks, small_multiples
from multibody_xval.reports.figures.style import GREY, PRINT_STYLE, by_panel, preset_style
from multibody_xval.reports.formatting import ratio
from multibody_xval.scenarios.runs.recorded import RecordedPeriod
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from reference_lcp.observables.stick_slip import Mode
from reference_lcp.validation import FloatArray

MODE_COLOURS = {Mode.STICK: "#2b2b2b", Mode.FORWARD: "#F0E442", Mode.BACKWARD: "#0072B2"}
"""Dark, light and middle: distinguishable in grey and by colour-blind readers."""

CELL = 0.15
"""Height of a cell in a raster [inch]."""

MOST_WIDE = 12
"""Panels of a raster beyond which they are narrower."""


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


@mpl.rc_context(PRINT_STYLE)
def raster(point: CasePoint, results: Mapping[Variant, Result]) -> Drawing:
    """Draw one point: a panel a variant with cells over time, in each cell the reference above the variant."""
    cells = max(len(result.stuck_fraction) for result in results.values())
    shown = [variant for variant in results if variant != REFERENCE] or [REFERENCE]
    canvas, panels = small_multiples(
        [variant.title for variant in shown], CELL * cells, columns=4 if len(shown) <= MOST_WIDE else 6,
        x_label="time / period [-]", y_labels=["cell"],
    )  # fmt: skip
    for (axes,), variant in zip(panels, shown, strict=True):
        _strips(axes, phases(results[REFERENCE]), -0.2)
        _strips(axes, phases(results[variant]), 0.2)
        axes.set(xlim=(0.0, 1.0), ylim=(cells + 0.5, 0.5))
        axes.grid(visible=False)
        set_ticks(axes, "x", {0.0: "0", 0.5: "0.5", 1.0: "1"})
        set_ticks(axes, "y", {float(cell): str(cell) for cell in range(1, cells + 1)})
    legend(canvas)
    caption = f"Stick and slip at {point[0].title}, η_r = {ratio(point[1])}; in each cell above: the reference"
    return Drawing(f"stick-slip-{file_name(point)}", caption, canvas)


def _strips(axes: Axes, every: Iterable[Phase], offset: float) -> None:
    """Draw the phases of every mode as one line with gaps, as thick as a strip."""
    by_mode: dict[Mode, list[Phase]] = {mode: [] for mode in MODE_COLOURS}
    for phase in every:
        by_mode[phase.mode].append(phase)
    for mode, own in by_mode.items():
        x = [value for phase in own for value in (phase.start, phase.start + phase.length, math.nan)]
        y = [phase.cell + offset for phase in own for _ in range(3)]
        axes.plot(x, y, color=MODE_COLOURS[mode], linewidth=72 * CELL * 0.36, solid_capstyle="butt", label=str(mode))


CORNER = 0.003
"""Points of a loop nearer than this to the straight line between their neighbours are left out.

Over the width and height of the loop: a third of a pixel of a plot of a hundred pixels.
"""

SLOT = 0.8
"""Largest width of a loop, over the distance of cells."""


@mpl.rc_context(PRINT_STYLE)
def hysteresis(point: CasePoint, periods: Mapping[Variant, RecordedPeriod]) -> Drawing:
    """Draw the loops of all contacts at one point, side by side in a panel an engine and formulation."""
    cells = max(period.outer.shape[1] for period in periods.values())
    widths = np.zeros(cells)
    for period in periods.values():
        own = np.ptp(period.relative, axis=0)
        widths[: own.size] = np.maximum(widths[: own.size], own)
    groups = by_panel(variant for variant in periods if variant != REFERENCE) or {REFERENCE.title: []}
    canvas, panels = small_multiples(
        list(groups), 0.75, columns=2, y_labels=["friction / bound [-]"],
        x_label="cell, and the width of its widest loop: relative displacement / U_0 [-]",
    )  # fmt: skip
    for (axes,), variants in zip(panels, groups.values(), strict=True):
        if REFERENCE in periods:
            _loops(axes, periods[REFERENCE], widths, {**GREY, "linewidth": 2.2})
        for variant in variants:
            _loops(axes, periods[variant], widths, {**preset_style(variant), "marker": "none", "linestyle": "-"})
        axes.set(xlim=(0.4, cells + 0.6), ylim=(-1.15, 1.15))
        names = {float(cell): f"{cell}\n{ratio(float(f'{width:.2g}'))}" for cell, width in enumerate(widths, 1)}
        set_ticks(axes, "x", names)
    legend(canvas)
    caption = (
        f"Hysteresis loops at {point[0].title}, η_r = {ratio(point[1])}: friction over its bound, over relative "
        "displacement; cells side by side, each at a scale of its own"
    )
    return Drawing(f"hysteresis-{file_name(point)}", caption, canvas)


def _loops(axes: Axes, period: RecordedPeriod, widths: FloatArray, style: dict[str, Any]) -> None:
    """Draw the loops of all cells as one line with gaps."""
    x, y = [], []
    for cell in range(period.outer.shape[1]):
        displacement, friction = _loop(period, cell)
        x += [*(cell + 1 + SLOT * displacement / (widths[cell] or 1.0)), math.nan]
        y += [*friction, math.nan]
    axes.plot(x, y, **style)


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
