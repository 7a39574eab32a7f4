"""Figures of the page: functions of tables, drawn by matplotlib."""

import io
import math

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from multibody_xval.scenarios.judge import FLOOR_DB
from multibody_xval.scenarios.result_tables import is_reference

COLOURS = {"default": "#d55e00", "recommended": "#e69f00", "tuned": "#0072b2"}
TITLES = {"default": "default options", "recommended": "recipe", "tuned": "tuned to the chain"}
MARKERS = {"default": "o", "recommended": "s", "tuned": "."}
MODES = {"stick": "#bbbbbb", "forward slip": "#0072b2", "backward slip": "#d55e00"}
COLUMNS = 2


def svg(figure: Figure, title: str) -> str:
    """Give a figure as an element of a page, with a title that is read aloud."""
    text = io.StringIO()
    figure.savefig(text, format="svg", bbox_inches="tight", metadata={"Date": None, "Title": title})
    start = text.getvalue().partition("<svg")[2]
    return f'<svg role="img" aria-label="{title}"{start}'


def _panels(count: int, height: float) -> tuple[Figure, list[Axes]]:
    rows = max(math.ceil(count / COLUMNS), 1)
    figure = Figure(figsize=(9, height * rows), layout="constrained")
    grid = figure.subplots(rows, COLUMNS, sharex=True, sharey=True, squeeze=False).ravel()
    for axes in grid[count:]:
        axes.set_visible(False)
    return figure, list(grid[:count])


def transmittance(points: pd.DataFrame) -> Figure:
    """Draw a panel an engine: the reference as lines, one a friction ratio, engines as points."""
    coarse = points[points.steps == points.groupby("case", sort=False).steps.transform("min")]
    shown = coarse[coarse.status == "periodic"].sort_values("frequency_ratio")
    shown = shown.assign(level=np.maximum(shown.transmittance_db, FLOOR_DB))
    reference, rest = shown[is_reference(shown)], shown[~is_reference(shown)]
    groups = list(rest.groupby(["engine", "formulation"], sort=False))
    figure, panels = _panels(len(groups), 2.8)
    for axes, (name, own) in zip(panels, groups, strict=True):
        for _, curve in reference.groupby("friction_ratio"):
            axes.plot(curve.frequency_ratio, curve.level, color="0.65", lw=0.9)
        for preset, at in own.groupby("preset", sort=False):
            look = {"color": COLOURS.get(preset, "0.2"), "label": TITLES.get(preset, preset)}
            axes.plot(at.frequency_ratio, at.level, MARKERS.get(preset, "x"), ms=4, mfc="none", **look)
        axes.set(title=", ".join(name), xlabel="frequency ratio", ylabel="transmittance / dB")
        axes.legend(frameon=False, fontsize=8)
    return figure


def errors(worst: pd.DataFrame) -> Figure:
    """Draw the largest error of every engine and formulation: default options, recipe, tuned."""
    groups = list(worst[worst.error_db > 0].groupby(["engine", "formulation"], sort=False))
    figure = Figure(figsize=(7, 0.4 * len(groups) + 1.4), layout="constrained")
    axes = figure.subplots()
    for place, (_, own) in enumerate(groups):
        axes.plot([own.error_db.min(), own.error_db.max()], [place, place], color="0.8", lw=2, zorder=0)
        axes.scatter(own.error_db, [place] * len(own), c=[COLOURS.get(name, "0.2") for name in own.preset], s=30)
    for preset, colour in COLOURS.items():
        axes.scatter([], [], color=colour, label=TITLES[preset])
    axes.set(xscale="log", xlabel="largest error / dB", yticks=range(len(groups)))
    axes.set_yticklabels([", ".join(name) for name, _ in groups])
    axes.xaxis.set_minor_formatter(NullFormatter())
    figure.legend(loc="outside upper center", ncols=3, frameon=False, fontsize=8)
    return figure


def error_map(table: pd.DataFrame) -> Figure:
    """Draw the largest error of judged configurations over frequency and friction ratio."""
    frictions = sorted(table.friction_ratio.unique())
    figure = Figure(figsize=(7, 0.35 * len(frictions) + 1.4), layout="constrained")
    axes = figure.subplots()
    rows = table.friction_ratio.map(frictions.index)
    sizes = table.error_db.clip(lower=1e-3)
    dots = axes.scatter(table.frequency_ratio, rows, c=sizes, norm=LogNorm(1e-3, 10), marker="s")
    axes.set(xlabel="frequency ratio", ylabel="friction ratio", ylim=(-0.5, len(frictions) - 0.5))
    axes.set_yticks(range(len(frictions)), [f"{own:g}" for own in frictions])
    figure.colorbar(dots, ax=axes, label="largest error / dB")
    return figure


def stick_slip(changes: pd.DataFrame) -> Figure:
    """Draw when each contact sticks and slips over a period, a panel a configuration."""
    groups = list(changes.groupby(["engine", "formulation", "preset"], sort=False))
    figure, panels = _panels(len(groups), 2.2)
    for axes, (name, own) in zip(panels, groups, strict=True):
        for cell, at in own.groupby("cell"):
            for begin, length, mode in phases(at.time.tolist(), at["mode"].tolist()):
                axes.barh(cell, length, left=begin, color=MODES[mode], height=0.7)
        axes.set(title=", ".join(name), xlim=(0, 1), xlabel="time / period", ylabel="cell")
    for mode, colour in MODES.items():
        panels[0].barh(1, 0, color=colour, label=mode)
    figure.legend(loc="outside upper center", ncols=3, frameon=False, fontsize=8)
    return figure


def phases(times: list[float], modes: list[str]) -> list[tuple[float, float, str]]:
    """Give begin, length and mode of the phases of one contact; the last goes on from the period's begin."""
    begins, ends = [0.0, *times], [*times, 1.0]
    names = [modes[-1], *modes]
    return [(begin, end - begin, mode) for begin, end, mode in zip(begins, ends, names, strict=True)]
