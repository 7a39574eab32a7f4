"""A motion that any program wrote, beside the exact one of a problem."""

import csv
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from multibody_xval.engines.interface.texts import checked_path
from multibody_xval.scenarios.truth.problem import Problem
from reference_lcp.errors import ParameterError, shown
from reference_lcp.validation import FloatArray, checked_scalar

SAME_TIME = 1e-3
"""Part of a step by which a row may be beside its time: what moves by it is far below what a step may be off."""

LARGEST_FILE = 100_000_000
"""Bytes of a motion's file that are read; the longest of the problems takes ten, with every step."""

STATES = ("held", "slid", "stuck", "–")
"""What a body does: never slips, slides in the end, has stopped by then; the last one has no contact of its own."""

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


def read_motion(path: str | os.PathLike[str], problem: Problem) -> Motion:
    """Read the rows of a problem's motion from a CSV file with columns ``time, x0, x1, …`` and perhaps ``v0, v1, …``.

    Raises
    ------
    ParameterError
        If the file is not there or too large, columns are missing, a value is no finite number, or times do not rise.
    """
    file = checked_path("motion", path)
    if not file.is_file():
        raise ParameterError(f"motion = {shown(str(path))} is no file; allowed: a CSV file")
    if file.stat().st_size > LARGEST_FILE:
        raise ParameterError(f"motion = {shown(str(path))} is too large; allowed: at most {LARGEST_FILE} bytes")
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


def judged(problem: Problem, motion: Motion, time_step: float | None = None) -> pd.DataFrame:
    """Compare a motion with the exact one: one row a body.

    Columns: ``body``; ``exact`` and ``motion``, what it does, one of `STATES`; ``position_off`` [m], how far it is from
    the exact motion where that is most beside what is ``position_allowed``, and ``position_time`` [s] of that; the same
    of velocities, NaN where the motion has none; ``verdict``: agrees or deviates.

    Parameters
    ----------
    problem, motion
        The exact motion, and the rows of a program.
    time_step
        Step of the program [s], no longer than the problem; without it, that of the problem. Allowed errors are in
        proportion to it.

    Raises
    ------
    ParameterError
        If a time of the problem has no row, the step is outside its range, or the numbers are of other units.
    """
    step = checked_scalar("time_step", problem.time_step if time_step is None else time_step, "> 0")
    if step > max(problem.times):
        raise ParameterError(f"time_step = {step:g} is outside its range; allowed: > 0, at most {max(problem.times):g}")
    rows = _rows(problem, motion, step)
    own = motion.positions[rows], None if motion.velocities is None else motion.velocities[rows]
    exact = np.array(problem.positions), np.array(problem.velocities)
    _check_units(own[0], exact[0], problem)
    allowed = [
        np.array(error) * (step / problem.time_step) + uncertainty
        for error, uncertainty in (
            (problem.position_error, problem.position_uncertainty),
            (problem.velocity_error, problem.velocity_uncertainty),
        )
    ]
    table = pd.DataFrame({"body": range(len(problem.masses))})
    table["exact"] = states(problem, *exact, [problem.position_uncertainty, problem.velocity_uncertainty])
    table["motion"] = states(problem, *own, allowed)
    for name, values, known, bound in zip(("position", "velocity"), own, exact, allowed, strict=True):
        off = np.full(known.shape, np.nan) if values is None else np.abs(values - known)
        worst = np.argmax(off, axis=0)
        table[f"{name}_off"], table[f"{name}_allowed"] = off[worst, table.body], bound
        table[f"{name}_time"] = np.array(problem.times)[worst]
    beyond = (table.position_off > table.position_allowed) | (table.velocity_off > table.velocity_allowed)
    return table.assign(verdict=np.where(beyond, "deviates", "agrees"))


def states(problem: Problem, positions: FloatArray, velocities: FloatArray | None, allowed: Sequence[Any]) -> list[str]:
    """Say of every body whether its own contact held all the time, slides in the end, or stuck again by then.

    What moves by less than is allowed of both bodies of a contact does not slip. Without velocities, those from the
    last but one of the compared times to the last are taken.
    """
    found = [STATES[-1]] * len(problem.masses)
    limits = [np.append(np.broadcast_to(each, len(problem.masses)), 0.0) for each in allowed]  # the ground is the last
    start, times = np.append(problem.start_position, 0.0), problem.times
    places = np.column_stack([positions, np.zeros(len(positions))])
    speeds = np.append(
        (positions[-1] - positions[-2]) / (times[-1] - times[-2]) if velocities is None else velocities[-1], 0.0
    )
    for first, second in zip(problem.contact_first, problem.contact_second, strict=True):
        slips = places[:, first] - places[:, second] - (start[first] - start[second])
        moved = bool(np.any(np.abs(slips) > limits[0][first] + limits[0][second]))
        slides = bool(abs(speeds[first] - speeds[second]) > limits[1][first] + limits[1][second])
        found[first] = STATES[1] if slides else STATES[2] if moved else STATES[0]
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
