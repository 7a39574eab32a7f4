"""Transmittance over the frequency ratio: a panel an engine and case."""

from functools import partial

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from multibody_xval.reports.figures.limits import level_limits
from multibody_xval.reports.figures.panels import FREQUENCY, LINE, MOST_PANELS, by_options, level_text, look
from multibody_xval.reports.figures.svg import Panel
from multibody_xval.scenarios.model import CASE, Case, Status
from multibody_xval.scenarios.result_tables import is_reference

MOST_PLACES = 4
"""Panels of an engine: tables have all."""

MARGIN = 0.1
"""Of an axis, below it, for marks of points that have no level on it."""

BELOW = "v"
"""Mark of a level below the axis."""

MARKS = {Status.NOT_PERIODIC: "|", Status.FAILED: "x"}
"""Marks of points without a level."""


def transmittance(rows: pd.DataFrame) -> list[Panel]:
    """Draw engines as marks, on one axis of levels in all panels, and the reference as a line.

    What an engine does not support is left out, and the title of the panel says so.
    """
    rows = rows.sort_values(FREQUENCY)
    steady = rows[rows.status == Status.PERIODIC]
    limits = level_limits(steady.transmittance_db)
    reference = dict(list(steady[is_reference(steady)].groupby(["place", "steps"])))
    panels = []
    for title, own in rows[~is_reference(rows)].groupby("title"):
        for key in _spread(own):
            at = own[(own.place == key[0]) & (own.steps == key[1])]
            draw = partial(_draw, at[at.status != Status.UNSUPPORTED], reference.get(key), limits)
            panels.append(Panel(f"{title}: {key[0]}{_unsupported(at)}", level_text(at), draw))
    return panels[:MOST_PANELS]


def _unsupported(rows: pd.DataFrame) -> str:
    """Say what an engine does not support of a curve, by preset."""
    lacking = {name: own.status == Status.UNSUPPORTED for name, own in by_options(rows)}
    parts = [
        name if own.all() else f"{own.sum()} of {len(own)} points, {name}" for name, own in lacking.items() if own.any()
    ]
    return f" (not supported: {'; '.join(parts)})" if parts else ""


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


def _draw(rows: pd.DataFrame, reference: pd.DataFrame | None, limits: tuple[float, float], axes: Axes) -> None:
    low, high = limits
    margin = MARGIN * (high - low)
    if reference is not None:
        axes.plot(reference[FREQUENCY], reference.transmittance_db, color=LINE, lw=1.4, zorder=1)
    for options, own in by_options(rows):
        colour, marker = look(options)
        seen = (own.status == Status.PERIODIC) & (own.transmittance_db >= low)
        marks = own.status.map(MARKS).fillna(BELOW).mask(seen, marker)
        levels = own.transmittance_db.where(seen, low - margin / 2)
        for mark in marks.unique():
            at = marks == mark
            axes.plot(own[FREQUENCY][at], levels[at], mark, ms=4.5, mfc="none", mew=0.9, color=colour, clip_on=False)
    axes.set(xlabel="frequency ratio", ylabel="transmittance / dB", ylim=(low - margin, high))
