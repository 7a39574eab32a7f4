"""From results to what people read: pages, figures and tables."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

# A checkout has the folder of this name too: nothing is to be imported twice.
if __name__ != "multibody_xval.reports":
    raise ImportError("reports is a folder of the suite, and no package; allowed: multibody_xval.reports")

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["band_edges", "plot", "report"]


def report(data: "xr.Dataset | str | Path", folder: str | Path) -> Path:
    """Write a report: a page, its figures and its tables.

    Parameters
    ----------
    data
        The dataset of a sweep; or the name of a file: such a dataset as NetCDF (``.nc``), a sweep (``.toml``), whose
        points are computed and kept in the folder, or a store (``.sqlite``), all of whose results are shown.
    folder
        Where the report is written; made if it is missing.

    Returns
    -------
    Path
        The page, ``index.html``.

    Raises
    ------
    ParameterError
        If the data are none of a sweep, or the folder cannot be written.
    """
    from multibody_xval.reports.page.sources import written_report  # matplotlib is imported when something is drawn

    return written_report(data, folder).page


def band_edges(
    data: "xr.Dataset", *, store: str | Path | None = None, workers: int | None = None, time_limit: float | None = None
) -> "pd.DataFrame":
    """Find both edges of the attenuation band of every curve, by simulations between the points of the grid.

    Parameters
    ----------
    data
        The dataset of a sweep, or a part of one, such as ``data.sel(friction_ratio=0.3)``.
    store, workers, time_limit
        As for `sweep`.

    Returns
    -------
    pandas.DataFrame
        One row an edge: the axes of the sweep, such as ``friction_ratio``; ``edge`` (lower or upper);
        ``frequency_ratio`` η_r with the steps per period of the sweep, NaN where there is no such edge; ``note``: why
        there is none, or that the last peak before it is less than 1 dB above the threshold; ``error`` from ``exact``,
        the edge of the exact motion, which is the one to cite; ``exact_bar``, how far that may be off. Where there are
        other configurations than the reference: ``configuration``, the edge that is ``expected`` (of presets that share
        the scheme, the reference's at equal steps), what is ``allowed`` from that, and the ``verdict``.

    Raises
    ------
    ParameterError
        If the data are none of a sweep, have no points, or are of another version of an engine than is installed.
    """
    from multibody_xval.scenarios.compute import SECONDS_A_RUN
    from multibody_xval.scenarios.running.evaluate import Means
    from multibody_xval.scenarios.store import checked_store
    from multibody_xval.scenarios.sweeps.edge_table import edge_table

    file = None if store is None else checked_store(store)
    seconds = SECONDS_A_RUN if time_limit is None else time_limit
    return edge_table(data, Means(store=file, workers=workers, seconds_a_run=seconds))


def plot(data: Any, file: str | Path | None = None) -> "Figure":
    """Draw a motion, or the transmittance of a sweep over frequency: a panel a case, or a curve a case of one engine.

    Parameters
    ----------
    data
        The dataset of a sweep, or a part of one with 24 cases at most; or a motion: a steady state, an orbit, or the
        trajectory of `simulate`, `simulate_system` or `EventDrivenSystem.motion`.
    file
        Where the figure is written too: ``.pdf``, ``.svg``, ``.png``, ``.eps``, ``.jpg`` or ``.tif``.

    Returns
    -------
    matplotlib.figure.Figure
        Of a sweep as wide as one column of a journal, or two; [dB] over η_r, the threshold of the band as a grey line.
        All steady states are drawn, whatever their verdict. ``figure.axes[0].set_xlim(0.3, 1.6)`` changes an axis.
        Of a motion displacement, relative velocity and friction over time, grey where a contact sticks.

    Raises
    ------
    ParameterError
        If the data are none of a sweep or too many, or the file cannot be written.
    """
    from multibody_xval.reports.curves import drawn_curves, drawn_motion

    motion = getattr(data, "orbit", data)
    if hasattr(motion, "trajectory") or hasattr(motion, "relative_velocity"):
        return drawn_motion(motion, file)
    return drawn_curves(data, file)
