"""The truth at every point of a compared sweep, and its place in a dataset."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np
import xarray as xr

from reference_lcp.errors import ParameterError
from scenarios.runs.result import Result
from scenarios.runs.task import SteadyStateTask
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.sweep import Case, Sweep
from scenarios.sweeps.table import GivesResults, Point
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.pointwise import CONVERGED
from scenarios.verdicts.steady_case import EXACT, MOST_EXACT_CELLS
from scenarios.verdicts.truth_error import TrueTransmittance, TruthError, truth_error, truth_of

Truths = Mapping[tuple[Case, float], TrueTransmittance]
"""The truth by case and frequency ratio; points where it is not known are left out."""

MOST_EXACT_POINTS = 500
"""Points beyond which none is computed exactly: one takes a tenth of a second, and these a minute of one processor."""

TRUTH_VARIABLES = {
    "truth_db": ("dB", "transmittance of the exact motion; of the converged reference where that is not known"),
    "truth_error_db": ("dB", "error bar of the truth"),
    "truth_exact": ("1", "1 where the truth is that of the exact motion"),
}
"""Variables of a dataset that hold the truth, along the axes but for the variant: units and meaning."""


def exact_tasks(sweep: Sweep, points: list[tuple[Case, float]]) -> dict[tuple[Case, float], SteadyStateTask]:
    """Give the tasks of the exact motion at these points; none where they are too many, or a chain is too long."""
    if len(points) > MOST_EXACT_POINTS:
        return {}
    tasks = {point: sweep.task(EXACT, *point) for point in points}
    return {point: task for point, task in tasks.items() if task.ratios.cells <= MOST_EXACT_CELLS}


def truths(result: ComparedSweep, evaluator: GivesResults | None = None) -> dict[tuple[Case, float], TrueTransmittance]:
    """Give the truth at every point of a sweep; where nothing gives exact results, the converged reference's."""
    at_points = {(case, eta): own for (variant, case, eta), own in result.results.items() if variant == CONVERGED}
    tasks = exact_tasks(result.sweep, list(at_points)) if evaluator is not None else {}
    results = dict(zip(tasks, evaluator.evaluate(list(tasks.values())), strict=True)) if evaluator is not None else {}
    every = {point: truth_of(known, results.get(point, Result.missing())) for point, known in at_points.items()}
    return {point: truth for point, truth in every.items() if truth is not None}


def truth_errors(result: ComparedSweep, every: Truths, points: Iterable[Point]) -> list[tuple[Point, TruthError]]:
    """Give every point that can be compared with the truth, with how far it is from that.

    `points` are of the grid, whether their variants are those of the sweep or others.
    """
    known = result.results
    errors = []
    for point in points:
        truth = every.get((point.case, point.frequency_ratio))
        at_point = known.get(point[:3]) or replace(
            known[CONVERGED, point.case, point.frequency_ratio], variant=point.variant, result=point.result
        )
        error = None if truth is None else truth_error(at_point, truth)
        if error is not None:
            errors.append((point, error))
    return errors


def with_truths(data: xr.Dataset, sweep: Sweep, result: ComparedSweep, every: Truths) -> xr.Dataset:
    """Add the truth to the dataset of a sweep, and ``error_db``: how far every variant is from it.

    `sweep` has all frequency ratios of the dataset; those of `result` are its points.
    """
    if not every:
        return data
    sizes = [len(values) for values in sweep.axes.values()]
    lines = np.array([_line(every.get(place)) for place in _places(sweep)]).reshape(*sizes, -1)
    variables = {
        name: (tuple(sweep.axes), lines[..., number], {"units": units, "long_name": text})
        for number, (name, (units, text)) in enumerate(TRUTH_VARIABLES.items())
    }
    known = {point[:3]: own.error_db for point, own in truth_errors(result, every, result.points)}
    errors = [known.get(point, math.nan) for point in sweep.grid_points()]
    text = f"transmittance less the true one; of amplitudes below {FLOOR_DB:g} dB"
    own = (data["status"].dims, np.reshape(errors, data["status"].shape), {"units": "dB", "long_name": text})
    return data.assign(variables | {"error_db": own})


def _places(sweep: Sweep) -> list[tuple[Case, float]]:
    """Give the points of the grid of one variant, the last axis fastest."""
    return [(case, eta) for variant, case, eta in sweep.grid_points() if variant == sweep.variants[0]]


def _line(truth: TrueTransmittance | None) -> tuple[float, float, float]:
    if truth is None:
        return math.nan, math.nan, math.nan
    return truth.transmittance_db, truth.error_db, float(truth.exact)


def recorded_truths(data: xr.Dataset, sweep: Sweep) -> dict[tuple[Case, float], TrueTransmittance]:
    """Read the truth out of a dataset of this sweep; nothing where it holds none."""
    if not set(TRUTH_VARIABLES) & set(map(str, data.data_vars)):
        return {}
    whole = data.expand_dims([name for name in sweep.axes if name not in data.dims])
    columns = [_column(whole, name, tuple(sweep.axes)) for name in TRUTH_VARIABLES]
    return {
        place: TrueTransmittance(level, bar, exact=bool(exact))
        for place, level, bar, exact in zip(_places(sweep), *columns, strict=True)
        if not math.isnan(level)
    }


def _column(data: xr.Dataset, name: str, axes: tuple[str, ...]) -> list[float]:
    if name not in data or set(data[name].dims) != set(axes) or data[name].dtype.kind not in "fiu":
        raise ParameterError(
            f"{name} of the dataset is not there or no number; allowed: numbers along {', '.join(axes)}"
        )
    values: list[float] = data[name].transpose(*axes).values.astype(np.float64).ravel().tolist()
    return values
