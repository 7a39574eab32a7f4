"""From results to what people read: pages, figures and tables."""

from pathlib import Path
from typing import TYPE_CHECKING

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
        points are computed and kept in the folder, or a store (``.sqlite``), of whose latest sweep it is.
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
    from multibody_xval.reports.write import write_report  # drawing libraries are imported when something is drawn

    return write_report(data, folder).page


def band_edges(
    data: "xr.Dataset", *, store: str | Path | None = None, workers: int | None = None, time_limit: float | None = None
) -> "pd.DataFrame":
    """Find both edges of the attenuation band of every curve, by simulations between the points of the grid.

    A grid whose points are further apart than 0.05 may hide that a curve crosses the threshold again.

    Parameters
    ----------
    data
        The dataset of a sweep, or a part of one, such as ``data.sel(friction_ratio=0.3)``.
    store, workers, time_limit
        As for `sweep`. With the store of the sweep, ``report("results.sqlite", folder)`` has the edges too.

    Returns
    -------
    pandas.DataFrame
        One row an edge: ``engine``, ``formulation``, ``preset``, the values of its case, ``edge`` (lower or upper),
        ``frequency_ratio`` η_r (NaN where there is no such edge, and ``absent`` says why), ``difference`` from the edge
        of the reference in η_r, what is ``allowed`` of it, ``verdict``, ``outcome`` (whether the law of the preset
        predicts a disagreement), ``reason``.

    Raises
    ------
    ParameterError
        If the data are none of a sweep, or of another version of an engine than is installed.
    """
    from multibody_xval.reports.dataset import edges_of

    return edges_of(data, store, workers, time_limit)


def plot(data: "xr.Dataset", file: str | Path | None = None) -> "Figure":
    """Draw the transmittance of a sweep over frequency, for print: a panel a case, or a curve a case of one engine.

    Parameters
    ----------
    data
        The dataset of a sweep, or a part of one with 24 cases at most.
    file
        Where the figure is written too: ``.pdf``, ``.svg``, ``.png`` or what else matplotlib writes.

    Returns
    -------
    matplotlib.figure.Figure
        As wide as one column of a journal, or two; [dB] over η_r, the threshold of the band as a grey line.

    Raises
    ------
    ParameterError
        If the data are none of a sweep or too many, or the file cannot be written.
    """
    from multibody_xval.reports.dataset import figure_of

    return figure_of(data, file)
