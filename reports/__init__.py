"""From results to what people read: pages, figures and tables."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["report"]


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
    from reports.write import write_report  # drawing libraries are imported when something is drawn

    return write_report(data, folder).page
