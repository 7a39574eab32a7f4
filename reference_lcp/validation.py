"""Checks of arguments: every message names the parameter, its value and the allowed range."""

import operator
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]


class ParameterError(ValueError):
    """A parameter outside its allowed range; the message is one line."""


class RunError(RuntimeError):
    """A run cannot go on, and what it has computed so far is kept; the message is one line."""


_REQUIREMENTS: dict[str, Callable[[FloatArray], NDArray[np.bool_]]] = {
    "> 0": lambda values: values > 0,
    ">= 0": lambda values: values >= 0,
    "finite": np.isfinite,
}


def checked_array(
    name: str, value: ArrayLike, requirement: str = "finite", shape: tuple[int, ...] | None = None
) -> FloatArray:
    """Give `value` as a float64 array, or say what is wrong with it.

    Parameters
    ----------
    name
        The parameter as its user knows it; it opens the message.
    value
        A number or an array of numbers.
    requirement
        ``"> 0"``, ``">= 0"`` or ``"finite"``; the first two include finite.
    shape
        The only one allowed; any without it.

    Raises
    ------
    ParameterError
        If `value` is not numeric, not finite, breaks the requirement, or has another shape.
    """
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ParameterError(f"{name} = {value!r} is not a number; allowed: {requirement}") from None
    fulfilled = np.isfinite(array) & _REQUIREMENTS[requirement](array)
    if not np.all(fulfilled):
        wrong = array[~fulfilled].flat[0]
        raise ParameterError(f"{name} = {wrong:g} is outside its range; allowed: {requirement}, finite")
    if shape is not None and array.shape != shape:
        raise ParameterError(f"{name} has shape {array.shape}; allowed: {shape}")
    return array


def checked_per_cell(name: str, value: ArrayLike, cells: int, requirement: str = "finite") -> FloatArray:
    """Give one number a cell, read-only, of a number or an array of them; as `checked_array`."""
    array = checked_array(name, value, requirement)
    if array.shape not in ((), (1,), (cells,)):
        raise ParameterError(f"{name} has shape {array.shape}; allowed: one number or ({cells},)")
    per_cell = np.broadcast_to(array, (cells,)).copy()
    per_cell.flags.writeable = False
    return per_cell


def checked_scalar(name: str, value: float, requirement: str = "finite") -> float:
    """Give one number as a float; as `checked_array`, but arrays are refused."""
    array = checked_array(name, value, requirement)
    if array.ndim != 0:
        raise ParameterError(f"{name} has shape {array.shape}; allowed: one number, {requirement}")
    return float(array)


def checked_count(name: str, value: int, minimum: int = 1) -> int:
    """Give a whole number of at least `minimum`, or raise `ParameterError`."""
    try:
        count = operator.index(value)
    except TypeError:
        raise ParameterError(f"{name} = {value!r} is not a whole number; allowed: >= {minimum}") from None
    if isinstance(value, bool) or count < minimum:
        raise ParameterError(f"{name} = {value} is outside its range; allowed: whole numbers >= {minimum}")
    return count


def checked_choice(name: str, value: str, allowed: Sequence[str]) -> str:
    """Give `value` if it is one of `allowed`, or raise `ParameterError` with the choices."""
    if value not in allowed:
        raise ParameterError(f"{name} = {value!r} is unknown; allowed: {', '.join(allowed)}")
    return value
