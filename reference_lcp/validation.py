"""Checks of arguments: every message names the parameter, its value and the allowed range."""

import math
import operator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference_lcp.errors import ParameterError, shown

FloatArray = NDArray[np.float64]

LARGEST_NUMBER = 1e100
"""Largest size of any number: squares and products of three stay below the 1.8e308 of float64."""

LARGEST_PARAMETER = 1e12
"""Largest ratio: what is computed from several of them stays below `LARGEST_NUMBER`."""

LARGEST_UNIT = 1e24
"""Largest mass, stiffness and amplitude [kg, N/m, m, N] that ratios refer to: from molecules to planets."""

LARGEST_COUNT = 1_000_000_000
"""Largest whole number where nothing smaller is named: whatever is counted takes longer than anyone waits."""

MOST_CELLS = 100_000
"""Longest chain whose cost has been measured: 3 s for a period of the search, so 25 minutes for 400."""

MOST_STEPS = 1_000_000
"""Most steps a period: a thousandth of the error of 1,000 steps is below round-off in the steady state."""

MOST_CELL_STEPS = 100_000_000
"""Most cells times steps that one record holds: six numbers each, 5 GB."""

LONGEST_TIME_LIMIT = 1e6
"""Longest time limit [s], eleven days: timers of some systems count milliseconds in 31 bits, 24 days."""


def checked_array(
    name: str,
    value: ArrayLike,
    requirement: str = "finite",
    shape: tuple[int, ...] | None = None,
    largest: float = LARGEST_NUMBER,
) -> FloatArray:
    """Give `value` as a float64 array, or raise a `ParameterError` that begins with `name`.

    `requirement` is ``"> 0"``, ``">= 0"`` or ``"finite"``, which the others include; `shape` the only one allowed;
    `largest` the largest number where a sign is required, and its reciprocal the smallest one beside zero.
    """
    least = 1 / largest
    allowed = requirement if requirement == "finite" else f"{requirement}, {least:g} to {largest:g}"
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ParameterError(f"{name} = {shown(value)} is not a number; allowed: {allowed}") from None
    if requirement != "finite" or not math.isfinite(np.vdot(array, array)):  # that sum is fast
        fits = np.isfinite(array) if requirement == "finite" else (array >= least) & (array <= largest)
        fits |= (array == 0) & (requirement == ">= 0")
        if not np.all(fits):
            raise ParameterError(f"{name} = {array[~fits].flat[0]:g} is outside its range; allowed: {allowed}")
    if shape is not None and array.shape != shape:
        raise ParameterError(f"{name} has shape {array.shape}; allowed: {shape}")
    return array


def checked_scalar(name: str, value: float, requirement: str = "finite", largest: float = LARGEST_NUMBER) -> float:
    """Give one number as a float; as `checked_array`, but arrays are refused."""
    array = checked_array(name, value, requirement, largest=largest)
    if array.ndim != 0:
        raise ParameterError(f"{name} has shape {array.shape}; allowed: one number, {requirement}")
    return float(array)


def checked_count(name: str, value: int, minimum: int = 1, maximum: int = LARGEST_COUNT) -> int:
    """Give a whole number from `minimum` to `maximum`, or raise `ParameterError`."""
    try:
        count = operator.index(value)
    except TypeError:
        raise ParameterError(f"{name} = {shown(value)} is not a whole number; allowed: >= {minimum}") from None
    if isinstance(value, bool) or count < minimum:
        allowed = f"whole numbers >= {minimum}{'' if maximum == LARGEST_COUNT else f', up to {maximum}'}"
        raise ParameterError(f"{name} = {shown(value)} is outside its range; allowed: {allowed}")
    if count > maximum:
        raise ParameterError(f"{name} = {shown(value)} is outside its range; allowed: {minimum} to {maximum}")
    return count


def check_record_size(cells: int, steps: int) -> None:
    """Raise a `ParameterError` if the record of a motion would have more than `MOST_CELL_STEPS`."""
    if cells * steps > MOST_CELL_STEPS:
        problem = f"{cells} cells x {steps} steps are {cells * steps:.3g}"
        raise ParameterError(f"{problem}; allowed: cells times steps <= {MOST_CELL_STEPS:g}")
