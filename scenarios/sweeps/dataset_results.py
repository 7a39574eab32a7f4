"""Results out of a dataset: a report is made of one as of anything else that gives results."""

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from pydantic import ValidationError

from engines.interface.variant import Variant
from reference_lcp.refusal import ParameterError
from scenarios.sweeps.dataset import MODES, PREDICTED, STATUSES, SWEEP
from scenarios.sweeps.dataset_check import check_dataset
from scenarios.sweeps.sweep import Sweep
from scenarios.sweeps.table import GridPoint
from scenarios.tasks.result import Result, ResultStatus
from scenarios.tasks.task import SteadyStateTask
from scenarios.tasks.validation_message import first_error
from scenarios.verdicts.finding import Metric, Prediction


def sweep_of(data: xr.Dataset) -> Sweep:
    """Give the sweep whose results a dataset holds; of a part of one, such as ``data.sel(...)``, that part.

    Raises
    ------
    ParameterError
        If the dataset is none of a sweep.
    """
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
    variants = tuple(Variant.recorded(str(name)) for name in np.atleast_1d(data["variant"].values).tolist())
    axes = {name: tuple(np.atleast_1d(data[name].values).tolist()) for name in whole.axes}
    return dataclasses.replace(whole, variants=variants, axes=axes)


class DatasetResults:
    """Gives the results that a dataset holds; what it does not hold is missing.

    Parameters
    ----------
    data
        The dataset of a sweep, see `scenarios.sweeps.dataset.sweep_dataset`; also one that has been read back from
        a file, or a part of one.

    Attributes
    ----------
    sweep
        The sweep.
    points
        Points of the sweep for which the dataset has a result or a status.
    predictions
        What the laws of variants say, by point and metric, where they were asked.

    Raises
    ------
    ParameterError
        If it is none of a sweep.
    """

    def __init__(self, data: xr.Dataset):
        self.sweep = sweep_of(data)
        whole = data.expand_dims([name for name in ("variant", *self.sweep.axes) if name not in data.dims])
        check_dataset(whole, ("variant", *self.sweep.axes))
        rows = _rows_by_point(self.sweep, whole)
        self._results = _results(self.sweep, whole, rows)
        self.predictions = {point: own for point, row in rows.items() if (own := _predictions(row))}
        judged = _rows(whole["verdict"], ("variant", *self.sweep.axes)) >= 0
        self.points = [point for point, known in zip(self.sweep.grid_points(), judged, strict=True) if known]

    def evaluate(self, tasks: Sequence[SteadyStateTask]) -> list[Result]:
        """Give the result of every task, in order."""
        return [self._results.get(task) or Result.missing() for task in tasks]


def _rows_by_point(sweep: Sweep, whole: xr.Dataset) -> dict[GridPoint, dict[str, Any]]:
    """Give all values of every point by name."""
    grid = ("variant", *sweep.axes)
    columns = {
        str(name): _rows(values, grid) for name, values in whole.data_vars.items() if set(grid) <= set(values.dims)
    }
    return {
        point: {name: values[number] for name, values in columns.items()}
        for number, point in enumerate(sweep.grid_points())
    }


def _results(
    sweep: Sweep, whole: xr.Dataset, rows: Mapping[GridPoint, dict[str, Any]]
) -> dict[SteadyStateTask, Result]:
    """Give every result of a dataset by its task."""
    factors = [float(factor) for factor in whole["refinement"].values] if "refinement" in whole.dims else []
    results = {}
    for point, row in rows.items():
        results[sweep.task(*point)] = _result(row)
        for k, factor in enumerate(factors):
            if not math.isnan(row["refined_transmittance_db"][k]):
                results[sweep.task(*point, factor)] = _refined(row, k)
    return results


def _predictions(row: Mapping[str, Any]) -> dict[Metric, Prediction]:
    """Rebuild what the law of a variant says of a point; nothing where it was not asked."""
    return {
        metric: Prediction(
            value=float(row[f"law_value_{ending}"]),
            difference=float(row[f"law_left_{ending}"]),
            allowed=float(row[f"law_allowed_{ending}"]),
            distance=float(row["law_distance"]),
            period_bound=float(row["law_period_bound"]),
            certified=bool(row["law_certified"]),
        )
        for metric, ending, _ in PREDICTED
        if not (math.isnan(row["law_period_bound"]) or math.isnan(row[f"law_allowed_{ending}"]))
    }


def _rows(values: xr.DataArray, grid: Sequence[str]) -> Any:
    """Give a variable with one row a point, in the order of `Sweep.grid_points`."""
    rest = [name for name in values.dims if name not in grid]
    array = values.transpose(*grid, *rest).values
    return array.reshape(-1, *array.shape[len(grid) :])


def _result(row: dict[str, Any]) -> Result:
    """Rebuild a result; of creep the largest of all contacts is known."""
    changes = zip(*(_without_nan(row[f"transition_{part}"]) for part in ("cell", "time", "mode")), strict=True)
    return Result(
        status=STATUSES[int(row["status"])],
        reason=str(row["reason"]),
        transmittance_db=float(row["transmittance_db"]),
        phase=float(row["phase"]),
        residual=float(row["residual"]),
        amplification=float(row["amplification"]),
        periods=_whole(row["periods"]),
        multiple=_whole(row["multiple"]),
        steps_per_period=_whole(row["steps_per_period"]),
        period=float(row["period"]),
        stuck_fraction=_without_nan(row["stuck_fraction"]),
        transitions=tuple((int(cell), time, str(MODES[int(mode)])) for cell, time, mode in changes),
        creep=_without_nan([row["creep"]]),
        seconds=float(row["seconds"]),
    )


def _refined(row: dict[str, Any], index: int) -> Result:
    """Rebuild a steady state with another number of steps."""
    return Result(
        status=ResultStatus.CONVERGED,
        transmittance_db=float(row["refined_transmittance_db"][index]),
        phase=float(row["refined_phase"][index]),
        steps_per_period=_whole(row["refined_steps_per_period"][index]),
    )


def _whole(value: float) -> int:
    return 0 if math.isnan(value) else int(value)


def _without_nan(values: Any) -> tuple[float, ...]:
    return tuple(float(value) for value in values if not math.isnan(value))
