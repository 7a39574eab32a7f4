"""The report that a folder holds already: one that shows more is not overwritten by one of a store alone."""

from collections import Counter
from pathlib import Path

import numpy as np
import xarray as xr

from reference_lcp.refusal import ParameterError
from reports.data.report import Report
from reports.export.files import NETCDF, PAGE
from scenarios.sweeps.dataset import STATUSES
from scenarios.sweeps.dataset_file import read_dataset
from scenarios.tasks.result import ResultStatus


def check_loses_nothing(folder: Path, report: Report) -> None:
    """Refuse to overwrite a report that has results of a variant which this one has not.

    Raises
    ------
    ParameterError
        If the report in the folder has more points with a result of any variant.
    """
    points = report.result.points
    shown = Counter(str(point.variant) for point in points if point.result.status is not ResultStatus.MISSING)
    earlier = _results(folder / NETCDF)
    fewer = {variant: count for variant, count in earlier.items() if count > shown[variant]}
    if fewer:
        variant, count = max(fewer.items(), key=lambda item: item[1] - shown[item[0]])
        problem = f"{folder / PAGE} shows more than the store holds for this page: of {variant} {count} points"
        raise ParameterError(f"{problem} for {shown[variant]}; allowed: another --out, or without --no-ask")


def _results(file: Path) -> Counter[str]:
    """Count the points with a result of each variant of a report; none where there is no report that can be read."""
    if not file.is_file():
        return Counter()
    try:
        data = read_dataset(file)
        return _counted(data)
    except (ParameterError, KeyError):
        return Counter()


def _counted(data: xr.Dataset) -> Counter[str]:
    present = ~np.isin(data["status"], [STATUSES.index(ResultStatus.MISSING)])
    axes = [name for name in data["status"].dims if name != "variant"]
    counts = data["status"].copy(data=present).sum(axes)
    return Counter({str(name): int(count) for name, count in zip(data["variant"].values, counts.values, strict=True)})
