"""Figures of the page: functions of tables that give panels."""

from functools import partial

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from multibody_xval.reports.figures.svg import Panel
from multibody_xval.reports.formatting import significant
from multibody_xval.scenarios.conclusions import TITLES
from multibody_xval.scenarios.judge import FLOOR_DB
from multibody_xval.scenarios.model import CASE, REFERENCE, Case, Status
from multibody_xval.scenarios.result_tables import is_reference

FREQUENCY = "frequency_ratio"

COLOURS = {"default options": "#d55e00", "recipe": "#009e73", "tuned to the chain": "#0072b2"}
MARKERS = {"default options": "o", "recipe": "s", "tuned to the chain": "."}
OTHER = ("#cc79a7", "x")
"""Colour and mark of other presets."""

LINE = "0.55"
MODES = {"stick": "#b9bfc6", "forward slip": "#0072b2", "backward slip": "#e69f00", "slip": "#56b4e9", "open": "#000"}

MOST_PLACES, MOST_PANELS = 4, 48
"""Panels of an engine, and of a figure on the page: tables have all."""

PLAIN = FuncFormatter(lambda value, _: f"{value:g}")
"""Of logarithmic axes, without powers of ten, which take longer to set than all else of a figure."""

LEAST_PERCENT, LEAST_DB, LEAST_EDGE = 1e-4, 1e-4, 1e-7
"""Errors below are drawn as these."""


def transmittance(rows: pd.DataFrame) -> list[Panel]:
    """Draw the transmittance over the frequency ratio, a panel an engine and case: the reference as a line."""
    rows = rows.assign(level=rows.transmittance_db.clip(lower=FLOOR_DB)).sort_values(FREQUENCY)
    steady = rows[rows.status == Status.PERIODIC]
    reference = dict(list(steady[is_reference(steady)].groupby(["place", "steps"])))
    panels = []
    for title, own in rows[~is_reference(rows)].groupby("title"):
        for key in _spread(own):
            at = own[(own.place == key[0]) & (own.steps == key[1])]
            draw = partial(_draw_level, at, reference.get(key))
            panels.append(Panel(f"{title}: {key[0]}", _level_text(at), draw))
    return panels[:MOST_PANELS]


def _spread(rows: pd.DataFrame) -> list[tuple[str, int]]:
    """Give at most `MOST_PLACES` places with their steps, evenly; those without friction only where all have room."""
    cases = rows.groupby(["place", "steps"], sort=False).case.first()
    order = sorted(cases.index, key=lambda key: (_numbers(cases[key]), key[1]))
    places = order if len(order) <= MOST_PLACES else [key for key in order if np.any(cases[key].friction_ratio)]
    chosen = np.unique(np.linspace(0, len(places) - 1, min(MOST_PLACES, len(places))).round().astype(int))
    return [places[k] for k in chosen]


def _numbers(case: Case) -> list[float]:
    """Give what curves are sorted by; of cells that differ, the mean."""
    return [float(np.mean(getattr(case, name))) for name in CASE if name not in ("drive", FREQUENCY)]


def _level_text(rows: pd.DataFrame) -> str:
    """Say what a panel shows to those who do not see it."""
    parts = []
    for options, own in rows.groupby("options", sort=False):
        steady = own[own.status == Status.PERIODIC]
        worst = steady.error_db.abs().max()
        error = "" if np.isnan(worst) else f", up to {significant(worst)} dB from the exact motion"
        parts.append(f"{options}: {len(steady)} of {len(own)} points periodic{error}")
    return "; ".join(parts) + "."


def _draw_level(rows: pd.DataFrame, reference: pd.DataFrame | None, axes: Axes) -> None:
    if reference is not None:
        axes.plot(reference[FREQUENCY], reference.level, color=LINE, lw=1.4, zorder=1)
    for options, own in _by_options(rows):
        colour, marker = look(options)
        steady = own.status == Status.PERIODIC
        axes.plot(own[FREQUENCY][steady], own.level[steady], marker, ms=4.5, mfc="none", mew=0.9, color=colour)
        axes.plot(own[FREQUENCY][~steady], np.full((~steady).sum(), FLOOR_DB - 3), "|", ms=5, color=colour)
    axes.set(xlabel="frequency ratio", ylabel="transmittance / dB", ylim=(FLOOR_DB - 6, None))


def _by_options(rows: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
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
    top = 2 * known.error_percent.max() if len(known) else 100.0
    return [
        Panel(str(title), _level_text(own), partial(_draw_errors, own, top)) for title, own in known.groupby("title")
    ][:MOST_PANELS]


def _draw_errors(rows: pd.DataFrame, top: float, axes: Axes) -> None:
    for options, own in _by_options(rows):
        colour, marker = look(options)
        sizes = own.error_percent.clip(lower=LEAST_PERCENT)
        axes.plot(own[FREQUENCY], sizes, marker, ms=4.5, mfc="none", mew=0.8, color=colour)
    axes.set(yscale="log", xlabel="frequency ratio", ylabel="error / % of amplitude", ylim=(LEAST_PERCENT / 2, top))
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
    draw = partial(_draw_dots, known.assign(size=known[column].abs().clip(lower=least)), titles, label)
    return [Panel(title, f"Largest, {label}: {text}.", draw, 0.26 * len(titles) + 0.85, 6.0)]


def _draw_dots(rows: pd.DataFrame, titles: list[str], label: str, axes: Axes) -> None:
    axes.figure.subplots_adjust(left=0.33)
    for options, own in _by_options(rows):
        colour, marker = look(options)
        size = 9 if marker == "." else 5.5
        axes.plot(own["size"], own.title.map(titles.index), marker, ms=size, mfc="none" if size < 9 else colour,
                  color=colour)  # fmt: skip
    axes.set(xscale="log", xlabel=label, yticks=range(len(titles)), ylim=(-0.6, len(titles) - 0.4))
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
