"""``python -m multibody_xval.scenarios.truth.record`` writes the problems' files, with their exact motions.

Motions are those of `EventDrivenSystem`, without a time step; transmittances, phases and transitions of steady states
are proven in ball arithmetic. Numbers of a file are rounded to its uncertainty.
"""

import json
import math
from collections.abc import Sequence
from decimal import Decimal
from pathlib import Path

import numpy as np

from multibody_xval.scenarios.truth.drafts import Data, Draft, drafts
from multibody_xval.scenarios.truth.problem import FORMAT, Problem, text_of
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


def completed(draft: Draft) -> Problem:
    """Give the problem with its exact motion, and what a step may be off."""
    lists = [name for name in Problem.model_fields if name.startswith(("spring_", "force_"))]
    lists += ["transitions", "positions", "velocities", "position_error", "velocity_error"]
    empty: Data = {"base_amplitude": 0.0, "observables": {}, **{name: [] for name in lists}}
    times = [draft.data["time_step"] * count for count in draft.steps]
    later = {"times": times, "position_uncertainty": 1.0, "velocity_uncertainty": 1.0}
    problem = Problem.model_validate({"format": FORMAT, **empty, **draft.data, **later})
    return problem.model_copy(update=_motion(problem, draft.steps))


def _motion(problem: Problem, steps: Sequence[int]) -> Data:
    """Give the exact motion at the times of a problem, its uncertainty, and the errors of a scheme of first order."""
    system, h = problem.system, problem.time_step
    state: Data = {"position": problem.start_position, "velocity": problem.start_velocity}
    every = h * np.arange(1, max(steps) + 2)
    exact = EventDrivenSystem(system).motion(**state, times=every)
    scheme = simulate_system(system, **state, time_step=h, steps=max(steps))
    rows, speed = np.array(steps) - 1, _rounding(problem)
    at_rest = {"velocity": speed, "position": speed * float(every[rows[-1]])}
    data: Data = {}
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
    return data


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
    for draft in drafts():
        problem = completed(draft)
        (FOLDER / "problems" / f"{problem.name}.json").write_text(text_of(problem), encoding="utf-8")
    schema = json.dumps(Problem.model_json_schema(), indent=1, ensure_ascii=False)
    (FOLDER / "problem.schema.json").write_text(schema + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
