"""Hysteresis loops: friction force over relative displacement of every contact, in one period."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from reports.data.descriptions import file_name
from reports.data.stick_slip import CasePoint
from reports.drawing.figure import Axis, Figure, Panel, Series
from reports.drawing.style import style_of
from reports.formatting import ratio
from scenarios.sweeps.sweep import Sweep
from scenarios.tasks.recorded import RecordedPeriod
from scenarios.verdicts.steady_case import REFERENCE

CORNER = 0.003
"""Points of a loop nearer than this to the straight line between their neighbours are left out.

Over the width and height of the loop: a third of a pixel of a plot of a hundred pixels.
"""

PANELS_A_ROW = 4


def hysteresis(sweep: Sweep, point: CasePoint, periods: Mapping[Variant, RecordedPeriod]) -> Figure:
    """Draw the loops of all contacts at one point.

    Parameters
    ----------
    sweep
        Its variants determine the styles.
    point
        Case and frequency ratio.
    periods
        Known periods, the reference's first.
    """
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
    """Give the indices of the points that a curve needs, by Ramer's and by Douglas and Peucker's method.

    Parameters
    ----------
    x, y
        The curve, shape (points,).
    tolerance
        Largest distance of a point that is left out from the line that is drawn, over the extents of the curve.
    """
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
