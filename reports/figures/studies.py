"""Figures of studies: functions of tables, drawn by matplotlib."""

import io
import math
from itertools import cycle
from typing import Any

import pandas as pd
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from multibody_xval.engines.interface.registry import engine
from multibody_xval.reports.figures.limits import decade_limits, level_limits
from multibody_xval.reports.figures.panels import LEAST_DB
from multibody_xval.reports.figures.style import PALETTE
from multibody_xval.scenarios.edges import THRESHOLD_DB
from multibody_xval.scenarios.model import Config
from multibody_xval.scenarios.result_tables import coarsest, is_exact, is_reference
from multibody_xval.scenarios.studies.claims import RANGE, claim_cases

SHAPES, LINES = "os^Dv<>p*hX", ("-", "--", ":", "-.")
FRICTION_TICKS, SPEED_TICKS = (-100, -10, -1, 0, 1, 10, 100), (1e-5, 1e-3, 0.1)
STYLE: dict[Any, Any] = {
    "svg.hashsalt": "multibody-xval", "svg.fonttype": "path", "font.size": 9.0, "savefig.dpi": 200.0,
}  # fmt: skip


def figure_file(figure: Figure, ending: str) -> bytes:
    """Give a figure as a file of a format, with the same bytes for the same figure."""
    written = io.BytesIO()
    dated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {}}
    with rc_context(STYLE):
        figure.savefig(written, format=ending, bbox_inches="tight", metadata=dated[ending])
    return written.getvalue()


def transmittance(points: pd.DataFrame, edges: pd.DataFrame) -> Figure:
    """Draw the reference as lines, one a friction ratio, with its band edges, and other configurations as marks."""
    shown = coarsest(points[~is_exact(points) & (points.status == "periodic")]).sort_values("frequency_ratio")
    figure = Figure(figsize=(7.2, 4.4), layout="constrained")
    axes = figure.subplots()
    axes.axhline(THRESHOLD_DB, color="0.8", lw=0.8, zorder=0)
    reference, rest = shown[is_reference(shown)], shown[~is_reference(shown) & shown.case.isin(claim_cases())]
    own_edges = edges[is_reference(edges)]
    frictions = pd.Series([case.friction_ratio for case in own_edges.curve], own_edges.index, dtype=float)
    colours = {}
    for (friction, curve), style in zip(reference.groupby("friction_ratio"), cycle(LINES), strict=False):
        name = f"reference, friction ratio {friction:g}"
        (line,) = axes.plot(curve.frequency_ratio, curve.transmittance_db, style, lw=1.0, label=name)
        colours[friction] = line.get_color()
        at = own_edges.frequency_ratio[frictions == friction]
        axes.plot(at, [THRESHOLD_DB] * len(at), "|", color=line.get_color(), ms=9, mew=1.4)
    config: Any
    for number, (config, own) in enumerate(rest.groupby("config", sort=False)):
        ink = [colours.get(friction, "0.3") for friction in own.friction_ratio]
        axes.scatter(
            own.frequency_ratio, own.transmittance_db, 14 + 5 * number, marker=SHAPES[number % len(SHAPES)],
            facecolors="none", edgecolors=ink, linewidths=0.7, label=title(config),
        )  # fmt: skip
    axes.set(xlabel="frequency ratio $\\omega/\\omega_r$", ylabel="transmittance / dB")
    axes.set(xlim=RANGE, ylim=level_limits(shown.transmittance_db, THRESHOLD_DB))
    figure.legend(loc="outside upper center", ncols=3, frameon=False, fontsize=8)
    return figure


def costs(table: pd.DataFrame) -> Figure:
    """Draw the error of every configuration over the processor time of a simulated second, a line a configuration."""
    figure = Figure(figsize=(7.2, 4.4), layout="constrained")
    axes = figure.subplots()
    whole = table[table.complete & (table.error_db > 0)]
    config: Any
    for number, (config, own) in enumerate(whole.groupby("config", sort=False)):
        shape = SHAPES[number % len(SHAPES)]
        axes.plot(own.milliseconds, own.error_db, marker=shape, ms=4, mfc="none", lw=0.9, label=title(config))
    limits = decade_limits(whole.error_db, LEAST_DB)
    axes.set(xscale="log", yscale="log", ylim=limits, xlabel="ms per simulated second", ylabel="largest error / dB")
    if not whole.empty:
        figure.legend(loc="outside right upper", frameon=False, fontsize=8)
    return figure


def frictions(table: pd.DataFrame) -> Figure:
    """Draw friction less 1 over the speed, a panel a configuration and a line an angle; two engines in a row."""
    names = list(dict.fromkeys(table.configuration[table.friction.notna()]))
    own = table[table.configuration.isin(names)]
    cells = {name: 2 * list(dict.fromkeys(own.engine)).index(name.split(":")[0]) for name in names}
    rows = math.ceil((max(cells.values(), default=0) + 2) / 4)
    figure = Figure(figsize=(7.6, 0.6 + 1.35 * rows), layout="constrained")
    panels = figure.subplots(rows, 4, sharex=True, sharey=True, squeeze=False).ravel()
    for axes in panels:
        axes.set_axis_off()
    for name, first in cells.items():
        axes = panels[first + ("recommended" in name)]
        axes.set_axis_on()
        _draw_frictions(axes, own[own.configuration == name])
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=4, frameon=False, fontsize=8)
    figure.supxlabel("speed / (m/s)", fontsize=9)
    figure.supylabel("friction over μ N, less 1 / %", fontsize=9)
    return figure


def _draw_frictions(axes: Axes, rows: pd.DataFrame) -> None:
    preset = rows.preset.iloc[0].replace("recommended", "recipe")
    axes.set_title(f"{engine(rows.engine.iloc[0]).capabilities.title}, {preset}", fontsize=8, loc="left")
    axes.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    for number, (angle, line) in enumerate(rows.groupby("angle")):
        axes.plot(line.speed, line.friction, marker=SHAPES[number], ms=5 - number, mfc="none", mew=0.7, lw=0.8,
                  color=PALETTE[number], label=f"{angle}°")  # fmt: skip
    axes.set(xscale="log", xticks=SPEED_TICKS, xticklabels=[f"{tick:g}" for tick in SPEED_TICKS])
    axes.set_yscale("symlog", linthresh=1.0, linscale=0.6)
    axes.set(ylim=(-150, 300), yticks=FRICTION_TICKS, yticklabels=map(str, FRICTION_TICKS))
    axes.tick_params(labelsize=7, labelbottom=True)
    axes.minorticks_off()


def title(config: Config) -> str:
    """Name a configuration in a legend."""
    preset = config.preset_name.split(":")[0]
    return f"{config.title}, tuned" if preset == "tuned" and config.engine != "reference" else config.title
