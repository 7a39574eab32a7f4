"""Results out of the dataset of a sweep, read and checked as if a stranger had written it."""

import dataclasses
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr
from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.parameters import first_error
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.sweeps.dataset import PREDICTED, STORED_POINT, SWEEP, StoredPoint
from multibody_xval.scenarios.sweeps.point import other_tasks
from multibody_xval.scenarios.sweeps.sweep import GridPoint, Sweep
from multibody_xval.scenarios.verdicts.finding import Metric, Prediction
from reference_lcp.errors import ParameterError, checked_path

LARGEST_DATASET = 2**30
"""Bytes of all arrays of a dataset in memory; 20,000 points take a fiftieth of it. A compressed file may claim more."""


def read_dataset(file: Path) -> xr.Dataset:
    """Read the dataset of a sweep."""
    if file.suffix != ".nc":
        raise ParameterError(f"{file} has the ending {file.suffix!r}; allowed: .nc, .toml or .sqlite")
    if not checked_path("dataset", file).is_file():
        raise ParameterError(f"{file} cannot be read: there is no such file; allowed: NetCDF")
    try:
        _check_links(file)
        with xr.open_dataset(file, engine="h5netcdf") as opened:
            _check_size(file, opened)
            return opened.load()
    except ParameterError:
        raise
    except Exception as problem:  # HDF5, h5netcdf and xarray raise all kinds of them on a damaged file
        reason = " ".join(str(problem).split())
        raise ParameterError(f"{file} cannot be read: {reason}; allowed: NetCDF as `sweep --out` writes it") from None


def _check_size(file: Path, data: xr.Dataset) -> None:
    """Refuse arrays that take too much memory."""
    if data.nbytes > LARGEST_DATASET:
        raise ParameterError(f"{file} holds {data.nbytes:.3g} bytes; allowed: {LARGEST_DATASET:.3g}")


def _check_links(file: Path) -> None:
    """Refuse arrays that HDF5 would take out of other files."""
    with h5py.File(file, "r") as opened:
        for name in opened:
            if not isinstance(opened.get(name, getlink=True), h5py.HardLink):
                raise ParameterError(f"{file}: {name!r} is a link; allowed: arrays in the file itself")
            array = opened[name]
            if isinstance(array, h5py.Dataset) and (array.external or array.is_virtual):
                raise ParameterError(f"{file}: {name!r} lies in another file; allowed: arrays in the file itself")


ROUND_OFF = 1e-9
"""Of fractions that are sums of durations."""


class _Option(BaseModel):
    """An option that a preset sets."""

    model_config = ConfigDict(extra="forbid")
    name: str
    value: Any
    default: Any
    reason: str


class _Description(BaseModel):
    """What `multibody_xval.scenarios.sweeps.dataset.description_of` gives."""

    model_config = ConfigDict(extra="forbid")
    package: str
    version: str | None
    description: str
    options: list[_Option]


_DESCRIPTIONS = TypeAdapter(dict[str, _Description])


def recorded_variants(data: xr.Dataset) -> dict[str, Any]:
    """Give package, version, description and options of each variant, as they were noted with the numbers."""
    try:
        read = _DESCRIPTIONS.validate_json(data.attrs["variants"])
    except KeyError:
        raise ParameterError("the dataset has no attribute 'variants'; allowed: the dataset of a sweep") from None
    except ValidationError as problem:
        known = ", ".join(_Description.model_fields)
        raise ParameterError(f"variants of the dataset: {first_error(problem, known)}") from None
    return json.loads(_DESCRIPTIONS.dump_json(read))


def sweep_of(data: Any) -> Sweep:
    """Give the sweep whose results a dataset holds; of a part of one, such as ``data.sel(...)``, that part."""
    if not isinstance(data, xr.Dataset):
        raise ParameterError(f"data is a {type(data).__name__}; allowed: the dataset of a sweep, or a part of one")
    try:
        whole = SWEEP.validate_json(data.attrs["sweep"])
    except KeyError:
        raise ParameterError("the dataset has no attribute 'sweep'; allowed: the dataset of a sweep") from None
    except ValidationError as problem:
        error = first_error(problem, "what a sweep has")
        raise ParameterError(f"attribute 'sweep' of the dataset: {error}") from None
    for name in ("variant", *whole.axes):
        if name not in data.coords or data[name].ndim > 1:
            raise ParameterError(f"the dataset has no coordinate {name!r}; allowed: all those of its sweep")
    variants = tuple(Variant.parse(str(name)) for name in np.atleast_1d(data["variant"].values).tolist())
    axes = {name: tuple(np.atleast_1d(data[name].values).tolist()) for name in whole.axes}
    return dataclasses.replace(whole, variants=variants, axes=axes)


class DatasetResults:
    """Gives the results that a dataset of a sweep, or a part of one, holds; what it does not hold is missing."""

    def __init__(self, data: xr.Dataset):
        self.sweep = sweep_of(data)
        self.results: dict[SteadyStateTask, Result] = {}
        self.predictions: dict[GridPoint, dict[Metric, Prediction]] = {}
        self.points: list[GridPoint] = []
        self.modelled: set[Variant] = set()
        """Variants whose model stands in for them, see `multibody_xval.scenarios.sweeps.point.evaluated`."""
        for point, text in zip(self.sweep.grid_points(), _texts(data, self.sweep), strict=True):
            if text:
                self._add(point, _read(text))

    def _add(self, point: GridPoint, stored: StoredPoint) -> None:
        """Add a point of the grid."""
        model = point[0].law if stored.modelled else None
        if model is not None:
            self.modelled.add(point[0])
        tasks = [self.sweep.task(*point), *other_tasks(self.sweep, point, model)]
        self.results |= zip(tasks, (stored.result, *stored.others), strict=False)
        metrics = {metric.name: metric for metric, _, _ in PREDICTED}
        self.predictions[point] = {metrics[name]: own for name, own in stored.predictions.items() if name in metrics}
        self.points.append(point)

    def evaluate(self, tasks: Sequence[SteadyStateTask]) -> list[Result]:
        """Give the result of every task, in order."""
        return [self.results.get(task) or Result.missing() for task in tasks]


def _texts(data: xr.Dataset, sweep: Sweep) -> list[str]:
    """Give what is stored of each point, in the order of `Sweep.grid_points`."""
    grid = ("variant", *sweep.axes)
    if "stored" not in data.data_vars:
        raise ParameterError("the dataset has no variable 'stored'; allowed: the dataset of a sweep")
    texts = data["stored"].expand_dims([name for name in grid if name not in data["stored"].dims])
    if set(texts.dims) != set(grid):
        raise ParameterError(f"stored has the dimensions {texts.dims}; allowed: {', '.join(grid)}")
    return [str(text) for text in texts.transpose(*grid).values.ravel()]


def _read(text: str) -> StoredPoint:
    """Read a point, whose numbers a figure can show."""
    try:
        point = STORED_POINT.validate_json(text)
    except ValidationError as problem:
        names = ", ".join(each.name for each in dataclasses.fields(StoredPoint))
        raise ParameterError(f"stored of the dataset: {first_error(problem, names)}") from None
    for part in point.result.stuck_fraction:
        if not 0 <= part <= 1 + ROUND_OFF:
            raise ParameterError(f"stuck_fraction = {part:g} in the dataset; allowed: 0 to 1")
    for _, time, _ in point.result.transitions:
        if not 0 <= time < math.inf:
            raise ParameterError(f"time of a transition = {time:g} s in the dataset; allowed: >= 0")
    return point
