"""The drawings of the target sheets.

python docs/targets/drawings.py docs/_static
"""

import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

LINE = {"color": "0.15", "linewidth": 1.2}
BOX = 1.0
"""Edge of a body; all lengths are in this unit."""


def body(axes: Axes, x: float, text: str, y: float = 0.0, width: float = BOX) -> None:
    """Draw a body with its name, its lower left corner at (x, y)."""
    axes.add_patch(Rectangle((x, y), width, BOX, facecolor="0.93", edgecolor="0.15", linewidth=1.2))
    axes.text(x + width / 2, y + BOX / 2, text, ha="center", va="center")


def ground(axes: Axes, left: float, right: float, y: float = 0.0) -> None:
    """Draw the ground from left to right, hatched below."""
    axes.plot([left, right], [y, y], **LINE)
    for x in np.arange(left, right - 0.05, 0.25):
        axes.plot([x, x + 0.2], [y - 0.2, y], color="0.5", linewidth=0.7)


def wall(axes: Axes, x: float) -> None:
    """Draw a wall on the left of x."""
    axes.plot([x, x], [0.0, 1.2], **LINE)
    for y in np.arange(0.05, 1.2, 0.2):
        axes.plot([x - 0.2, x], [y - 0.1, y + 0.1], color="0.5", linewidth=0.7)


def spring(axes: Axes, left: float, right: float, text: str) -> None:
    """Draw a spring at half the height of a body."""
    turns = np.linspace(left + 0.15, right - 0.15, 12)
    heights = 0.5 + 0.15 * np.array([0, *[(-1) ** k for k in range(10)], 0])
    axes.plot([left, *turns, right], [0.5, *heights, 0.5], **LINE)
    axes.text((left + right) / 2, 0.8, text, ha="center")


def arrow(axes: Axes, start: tuple[float, float], way: tuple[float, float], text: str) -> None:
    """Draw an arrow; the text is above one that points along the row, and beside one that points down."""
    tip = (start[0] + way[0], start[1] + way[1])
    axes.annotate("", tip, start, arrowprops={"arrowstyle": "-|>", "color": "C0", "linewidth": 1.4})
    middle = (start[0] + way[0] / 2, start[1] + way[1] / 2)
    place, align = ((middle[0], middle[1] + 0.2), "center") if way[0] else ((middle[0] + 0.15, middle[1]), "left")
    axes.text(*place, text, color="C0", ha=align)
    axes.plot(*zip(start, tip, (tip[0], tip[1] + 0.4), strict=True), alpha=0)  # what the limits take in


def block_on_spring(axes: Axes, start: str) -> None:
    """SDND100 and FrictionOscillator: one mass, a spring, the ground."""
    ground(axes, -2.2, 3.4)
    wall(axes, -2.2)
    spring(axes, -2.2, 0.0, "$k$")
    body(axes, 0.0, "$m$")
    arrow(axes, (0.5, 2.0), (0.0, -0.9), "$N$")
    arrow(axes, (1.1, 0.5), (1.0, 0.0), start)
    axes.text(0.5, -0.5, "$\\mu$", ha="center")


def sdnd100(axes: Axes) -> None:
    """The spring is along the axis of motion."""
    block_on_spring(axes, "$r$")


def friction_oscillator(axes: Axes) -> None:
    """The same, with a velocity at first."""
    block_on_spring(axes, "$x,\\ v$")


def sdnd104(axes: Axes) -> None:
    """A table that is shaken."""
    ground(axes, -1.5, 3.5, -0.55)
    axes.add_patch(Rectangle((-1.0, -0.35), 4.0, 0.35, facecolor="0.8", edgecolor="0.15", linewidth=1.2))
    body(axes, 0.5, "$m$")
    arrow(axes, (1.0, 2.0), (0.0, -0.9), "$N$")
    arrow(axes, (2.2, 0.25), (1.0, 0.0), "$A\\,\\sin 2\\pi t$")


def sdnd106(axes: Axes) -> None:
    """Two masses with a spring between them."""
    ground(axes, -0.4, 1.4)
    body(axes, 0.0, "$m_1$")
    spring(axes, 1.0, 3.0, "$k$")
    body(axes, 3.0, "$m_2$")
    arrow(axes, (0.5, 2.0), (0.0, -0.9), "$N$")
    arrow(axes, (4.05, 0.5), (1.0, 0.0), "$F(t)$")
    axes.text(0.5, -0.5, "$\\mu_s,\\ \\mu_k$", ha="center")


def brake(axes: Axes) -> None:
    """A free mass, and a force that presses a shoe on it from 0.1 s on."""
    body(axes, 0.0, "$m$")
    axes.add_patch(Rectangle((0.1, 1.05), 0.8, 0.2, facecolor="0.6", edgecolor="0.15"))
    arrow(axes, (0.5, 2.1), (0.0, -0.8), "$N(t)$")
    arrow(axes, (1.1, 0.5), (1.0, 0.0), "$v_0$")


def coupled_clutches(axes: Axes) -> None:
    """Four inertias on one axis, a clutch between each and the next."""
    axes.plot([-0.6, 6.9], [0.5, 0.5], color="0.5", linewidth=0.8, linestyle="-.")
    for k in range(4):
        body(axes, 1.8 * k, f"$J_{k + 1}$")
    for k in range(3):
        for x in (1.8 * k + 1.3, 1.8 * k + 1.5):
            axes.plot([x, x], [0.1, 0.9], **LINE)
        for x in (1.8 * k + 1.0, 1.8 * k + 1.5):
            axes.plot([x, x + 0.3], [0.5, 0.5], **LINE)
        axes.text(1.8 * k + 1.4, -0.15, f"$N_{k + 1}(t)$", ha="center", va="top", color="C0")
    arrow(axes, (-1.1, 0.5), (1.0, 0.0), "$\\tau(t)$")


DRAWINGS: tuple[Callable[[Axes], None], ...] = (sdnd100, sdnd104, sdnd106, brake, friction_oscillator, coupled_clutches)


def draw(folder: Path) -> None:
    """Write every drawing as an SVG file."""
    for drawing in DRAWINGS:
        figure, axes = plt.subplots(figsize=(4.2, 1.9), layout="constrained")
        drawing(axes)
        axes.set_aspect("equal")
        axes.autoscale_view()
        axes.margins(0.05)
        axes.axis("off")
        with plt.rc_context({"svg.hashsalt": drawing.__name__}):
            figure.savefig(folder / f"target_{drawing.__name__}.svg", metadata={"Date": None})
        plt.close(figure)


if __name__ == "__main__":
    draw(Path(sys.argv[1]))
