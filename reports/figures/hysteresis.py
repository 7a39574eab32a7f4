"""Hysteresis loops: friction force over relative displacement of every contact, in one period."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from reports.data.findings import CasePoint, file_name
from reports.figures.figure import Picture, axis, layout, rounded
from reports.figures.style import PAGE_WIDTH, look_of
from reports.formatting import ratio
from scenarios.sweeps.sweep import Sweep
from scenarios.tasks.recorded import RecordedPeriod
from scenarios.verdicts.steady_case import REFERENCE

CORNER = 0.003
"""Points of a loop nearer than this to the straight line between their neighbours are left out on the page.

Over the width and height of the loop: a third of a pixel of a plot of a hundred pixels.
"""

COLUMNS = 4


def hysteresis(sweep: Sweep, place: CasePoint, motions: Mapping[Variant, RecordedPeriod]) -> Picture:
    """Draw the loops of all contacts at one point.

    Parameters
    ----------
    sweep
        Whose variants have their looks.
    place
        Case and frequency ratio.
    motions
        Known motions, the reference's first.
    """
    return Picture(
        f"hysteresis-{file_name(place)}",
        f"Hysteresis loops at {place[0].title}, η_r = {ratio(place[1])}: "
        "friction over its bound, over relative displacement",
        lambda: _printed(sweep, motions),
        {"data": _traces(sweep, motions), "layout": _layout(motions)},
        wide=True,
    )


def _cells(motions: Mapping[Variant, RecordedPeriod]) -> int:
    return max(motion.outer.shape[1] for motion in motions.values())


def _loop(motion: RecordedPeriod, cell: int) -> tuple[FloatArray, FloatArray]:
    """Relative displacement from the middle of the loop, and friction; closed.

    The middle is taken out: stuck offsets are not unique, and a loop may lie anywhere.
    """
    displacement, friction = motion.relative[:, cell], motion.friction[:, cell]
    displacement = displacement - (displacement.max() + displacement.min()) / 2
    return np.append(displacement, displacement[0]), np.append(friction, friction[0])


def _printed(sweep: Sweep, motions: Mapping[Variant, RecordedPeriod]) -> Figure:
    cells = _cells(motions)
    rows = -(-cells // COLUMNS)
    figure = Figure(figsize=(PAGE_WIDTH, 0.6 + 1.55 * rows), layout="constrained")
    panels = figure.subplots(rows, COLUMNS, squeeze=False, sharey=True).ravel()
    for axes in panels[cells:]:
        axes.set_visible(False)
    for cell, axes in enumerate(panels[:cells]):
        for variant, motion in motions.items():
            look = look_of(sweep, variant)
            width = 1.6 if variant == REFERENCE else 0.9
            axes.plot(*_loop(motion, cell), color=look.colour, linestyle=look.line, linewidth=width,
                      label=variant.title)  # fmt: skip
        axes.set_title(f"cell {cell + 1}", pad=3)
        axes.locator_params(axis="x", nbins=4)
    figure.supxlabel("relative displacement / $U_0$ [-]", fontsize=8)
    figure.supylabel("friction / bound [-]", fontsize=8)
    handles, names = panels[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside upper center", ncols=4)
    return figure


def _traces(sweep: Sweep, motions: Mapping[Variant, RecordedPeriod]) -> list[dict[str, Any]]:
    traces = []
    for variant, motion in motions.items():
        look = look_of(sweep, variant)
        for cell in range(motion.outer.shape[1]):
            displacement, friction = _loop(motion, cell)
            kept = corners(displacement, friction)
            number = "" if cell == 0 else str(cell + 1)
            traces.append(
                {
                    "type": "scatter", "mode": "lines", "name": variant.title, "legendgroup": str(variant),
                    "showlegend": cell == 0, "xaxis": f"x{number}", "yaxis": f"y{number}",
                    "x": rounded(displacement[kept], 5), "y": rounded(friction[kept], 4),
                    "line": look.plotly_line,
                    "hovertemplate": f"cell {cell + 1}<br>%{{x:.4f}} U<sub>0</sub><br>%{{y:.3f}} of the bound",
                }
            )  # fmt: skip
    return traces


def _layout(motions: Mapping[Variant, RecordedPeriod]) -> dict[str, Any]:
    cells = _cells(motions)
    rows = -(-cells // COLUMNS)
    grid = {"rows": rows, "columns": COLUMNS, "pattern": "independent", "xgap": 0.28, "ygap": 0.42}
    axes: dict[str, Any] = {}
    for cell in range(cells):
        number = "" if cell == 0 else str(cell + 1)
        axes[f"xaxis{number}"] = axis(f"cell {cell + 1}", nticks=4)
        axes[f"yaxis{number}"] = axis("", range=[-1.15, 1.15], nticks=5)
    return layout(60 + 230 * rows, grid=grid, **axes)


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
    kept = {0, len(x) - 1}
    waiting = [(0, len(x) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        distance = _distance(scaled[first + 1 : last], scaled[first], scaled[last])
        worst = first + 1 + int(np.argmax(distance))
        if distance[worst - first - 1] > tolerance:
            kept.add(worst)
            waiting += [(first, worst), (worst, last)]
    return np.array(sorted(kept))


def _unit(values: FloatArray) -> FloatArray:
    scope = float(np.ptp(values))
    return values / scope if scope > 0 else np.zeros_like(values)


def _distance(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Distance of points from the straight line between two others."""
    along = end - start
    length = float(np.hypot(*along))
    if length == 0:
        return np.hypot(*(points - start).T)
    across = points - start
    return np.abs(along[0] * across[:, 1] - along[1] * across[:, 0]) / length
