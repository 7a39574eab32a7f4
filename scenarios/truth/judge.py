"""A motion that any program wrote, beside the exact one of a problem."""

import csv
import math
import os
from dataclasses import dataclass

import numpy as np

from multibody_xval.scenarios.truth.problem import Problem
from reference_lcp.errors import ParameterError, checked_path, shown
from reference_lcp.validation import FloatArray, checked_scalar

SAME_TIME = 1e-3
"""Part of a step by which a row may be beside its time: what moves by it is far below what a step may be off."""

LARGEST_FILE = 100_000_000
"""Bytes of a motion's file that are read; the longest of the problems takes ten, with every step."""

OTHER_UNITS = {1e3: "mm", 1e2: "cm", 1e-3: "km"}
"""Factors by which all positions are beside the exact ones if they are in other units, see `_check_units`."""


@dataclass(frozen=True)
class Motion:
    """Rows of a motion."""

    times: FloatArray
    """[s], rising, shape (rows,)."""
    positions: FloatArray
    """[m], shape (rows, bodies)."""
    velocities: FloatArray | None
    """[m/s], likewise; ``None`` if the file has none."""


@dataclass(frozen=True)
class Judgement:
    """How far one quantity of one body is from the exact motion, where it is nearest to what it may be, or beyond."""

    quantity: str
    """``position`` [m] or ``velocity`` [m/s]."""
    body: int
    time: float
    """[s]."""
    error: float
    """Distance from the exact motion."""
    allowed: float
    """What a scheme of first order may be off with this step, and the uncertainty."""

    @property
    def passes(self) -> bool:
        """Whether the error is no larger than allowed."""
        return self.error <= self.allowed


def read_motion(path: str | os.PathLike[str], problem: Problem) -> Motion:
    """Read the rows of a problem's motion from a CSV file with columns ``time, x0, x1, …`` and perhaps ``v0, v1, …``.

    Raises
    ------
    ParameterError
        If the file is not there or too large, columns are missing, a value is no finite number, or times do not rise.
    """
    file = checked_path("motion", path)
    if not file.is_file() or file.stat().st_size > LARGEST_FILE:
        raise ParameterError(f"motion = {shown(str(path))} is no file of at most {LARGEST_FILE} bytes; allowed: a CSV")
    with file.open(newline="", encoding="utf-8", errors="replace") as lines:
        header, *rows = list(csv.reader(lines)) or [[]]
    names = [name.strip() for name in header]
    axes = [[f"{letter}{body}" for body in range(len(problem.masses))] for letter in "xv"]
    wanted = ["time", *axes[0], *(axes[1] if set(axes[1]) & set(names) else [])]
    missing = [name for name in wanted if name not in names]
    if missing:
        raise ParameterError(
            f"columns of {file} = {shown(', '.join(names))} lack {missing[0]}; allowed: {shown(', '.join(wanted))}"
        )
    places = [names.index(name) for name in wanted]
    values = np.array([_numbers(row, places, number, file.name) for number, row in enumerate(rows, 2) if row])
    values = values.reshape(-1, len(wanted))
    times, last = values[:, 0], 1 + len(axes[0])
    if times.size < 2 or np.any(np.diff(times) <= 0):
        raise ParameterError(f"times of {file}: {times.size} that do not rise; allowed: two or more rising times [s]")
    return Motion(times, values[:, 1:last], values[:, last:] if len(wanted) > last else None)


def _numbers(row: list[str], places: list[int], number: int, name: str) -> list[float]:
    try:
        values = [float(row[place]) for place in places]
    except (ValueError, IndexError):
        values = [math.nan]
    if not all(map(math.isfinite, values)):
        raise ParameterError(f"line {number} of {name} = {shown(','.join(row))}; allowed: a finite number a column")
    return values


def judged(problem: Problem, motion: Motion, time_step: float | None = None) -> list[Judgement]:
    """Compare a motion with the exact one: one judgement of positions, and one of velocities if there are any.

    Parameters
    ----------
    problem, motion
        The truth, and the rows of a program.
    time_step
        Step of the program [s]; without it, that of the problem. Allowed errors are in proportion to it.

    Raises
    ------
    ParameterError
        If a time of the problem has no row, or the numbers are of other units.
    """
    step = checked_scalar("time_step", problem.time_step if time_step is None else time_step, "> 0")
    _check_units(motion.positions[_rows(problem, motion, step)], np.array(problem.positions), problem)
    bounds = {
        "position": np.array(problem.position_error) * (step / problem.time_step) + problem.position_uncertainty,
        "velocity": np.array(problem.velocity_error) * (step / problem.time_step) + problem.velocity_uncertainty,
    }
    judgements = []
    for quantity, distance in distances(problem, motion, step).items():
        allowed = bounds[quantity]
        row, body = np.unravel_index(np.argmax(distance / allowed), distance.shape)
        worst = float(distance[row, body]), float(allowed[body])
        judgements.append(Judgement(quantity, int(body), problem.times[int(row)], *worst))
    return judgements


def distances(problem: Problem, motion: Motion, time_step: float) -> dict[str, FloatArray]:
    """Give how far a motion is from the exact one, shape (times, bodies), by quantity: of those that it has.

    Raises
    ------
    ParameterError
        If a time of the problem has no row, to a part of the `time_step` [s].
    """
    rows = _rows(problem, motion, time_step)
    found = {"position": np.abs(motion.positions[rows] - np.array(problem.positions))}
    if motion.velocities is not None:
        found["velocity"] = np.abs(motion.velocities[rows] - np.array(problem.velocities))
    return found


def _rows(problem: Problem, motion: Motion, step: float) -> list[int]:
    """Give the row of every time of the problem."""
    rows = [int(np.argmin(np.abs(motion.times - time))) for time in problem.times]
    for row, time in zip(rows, problem.times, strict=True):
        if abs(motion.times[row] - time) > SAME_TIME * step:
            raise ParameterError(
                f"the motion has no row at {time:.9g} s, but {motion.times.size} from {motion.times[0]:g} to "
                f"{motion.times[-1]:g} s; allowed: one at each of the problem's {len(problem.times)} times"
            )
    return rows


def _check_units(own: FloatArray, exact: FloatArray, problem: Problem) -> None:
    """Raise a `ParameterError` if positions fit in all but their unit."""
    size = float(np.max(np.abs(exact)))
    for factor, unit in OTHER_UNITS.items():
        if size > problem.position_uncertainty and np.max(np.abs(own / factor - exact)) <= 0.2 * size:
            raise ParameterError(f"positions are {factor:g} times the exact ones, as if in {unit}; allowed: m")
