"""How questions are answered, by kind; of steady states: build the chain, find the periodic orbit, read it."""

import math
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from engines.interface.variant import Variant
from reference_lcp.chain.simulation import Lane
from reference_lcp.observables.stick_slip import creep_velocity, largest_gap, open_fraction
from reference_lcp.steady.orbits import OrbitStatus, PeriodicOrbit, periodic_orbits
from reference_lcp.steady_state import SteadyState
from scenarios.execution.failures import answered_together
from scenarios.execution.transient import answer_motions
from scenarios.tasks.result import Result, ResultStatus
from scenarios.tasks.task import SteadyStateTask, Task
from scenarios.tasks.transient import TransientTask


def answer_batch(batch: Sequence[Task]) -> list[Result]:
    """Answer questions of one kind, to one variant, about chains of one length, in order.

    An engine that is not installed, or that fails on the batch, gives blocked answers with the
    reason; failures are results.
    """
    answered: list[Result] = _ANSWERING[type(batch[0])](batch)
    return answered


def answer_steady_states(questions: Sequence[SteadyStateTask]) -> list[Result]:
    """Answer questions for steady states; as `answer_batch`."""
    by_steps: dict[int, list[int]] = defaultdict(list)
    lanes = []
    for index, question in enumerate(questions):
        lane, steps = question.lane()
        by_steps[steps].append(index)
        lanes.append(lane)
    answers: dict[int, Result] = {}
    for steps, indices in by_steps.items():
        attempt = partial(_answer_lanes, questions[indices[0]].variant, steps=steps)
        found = answered_together([lanes[index] for index in indices], attempt)
        answers.update(zip(indices, found, strict=True))
    return [answers[index] for index in range(len(questions))]


def _answer_lanes(variant: Variant, lanes: Sequence[Lane], steps: int) -> list[Result]:
    """Answer lanes that share their number of steps a period, at once."""
    begin = time.perf_counter()
    orbits = _orbits(variant, lanes, steps)
    seconds = (time.perf_counter() - begin) / len(lanes)
    return [_answer(orbit, variant.preset.stick_margin, seconds) for orbit in orbits]


def _orbits(variant: Variant, lanes: Sequence[Lane], steps: int) -> list[PeriodicOrbit]:
    """Find the steady states of lanes, in the engine."""
    simulation = variant.build(lanes)
    try:
        return periodic_orbits(simulation, steps, tolerance=variant.capabilities.residual)
    finally:
        simulation.close()


def _answer(orbit: PeriodicOrbit, stick_margin: float, seconds: float) -> Result:
    """Read an orbit; one that has diverged has no numbers."""
    if not math.isfinite(orbit.residual):
        return Result.blocked(f"the engine's numbers are not finite, in period {orbit.periods} of the search")
    if orbit.status is OrbitStatus.DIVERGED:
        return Result(status=ResultStatus(orbit.status), periods=orbit.periods, seconds=seconds)
    found = SteadyState.of(orbit, stick_margin)
    drive: Any = orbit.lane.drive
    length = drive.displacement_scale(orbit.lane.chain)
    speed = drive.angular_frequency * length
    modulated = orbit.lane.preload is not None
    return Result(
        status=ResultStatus(orbit.status),
        transmittance_db=found.transmittance_db,
        residual=orbit.residual,
        periods=orbit.periods,
        multiple=orbit.multiple,
        steps_per_period=orbit.trajectory.steps,
        period=orbit.lane.time_step * orbit.trajectory.steps,
        stuck_fraction=tuple(found.stuck_fraction.tolist()),
        transitions=tuple((change.cell, change.time, str(change.kind)) for change in found.transitions),
        creep=tuple((creep_velocity(orbit, stick_margin) / speed).tolist()),
        open_fraction=tuple(open_fraction(orbit).tolist()) if modulated else (),
        largest_gap=tuple((largest_gap(orbit) / length).tolist()) if modulated else (),
        seconds=seconds,
    )


_ANSWERING: dict[type[Task], Callable[[Any], list[Result]]] = {
    SteadyStateTask: answer_steady_states,
    TransientTask: answer_motions,
}
