"""Figures of the page: functions of tables that give panels."""

from functools import partial

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from multibody_xval.reports.figures.limits import decade_limits
from multibody_xval.reports.figures.svg import Panel
from multibody_xval.reports.formatting import significant
from multibody_xval.scenarios.model import REFERENCE, Status
from multibody_xval.scenarios.result_tables import is_reference
from multibody_xval.scenarios.studies.claims import TITLES

FREQUENCY = "frequency_ratio"

COLOURS = {"default options": "#d55e00", "recipe": "#009e73", "tuned to the chain": "#0072b2"}
MARKERS = {"default options": "o", "recipe": "s", "tuned to the chain": "."}
OTHER = ("#cc79a7", "x")
"""Colour and mark of other presets."""

LINE = "0.55"
MODES = {"stick": "#b9bfc6", "forward slip": "#0072b2", "backward slip": "#e69f00", "slip": "#56b4e9", "open": "#000"}

MOST_PANELS = 48
"""Panels of a figure on the page: tables have all."""

PLAIN = FuncFormatter(lambda value, _: f"{value:g}")
"""Of logarithmic axes, without powers of ten, which take longer to set than all else of a figure."""

LEAST_PERCENT, LEAST_DB, LEAST_EDGE = 1e-3, 1e-4, 1e-7
"""Errors below are drawn as these: 0.001 % of an amplitude is 0.0001 dB, a tenth of the least change that `compare`
counts, and a thousandth of what the time step explains; 1e-7 in η_r is a tenth of how closely edges are sought."""


def level_text(rows: pd.DataFrame) -> str:
    """Say what a panel shows to those who do not see it."""
    return "; ".join(f"{options}: {_points_text(own)}" for options, own in rows.groupby("options", sort=False)) + "."


def _points_text(rows: pd.DataFrame) -> str:
    """Count the points of a preset: those that are periodic of all that are supported, and the others."""
    counts = rows.status.value_counts()
    supported = len(rows) - counts.get(Status.UNSUPPORTED, 0)
    if not supported:
        return "not supported"
    parts = [f"{counts.get(Status.PERIODIC, 0)} of {supported} points periodic"]
    worst = rows.error_db[rows.status == Status.PERIODIC].abs().max()
    parts += [] if np.isnan(worst) else [f"up to {significant(worst)} dB from the exact motion"]
    others = {"failed": Status.FAILED, "not supported": Status.UNSUPPORTED}
    return ", ".join(parts + [f"{counts[status]} {words}" for words, status in others.items() if status in counts])


def by_options(rows: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
    """Give the rows of every preset, the usual ones first."""
    groups = {str(name): own for name, own in rows.groupby("options", sort=False)}
    order = [*(name for name in TITLES.values() if name in groups), *(name for name in groups if name not in COLOURS)]
    return [(name, groups[name]) for name in order]


def look(options: str) -> tuple[str, str]:
    """Give colour and mark of a preset."""
    return COLOURS.get(options, OTHER[0]), MARKERS.get(options, OTHER[1])


def errors(rows: pd.DataFrame) -> list[Panel]:
    """Draw the errors of all points over the frequency ratio, a panel an engine and formulation."""
    known = rows[rows.error_percent.notna() & ~is_reference(rows)]
    limits = decade_limits(known.error_percent, LEAST_PERCENT)
    return [
        Panel(str(title), level_text(own), partial(_draw_errors, own, limits)) for title, own in known.groupby("title")
    ][:MOST_PANELS]


def _draw_errors(rows: pd.DataFrame, limits: tuple[float, float], axes: Axes) -> None:
    for options, own in by_options(rows):
        colour, marker = look(options)
        sizes = own.error_percent.clip(lower=LEAST_PERCENT)
        axes.plot(own[FREQUENCY], sizes, marker, ms=4.5, mfc="none", mew=0.8, color=colour, clip_on=False)
    axes.set(yscale="log", xlabel="frequency ratio", ylabel="error / % of amplitude", ylim=limits)
    axes.yaxis.set_major_formatter(PLAIN)
    axes.minorticks_off()
    axes.figure.subplots_adjust(left=0.21)


def dots(rows: pd.DataFrame, column: str, least: float, title: str, label: str) -> list[Panel]:
    """Draw a number of every configuration on one scale, a line an engine and formulation."""
    known = rows[rows[column].notna()]
    if known.empty:
        return []
    titles = list(dict.fromkeys(known.title))[::-1]
    text = "; ".join(f"{name} {significant(own[column].max())}" for name, own in known.groupby("title", sort=False))
    edge = f", at the left edge {least:g} or less" if (known[column].abs() <= least).any() else ""
    draw = partial(_draw_dots, known.assign(size=known[column].abs().clip(lower=least)), titles, f"{label}{edge}")
    return [Panel(title, f"Largest, {label}: {text}.", draw, 0.26 * len(titles) + 0.85, 6.0)]


def _draw_dots(rows: pd.DataFrame, titles: list[str], label: str, axes: Axes) -> None:
    axes.figure.subplots_adjust(left=0.33, right=0.96)
    for options, own in by_options(rows):
        colour, marker = look(options)
        size = 9 if marker == "." else 5.5
        axes.plot(own["size"], own.title.map(titles.index), marker, ms=size, mfc="none" if size < 9 else colour,
                  color=colour, clip_on=False)  # fmt: skip
    limits = decade_limits(rows["size"], 0.0)
    axes.set(xscale="log", xlabel=label, xlim=limits, yticks=range(len(titles)), ylim=(-0.6, len(titles) - 0.4))
    axes.set_yticklabels(titles)
    axes.xaxis.set_major_formatter(PLAIN)
    axes.minorticks_off()


def modes(table: pd.DataFrame) -> list[Panel]:
    """Draw when each contact sticks and slips over a period, a panel a configuration."""
    panels = []
    for (title, options), own in table.groupby(["title", "options"], sort=False):
        stuck = own[own["mode"] == "stick"].groupby("cell").length.sum()
        share = stuck.sum() / own.cell.nunique()
        text = f"On average, contacts stick {100 * share:.0f} % of the period."
        name = f"{title}, {options}"
        if own.configuration.iloc[0].startswith(REFERENCE.engine):
            name = "Exact motion" if options == "exact" else "Reference"
        panels.append(Panel(name, text, partial(_draw_modes, own), 1.9))
    return panels


def _draw_modes(rows: pd.DataFrame, axes: Axes) -> None:
    colours = [MODES.get(name, "#888") for name in rows["mode"]]
    axes.barh(rows.cell, rows.length, left=rows.begin, color=colours, height=0.7)
    axes.set(xlim=(0, 1), xlabel="time / period", ylabel="contact of cell", yticks=sorted(rows.cell.unique()))
    axes.grid(visible=False)
