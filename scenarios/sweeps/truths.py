"""One ruler for all variants: how far a transmittance is from the truth, at every point of a sweep.

The truth at a point is that of the exact motion: proven, at the points of the table that comes with the suite; event by
event, where that is certified; and that of the converged reference elsewhere. It is one number for all variants,
whatever each of them is judged by, and has an error itself.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from enum import StrEnum

import numpy as np
import pandas as pd
import xarray as xr

from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.sweeps.compared import ComparedSweep
from multibody_xval.scenarios.sweeps.point import GivesResults, Point, Truth, point_resolution, scheme_by_steps
from multibody_xval.scenarios.sweeps.sweep import Case, Sweep
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB, TRANSMITTANCE
from multibody_xval.scenarios.verdicts.judge import Steps, metric_difference
from multibody_xval.scenarios.verdicts.proven import ROUNDED_DB, ProvenLevel, newly_proven, proven_level
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, EXACT, MOST_EXACT_CELLS, amplification
from reference_lcp.errors import ParameterError
from reference_lcp.steady.richardson import amplitude_in_db, unresolved_amplitude

WRONG_DB = 3.0
"""Error from which on a variant is wrong [dB]: the amplitude is off by the root of two, the power by two. That is the
half-power by which bands are commonly bounded, so that a band may end elsewhere."""

MOST_EXACT_POINTS = 500
"""Points beyond which none is computed exactly: one takes a tenth of a second, and these a minute of one processor."""

TRUTH_VARIABLES = {
    "truth_db": ("dB", "transmittance of the exact motion; of the converged reference where that is not known"),
    "truth_error_db": ("dB", "error bar of the truth"),
    "truth_exact": ("1", "1 where the truth is that of the exact motion"),
    "truth_proven": ("1", "1 where the truth is proven"),
}
"""Variables of a dataset that hold the truth, along the axes but for the variant: units and meaning."""


class ErrorClass(StrEnum):
    """How far a variant is from the truth."""

    WITHIN_STEP = "within the step's error"
    """Nowhere farther from the truth than the reference's scheme is with as many steps, and what nothing resolves."""
    VISIBLE = "visible"
    """Farther than that somewhere, and off by less than `WRONG_DB` everywhere."""
    WRONG = "wrong"
    """Off by `WRONG_DB` or more somewhere."""


def exact_tasks(tasks: Iterable[SteadyStateTask]) -> list[SteadyStateTask]:
    """Give the exact motions that are computed: none that is proven, of a long chain, or where they are too many."""
    unknown = [task for task in tasks if proven_level(task) is None]
    return [task for task in unknown if task.cells <= MOST_EXACT_CELLS] if len(unknown) <= MOST_EXACT_POINTS else []


def with_truths(result: ComparedSweep, evaluator: GivesResults | None = None, *, proof: bool = False) -> ComparedSweep:
    """Give the points of a sweep with the truth; where nothing gives exact results, the converged reference's.

    With `proof`, levels that the table does not have are proven now.
    """
    baselines = {point.place[1:]: point for point in result.points if point.variant == CONVERGED}
    tasks = {place: result.sweep.task(EXACT, *place) for place in baselines}
    known = {task: proven_level(task) or (newly_proven(task) if proof else None) for task in tasks.values()}
    computed = [task for task in exact_tasks(tasks.values()) if known[task] is None] if evaluator is not None else []
    exact = dict(zip(computed, evaluator.evaluate(computed), strict=True)) if evaluator is not None else {}
    return _with(
        result,
        {
            place: truth_of(baselines[place], exact.get(task, Result.missing()), known[task])
            for place, task in tasks.items()
        },
    )


def _with(result: ComparedSweep, truths: Mapping[tuple[Case, float], Truth]) -> ComparedSweep:
    points = [replace(point, truth=truths.get(point.place[1:], Truth())) for point in result.points]
    return replace(result, points=points)


def truth_of(point: Point, exact: Result, proven: ProvenLevel | None = None) -> Truth:
    """Give the truth at a point: what is proven, or the exact motion, or the converged reference.

    It is NaN where none of them is certified.
    """
    if proven is not None:
        return Truth(float(proven.transmittance_db), ROUNDED_DB, exact=True, proven=True)
    if exact.converged:
        steps = max(exact.periods, 1) * exact.steps_per_period
        left_open = unresolved_amplitude(exact.residual, amplification(point.reference), steps, exact.transmittance_db)
        level = max(exact.transmittance_db, FLOOR_DB)
        return Truth(exact.transmittance_db, amplitude_in_db(left_open, level), exact=True)
    if point.converged.converged:
        return Truth(point.converged.transmittance_db, Steps(scheme_by_steps(point)).error(TRANSMITTANCE))
    return Truth()


