"""What the dataset of a sweep must have, so that results can be read out of it."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from reference_lcp.refusal import ParameterError
from scenarios.sweeps.dataset import MODES, PREDICTED, STATUSES, VERDICTS
from scenarios.tasks.validation_message import first_error

LARGEST_COUNT = 2.0**53
"""Whole numbers that a float holds."""

ROUND_OFF = 1e-9
"""Of fractions that are sums of durations."""

NUMBERS = ("transmittance_db", "phase", "residual", "amplification", "period", "creep", "seconds")
LAW_NUMBERS = (
    *(f"law_{name}_{ending}" for _, ending, _ in PREDICTED for name in ("value", "left", "allowed")),
    "law_distance", "law_period_bound", "law_certified",
)  # fmt: skip
COUNTS = ("periods", "multiple", "steps_per_period")
TRANSITION = ("transition_cell", "transition_time", "transition_mode")
REFINED = ("refined_transmittance_db", "refined_phase", "refined_steps_per_period")


class _Option(BaseModel):
    """An option that a preset sets."""

    model_config = ConfigDict(extra="forbid")
    name: str
    value: Any
    default: Any
    reason: str


class _Description(BaseModel):
    """What `scenarios.sweeps.dataset.description_of` gives."""

    model_config = ConfigDict(extra="forbid")
    package: str
    version: str | None
    description: str
    options: list[_Option]


_DESCRIPTIONS = TypeAdapter(dict[str, _Description])


def check_dataset(data: xr.Dataset, grid: Sequence[str]) -> None:
    """Refuse a dataset that lacks a variable, or has one with other dimensions, types or values.

    Parameters
    ----------
    data
        Of a sweep, with all its dimensions.
    grid
        Its dimensions: ``variant`` and the axes.

    Raises
    ------
    ParameterError
        Names the variable, and what is allowed.
    """
    _check(data, "status", grid, (), (0, len(STATUSES) - 1))
    _check(data, "verdict", grid, (), (-1, len(VERDICTS) - 1))
    for name in (*NUMBERS, *LAW_NUMBERS):
        _check(data, name, grid, ())
    for name in COUNTS:
        _check(data, name, grid, (), (0, LARGEST_COUNT), missing=True)
    _check(data, "stuck_fraction", grid, ("cell",), (0, 1 + ROUND_OFF), missing=True)
    for name, largest in zip(TRANSITION, (LARGEST_COUNT, np.inf, len(MODES) - 1), strict=True):
        _check(data, name, grid, ("transition",), (0, largest), missing=True)
    if "refinement" in data.dims:
        _check(data, "refinement", (), ("refinement",), (0, np.inf))
        for name in REFINED:
            _check(data, name, grid, ("refinement",))
        _check(data, REFINED[-1], grid, ("refinement",), (0, LARGEST_COUNT), missing=True)
    if set(_array(data, "reason").dims) != set(grid):
        raise ParameterError(f"reason has the dimensions {data['reason'].dims}; allowed: {', '.join(grid)}")
    _check_ends(data)


def recorded_variants(data: xr.Dataset) -> dict[str, Any]:
    """Give package, version, description and options of each variant, as they were noted with the numbers.

    Raises
    ------
    ParameterError
        If they are not there, or something else is.
    """
    try:
        read = _DESCRIPTIONS.validate_json(data.attrs["variants"])
    except KeyError:
        raise ParameterError("the dataset has no attribute 'variants'; allowed: the dataset of a sweep") from None
    except ValidationError as problem:
        known = ", ".join(_Description.model_fields)
        raise ParameterError(f"variants of the dataset: {first_error(problem, known)}") from None
    return json.loads(_DESCRIPTIONS.dump_json(read))


def _array(data: xr.Dataset, name: str) -> xr.DataArray:
    """Give a variable."""
    if name not in data.variables:
        raise ParameterError(f"the dataset has no variable {name!r}; allowed: all those of a sweep")
    return data[name]


def _check(
    data: xr.Dataset,
    name: str,
    grid: Sequence[str],
    more: Sequence[str],
    allowed: tuple[float, float] | None = None,
    *,
    missing: bool = False,
) -> None:
    """Refuse a variable with other dimensions, without numbers, or with numbers outside a range; NaN if missing."""
    array = _array(data, name)
    if set(array.dims) != {*grid, *more} or array.dtype.kind not in "fiu":
        problem = f"{name} has the dimensions {array.dims} and the type {array.dtype}"
        raise ParameterError(f"{problem}; allowed: numbers along {', '.join((*grid, *more))}")
    if allowed is None:
        return
    values = array.values.astype(np.float64)
    inside = (values >= allowed[0]) & (values <= allowed[1])
    if not np.all(inside | np.isnan(values) if missing else inside):
        wrong = values[~(inside | np.isnan(values) if missing else inside)].flat[0]
        suffix = ", or NaN" if missing else ""
        raise ParameterError(f"{name} = {wrong:g} in the dataset; allowed: {allowed[0]:g} to {allowed[1]:g}{suffix}")


def _check_ends(data: xr.Dataset) -> None:
    """Refuse changes of mode of which a part is missing."""
    missing = [np.isnan(data[name].transpose(..., "transition").values.astype(np.float64)) for name in TRANSITION]
    if not all(np.array_equal(missing[0], other) for other in missing[1:]):
        raise ParameterError(f"{', '.join(TRANSITION)} are not equally many in the dataset; allowed: all of each")
