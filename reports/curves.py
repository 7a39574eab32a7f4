"""Transmittance of a dataset over the frequency ratio, for print: a panel a case, or a curve a case of one engine."""

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from multibody_xval.reports.figures.limits import level_limits
from multibody_xval.reports.figures.motion import plot_motion
from multibody_xval.reports.figures.picture_file import checked_picture, save_picture
from multibody_xval.reports.figures.style import COLUMN, INK, PALETTE, PRINT_STYLE
from multibody_xval.scenarios.edges import THRESHOLD_DB
from multibody_xval.scenarios.model import Config
from multibody_xval.scenarios.output_files import replacing
from multibody_xval.scenarios.sweeps.dataset import judged_table, sweep_in
from multibody_xval.scenarios.sweeps.plan import FREQUENCY
from reference_lcp.chain.simulation import PeriodicOrbit
from reference_lcp.chain.trajectory import Trajectory
from reference_lcp.errors import ParameterError

PAGE_WIDTH, PANEL_HEIGHT = 7.2, 2.0
"""Width of two columns of a journal, and height of a row of panels [inch]."""

MOST_CASES = 24
"""Cases that one figure shows."""

SOFT = "#57606a"

COLOURS = (INK, *PALETTE)

DASHES = ((), (5.0, 1.5), (1.0, 1.0), (4.0, 1.0, 1.0, 1.0), (8.0, 2.0), (4.0, 1.0, 1.0, 1.0, 1.0, 1.0))
"""Lengths of dashes and gaps over the width of the line."""

PRINT: dict[Any, Any] = {**PRINT_STYLE, "legend.columnspacing": 2.0}
"""Style of figures for print; names of configurations are long."""


def drawn_curves(data: xr.Dataset, file: str | Path | None) -> Figure:
    """Draw the transmittance of a dataset; see `multibody_xval.plot`."""
    picture = None if file is None else checked_picture("file", file)
    table = judged_table(data)
    axes = [name for name in sweep_in(data).axes if name != FREQUENCY]
    with mpl.rc_context(PRINT):
        figure = _drawn(table, axes)
        if picture is not None:
            with replacing(picture) as part:
                figure.savefig(part)
    return _shown_in_notebooks(figure)


def drawn_motion(motion: PeriodicOrbit | Trajectory, file: str | Path | None) -> Figure:
    """Draw a motion; see `multibody_xval.plot`."""
    picture = None if file is None else checked_picture("file", file)
    figure = plot_motion(motion)
    if picture is not None:
        save_picture(figure, picture)
    return _shown_in_notebooks(figure)


def _shown_in_notebooks(figure: Figure) -> Figure:
    """Let a notebook show a figure: it knows those of pyplot alone, which a script would have to close."""

    def png() -> bytes:
        picture = io.BytesIO()
        figure.savefig(picture, format="png", dpi=120)
        return picture.getvalue()

    figure._repr_png_ = png  # type: ignore[attr-defined]
    return figure


def _drawn(table: pd.DataFrame, axes: list[str]) -> Figure:
    """Draw a panel a case with a curve a configuration, or one panel with a curve a case."""
    cases = table[axes].drop_duplicates()
    configs = list(dict.fromkeys(table.config))
    if not 1 <= len(cases) <= MOST_CASES:
        allowed = f"1 to {MOST_CASES}, such as data.sel(...)"
        raise ParameterError(f"the data have {len(cases)} cases; allowed: {allowed}")
    titles = [_title(row) for row in cases.to_dict("records")]
    alone = len(configs) == 1
    figure, panels = _panels([configs[0].title] if alone else titles)
    limits = level_limits(table.transmittance_db[table.status == "periodic"], THRESHOLD_DB)
    for panel in panels:
        panel.axhline(THRESHOLD_DB, color=SOFT, linewidth=0.6)
        panel.set(ylim=limits)
    for place, config, own in _curves(table, cases, configs):
        style = place if alone else configs.index(config)
        colour, dashes = COLOURS[style % len(COLOURS)], DASHES[style % len(DASHES)]
        gaps = own.isna().any() or len(own) == 1  # no line shows a point between two of them
        look: dict[str, Any] = {
            "color": colour,
            "linestyle": (0, dashes) if dashes else "-",
            "marker": "." if gaps else "",
        }
        panels[0 if alone else place].plot(own.index, own, label=titles[place] if alone else config.title, **look)
    _legend(figure, panels)
    return figure


def _curves(table: pd.DataFrame, cases: pd.DataFrame, configs: list[Config]) -> Iterator[tuple[int, Config, pd.Series]]:
    """Give every curve with the number of its case: its levels [dB] by η_r, NaN where there is no steady state."""
    level = table.transmittance_db.where(table.status == "periodic")
    for place, (_, case) in enumerate(cases.iterrows()):
        here = (table[list(cases)] == case).all(axis=1)
        for config in configs:
            own = here & (table.config == config)
            yield place, config, pd.Series(level[own].to_numpy(), table[FREQUENCY][own]).sort_index()


def _title(case: dict[Any, Any]) -> str:
    return ", ".join(f"{name.replace('_', ' ')} {value:g}" for name, value in case.items())


def _panels(titles: list[str]) -> tuple[Figure, list[Axes]]:
    """Give a figure with a panel a title, in one column or two."""
    columns = min(len(titles), 2)
    rows = -(-len(titles) // columns)
    size = (PAGE_WIDTH if columns > 1 else COLUMN, 0.9 + PANEL_HEIGHT * rows)
    figure = Figure(figsize=size, layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel()
    for panel, title in zip(grid, titles, strict=False):
        panel.set_title(title)
    for panel in grid[::columns]:
        panel.set_ylabel("transmittance [dB]")
    for panel in grid[len(titles) :]:
        panel.set_visible(False)
    figure.supxlabel("frequency ratio $η_r$ = ω/$ω_r$ [-]")
    return figure, list(grid[: len(titles)])


def _legend(figure: Figure, panels: list[Axes]) -> None:
    """Name every curve once, above all panels."""
    handles, labels = panels[0].get_legend_handles_labels()
    columns = 4 if figure.get_figwidth() > COLUMN else 2
    figure.legend(handles, labels, loc="outside upper center", ncols=min(len(labels), columns) or 1)
