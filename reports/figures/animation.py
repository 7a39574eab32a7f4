"""The chain in motion over one period: outer masses as frames, inner masses coloured by stick and slip."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.animation import FuncAnimation, HTMLWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from reference_lcp.observables.stick_slip import MODE_OF_SIGN
from reference_lcp.validation import FloatArray
from reports.figures.stick_slip import MODE_COLOURS
from reports.formatting import ratio
from scenarios.runs.recorded import RecordedPeriod
from scenarios.runs.task import SteadyStateTask

SPACING = 2.0
"""Distance of neighbouring cells in the drawing, over the width of an outer mass."""

REACH = 0.55
"""Largest displacement in the drawing, on the same scale: neighbours never meet."""

INNER_REACH = 0.27
"""Largest displacement of an inner mass in its outer one, on the same scale: it stays inside."""

HATCHES = {0: "", 1: "///", -1: "\\\\\\"}
"""Of the inner mass by mode: distinguishable without colour too."""


def write_animation(task: SteadyStateTask, period: RecordedPeriod, frames: int, file: Path) -> None:
    """Draw a recorded period of the task's chain into `file`, in the format of its ending."""
    drawing = ChainDrawing(task, period, frames)
    animation = FuncAnimation(drawing.figure, drawing.draw, frames=frames, interval=50, blit=False)
    if file.suffix == ".gif":
        animation.save(file, writer=PillowWriter(fps=20), dpi=100)
        return
    # the writer of matplotlib warns and leaves frames out where they take more than this
    with mpl.rc_context({"animation.embed_limit": 200.0}):
        animation.save(file, writer=HTMLWriter(fps=20, embed_frames=True, default_mode="loop"), dpi=100)


class ChainDrawing:
    """The chain as a row of boxes in boxes, with a clock of the period below it."""

    def __init__(self, task: SteadyStateTask, period: RecordedPeriod, frames: int):
        self._period = period
        self._rows = np.round(np.linspace(0, period.outer.shape[0], frames, endpoint=False)).astype(int)
        largest = max(1.0, float(np.max(np.abs(period.outer))), float(np.max(np.abs(period.inner))))
        self._scale = min(REACH / largest, INNER_REACH / max(float(np.max(np.abs(period.relative))), INNER_REACH))
        cells = period.outer.shape[1]
        self.figure = Figure(figsize=(9, 3), layout="constrained")
        self._axes: Axes = self.figure.subplots()
        self._centres: FloatArray = SPACING * np.arange(1, cells + 1)
        self._outer = [self._box(1.0, 1.0, {"facecolor": "#f4f5f7", "edgecolor": "#1b1f24"}) for _ in range(cells)]
        self._inner = [self._box(0.42, 0.5, {"edgecolor": "#1b1f24", "linewidth": 0.8}) for _ in range(cells)]
        self._springs = [self._axes.plot([], [], color="#57606a", linewidth=1.2)[0] for _ in range(cells)]
        self._base = self._box(0.3, 1.4, {"facecolor": "#57606a"})
        self._clock = Rectangle((0, -1.05), 0, 0.08, facecolor="#0b5393")
        self._axes.add_patch(self._clock)
        self._length = SPACING * cells
        self._frame_axes(task)

    def draw(self, frame: int) -> list[Any]:
        """Move everything to one instant; gives what has moved."""
        row = int(self._rows[frame])
        phase = float(self._period.phase[row])
        outer = self._centres + self._scale * self._period.outer[row]
        inner = self._centres + self._scale * self._period.inner[row]
        base = self._scale * float(np.sin(2 * np.pi * phase))
        self._base.set_x(base - 0.15)
        ends = [base + 0.15, *(outer[:-1] + 0.5)]
        for cell, (box, mass, spring) in enumerate(zip(self._outer, self._inner, self._springs, strict=True)):
            box.set_x(outer[cell] - 0.5)
            mass.set_x(inner[cell] - 0.21)
            mode = int(self._period.modes[row, cell])
            mass.set_facecolor(MODE_COLOURS[MODE_OF_SIGN[mode]])
            mass.set_hatch(HATCHES[mode])
            spring.set_data(*_zigzag(ends[cell], float(outer[cell]) - 0.5))
        self._clock.set_width(self._length * phase)
        return [self._base, self._clock, *self._outer, *self._inner, *self._springs]

    def _box(self, width: float, height: float, style: dict[str, Any]) -> Rectangle:
        box = Rectangle((0, -height / 2), width, height, **style)
        self._axes.add_patch(box)
        return box

    def _frame_axes(self, task: SteadyStateTask) -> None:
        """Set limits, title and legend."""
        self._axes.set(xlim=(-1, self._length + 1.4), ylim=(-1.2, 1.1), aspect="equal")
        self._axes.set_axis_off()
        chain = f"friction ratio {ratio(task.friction_ratio)}, " if isinstance(task.friction_ratio, float) else ""
        self._axes.set_title(
            f"{task.variant.title}: {chain}frequency ratio {ratio(task.frequency_ratio)}; "
            f"U0 is drawn as {self._scale:.2g} of a mass's width", fontsize=10,
        )  # fmt: skip
        handles = [
            Patch(facecolor=MODE_COLOURS[mode], hatch=HATCHES[sign], edgecolor="#1b1f24", label=str(mode))
            for sign, mode in MODE_OF_SIGN.items()
        ]
        self.figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)


def _zigzag(left: float, right: float) -> tuple[FloatArray, FloatArray]:
    """Give the line of a spring between two ends."""
    along = np.linspace(left, right, 12)
    across = np.zeros(12)
    across[2:-2] = 0.14 * (-1.0) ** np.arange(8)
    return along, across
