"""``python -m multibody_xval.scenarios.truth.record`` writes the exact motions of the problems into their files anew.

Motions are those of `EventDrivenSystem`, without a time step, from what a file builds to the times it names. Numbers
are rounded to their uncertainty.
"""

import json
import math
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np

from multibody_xval.scenarios.truth.problem import Problem, problems, text_of
from reference_lcp.exact.event_driven_system import EventDrivenSystem
from reference_lcp.lcp.systems import simulate_system
from reference_lcp.validation import FloatArray

FOLDER = Path(__file__).parent

UNCERTAINTY = 1e-11
"""Of a motion from event to event, over its largest number: ten times what another order of its sums changes."""

SMALLEST = 1e-13
"""Uncertainty of what hardly moves [m] or [m/s]: motions here are millimetres to metres."""

MARGIN = 2.0
"""What a scheme of first order may be off, over the error of the symplectic Euler scheme: constants differ."""

SINGLE = float(np.finfo(np.float32).eps)
"""Rounding of engines in single precision: what stands still may creep by that of a step, and no more."""


def recorded(problem: Problem) -> Problem:
    """Give a problem with its exact motion at its times, the uncertainty of that, and what a step may be off."""
    system, h = problem.system, problem.time_step
    steps = np.rint(np.array(problem.times) / h).astype(int)
    state: dict[str, Any] = {"position": problem.start_position, "velocity": problem.start_velocity}
    every = h * np.arange(1, max(steps) + 2)
    exact = EventDrivenSystem(system).motion(**state, times=every)
    scheme = simulate_system(system, **state, time_step=h, steps=int(max(steps)))
    rows, speed = steps - 1, _rounding(problem)
    at_rest = {"velocity": speed, "position": speed * float(every[rows[-1]])}
    data: dict[str, Any] = {}
    for name in ("position", "velocity"):
        many = "positions" if name == "position" else "velocities"
        values, own = getattr(exact, many), getattr(scheme, many)
        uncertainty = _rounded_up(max(UNCERTAINTY * float(np.max(np.abs(values))), SMALLEST))
        late = np.max(np.abs(values[rows + 1] - values[rows]), axis=0)
        error = MARGIN * np.maximum(np.max(np.abs(own[rows] - values[rows]), axis=0), late)
        digits = 1 - math.floor(math.log10(uncertainty))
        data[many] = [[_rounded(value, digits) for value in row] for row in values[rows].tolist()]
        data[f"{name}_uncertainty"] = uncertainty
        data[f"{name}_error"] = [_rounded_up(each) for each in np.maximum(error, at_rest[name]).tolist()]
    return problem.model_copy(update=data)


def _rounding(problem: Problem) -> FloatArray:
    """Give the velocity [m/s] with which what is at rest moves by the rounding of single precision, body by body."""
    largest = np.zeros(len(problem.masses) + 1)
    for first, second, normal, static in zip(
        problem.contact_first, problem.contact_second, problem.contact_normal_force, problem.contact_static, strict=True
    ):
        largest[[first, second]] = np.maximum(largest[[first, second]], static * normal)
    return MARGIN * SINGLE * problem.time_step * largest[:-1] / np.array(problem.masses)


def _rounded(value: float, digits: int) -> float:
    """Round to so many decimals, without a negative zero."""
    return round(value, digits) + 0.0


def _rounded_up(value: float) -> float:
    """Round up to two digits."""
    if value == 0:
        return 0.0
    exponent = math.floor(math.log10(value)) - 1
    return float(Decimal(math.ceil(value / 10.0**exponent)).scaleb(exponent))


def main() -> None:
    """Write all files."""
    for name, problem in problems().items():
        (FOLDER / "problems" / f"{name}.json").write_text(text_of(recorded(problem)), encoding="utf-8")
    schema = json.dumps(Problem.model_json_schema(), indent=1, ensure_ascii=False)
    (FOLDER / "problem.schema.json").write_text(schema + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
