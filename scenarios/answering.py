"""How a question is answered: build the chain in the engine, find the periodic orbit, read it."""

import math
import time
from collections import defaultdict
from collections.abc import Sequence
from typing import Any

from engines.interface import EngineNotInstalled
from engines.variant import Variant
from reference_lcp.periodic import OrbitStatus, PeriodicOrbit, periodic_orbits
from reference_lcp.simulation import Lane
from reference_lcp.steady_state import SteadyState
from reference_lcp.stick_slip import air_fraction, creep_velocity, largest_gap
from reference_lcp.validation import ParameterError
from scenarios.questions import Answer, Question


def answer_batch(questions: Sequence[Question]) -> list[Answer]:
    """Answer questions to one variant about chains of one length, in order.

    An engine that is not installed, or that fails on the batch, gives blocked answers with the
    reason; failures are results.
    """
    by_steps: dict[int, list[int]] = defaultdict(list)
    lanes = []
    for index, question in enumerate(questions):
        lane, steps = question.lane()
        by_steps[steps].append(index)
        lanes.append(lane)
    answers: dict[int, Answer] = {}
    for steps, indices in by_steps.items():
        found = _answer_lanes(questions[indices[0]], [lanes[index] for index in indices], steps)
        answers.update(zip(indices, found, strict=True))
    return [answers[index] for index in range(len(questions))]


def _answer_lanes(asked: Question, lanes: list[Lane], steps: int) -> list[Answer]:
    """Answer lanes that share their number of steps a period; those of a failed batch again one by one."""
    begin = time.perf_counter()
    try:
        orbits = _orbits(asked.variant, lanes, steps)
    except EngineNotInstalled as problem:
        return [Answer.blocked(str(problem))] * len(lanes)
    except Exception as problem:
        if len(lanes) > 1:
            return [_answer_lanes(asked, [lane], steps)[0] for lane in lanes]
        kind = "cannot be represented" if isinstance(problem, ParameterError) else type(problem).__name__
        return [Answer.blocked(f"{kind}: {problem}")]
    seconds = (time.perf_counter() - begin) / len(lanes)
    return [_answer(orbit, asked.variant.options.stick_margin, seconds) for orbit in orbits]


def _orbits(variant: Variant, lanes: list[Lane], steps: int) -> list[PeriodicOrbit]:
    """Find the steady states of lanes, in the engine."""
    simulation = variant.build(lanes)
    try:
        return periodic_orbits(simulation, steps, tolerance=variant.capabilities.residual)
    finally:
        simulation.close()


def _answer(orbit: PeriodicOrbit, stick_margin: float, seconds: float) -> Answer:
    """Read an orbit; one that has diverged has no numbers."""
    if not math.isfinite(orbit.residual):
        return Answer.blocked(f"the engine's numbers are not finite, in period {orbit.periods} of the search")
    if orbit.status is OrbitStatus.DIVERGED:
        return Answer(status=str(orbit.status), periods=orbit.periods, seconds=seconds)
    found = SteadyState.of(orbit, stick_margin)
    drive: Any = orbit.lane.drive
    length = drive.displacement_scale(orbit.lane.chain)
    speed = drive.angular_frequency * length
    modulated = orbit.lane.preload is not None
    return Answer(
        status=str(orbit.status),
        transmittance_db=found.transmittance_db,
        residual=orbit.residual,
        periods=orbit.periods,
        multiple=orbit.multiple,
        steps_per_period=orbit.trajectory.steps,
        period=orbit.lane.time_step * orbit.trajectory.steps,
        stuck_fraction=tuple(found.stuck_fraction.tolist()),
        transitions=tuple((change.cell, change.time, str(change.kind)) for change in found.transitions),
        creep=tuple((creep_velocity(orbit, stick_margin) / speed).tolist()),
        air_fraction=tuple(air_fraction(orbit).tolist()) if modulated else (),
        largest_gap=tuple((largest_gap(orbit) / length).tolist()) if modulated else (),
        seconds=seconds,
    )