def truth_error(point: Point) -> tuple[float, float]:
    """Give how far a point is from the truth [dB], and how far the scheme is with as many steps; NaN where unknown.

    The error is on the scale of `TRANSMITTANCE`. With that of the scheme comes what neither the variant nor the truth
    resolves; it is NaN where the reference has no steady state.
    """
    truth = point.truth
    if math.isnan(truth.transmittance_db) or not point.is_known:
        return math.nan, math.nan
    error = metric_difference(TRANSMITTANCE, point.result.transmittance_db, truth.transmittance_db)
    resolution = point_resolution(point, TRANSMITTANCE, point.converged)
    values, steps = scheme_by_steps(point), point.reference.steps_per_period
    # measured, the truth being known
    scheme = Steps(values, steps, truth.transmittance_db).error(TRANSMITTANCE) if steps in values else math.nan
    return error, scheme + truth.error_db + resolution


def error_class(errors: pd.DataFrame) -> ErrorClass | None:
    """Give the class of a variant with these ``error_db`` and ``step_db``; ``None`` without any."""
    if errors.empty:
        return None
    size = errors["error_db"].abs()
    if (size >= WRONG_DB).any():
        return ErrorClass.WRONG
    return ErrorClass.WITHIN_STEP if (size <= errors["step_db"]).all() else ErrorClass.VISIBLE


def with_truth_variables(data: xr.Dataset, sweep: Sweep, result: ComparedSweep) -> xr.Dataset:
    """Add the truth to the dataset of a sweep, and ``error_db``: how far every variant is from it.

    `sweep` has all frequency ratios of the dataset; without a truth, nothing is added.
    """
    if not result.truths:
        return data
    sizes = [len(values) for values in sweep.axes.values()]
    unknown = Truth(exact=math.nan, proven=math.nan)  # type: ignore[arg-type]
    lines = np.array([list(vars(result.truths.get(place, unknown)).values()) for place in _places(sweep)], dtype=float)
    variables = {
        name: (tuple(sweep.axes), column.reshape(sizes), {"units": units, "long_name": text})
        for column, (name, (units, text)) in zip(lines.T, TRUTH_VARIABLES.items(), strict=True)
    }
    known = {point.place: truth_error(point)[0] for point in result.points}
    errors = [known.get(place, math.nan) for place in sweep.grid_points()]
    text = f"transmittance less the true one; of amplitudes below {FLOOR_DB:g} dB"
    own = (data["status"].dims, np.reshape(errors, data["status"].shape), {"units": "dB", "long_name": text})
    return data.assign(variables | {"error_db": own})


def _places(sweep: Sweep) -> list[tuple[Case, float]]:
    """Give the points of the grid of one variant, the last axis fastest."""
    return [(case, eta) for variant, case, eta in sweep.grid_points() if variant == sweep.variants[0]]


def with_recorded_truths(result: ComparedSweep, data: xr.Dataset, sweep: Sweep) -> ComparedSweep:
    """Give points with the truth that a dataset of this sweep holds, or with the converged reference's."""
    if not set(TRUTH_VARIABLES) & set(map(str, data.data_vars)):
        return with_truths(result)
    whole = data.expand_dims([name for name in sweep.axes if name not in data.dims])
    columns = [_column(whole, name, tuple(sweep.axes)) for name in TRUTH_VARIABLES]
    truths = {
        place: Truth(level, bar, exact=bool(exact), proven=bool(proven))
        for place, level, bar, exact, proven in zip(_places(sweep), *columns, strict=True)
        if not math.isnan(level)
    }
    return _with(result, truths) if truths else with_truths(result)


def _column(data: xr.Dataset, name: str, axes: tuple[str, ...]) -> list[float]:
    if name not in data or set(data[name].dims) != set(axes) or data[name].dtype.kind not in "fiu":
        raise ParameterError(
            f"{name} of the dataset is not there or no number; allowed: numbers along {', '.join(axes)}"
        )
    values: list[float] = data[name].transpose(*axes).values.astype(np.float64).ravel().tolist()
    return values
