"""How a question is answered: build the chain in the engine, find the periodic orbit, read it."""

import time
from collections import defaultdict
from collections.abc import Sequence

from engines.interface import EngineNotInstalled
from engines.registry import engine
from reference_lcp.periodic import OrbitStatus, PeriodicOrbit, periodic_orbits
from reference_lcp.simulation import Lane, steps_per_period_for
from reference_lcp.steady_state import SteadyState
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
        chain, drive = question.setting()
        steps = steps_per_period_for(chain, drive, question.steps_per_period)
        by_steps[steps].append(index)
        lanes.append(Lane.periodic(chain, drive, steps))
    answers: dict[int, Answer] = {}
    for steps, indices in by_steps.items():
        found = _answer_lanes(questions[indices[0]], [lanes[index] for index in indices], steps)
        answers.update(zip(indices, found, strict=True))
    return [answers[index] for index in range(len(questions))]


def _answer_lanes(asked: Question, lanes: list[Lane], steps: int) -> list[Answer]:
    """Answer lanes that share their number of steps a period; those of a failed batch again one by one."""
    variant = asked.variant
    begin = time.perf_counter()
    try:
        asked_engine = engine(variant.engine)
        simulation = asked_engine.build(lanes, variant.formulation, variant.preset)
        try:
            orbits = periodic_orbits(simulation, steps, tolerance=asked_engine.capabilities.residual)
        finally:
            simulation.close()
    except EngineNotInstalled as problem:
        return [Answer.blocked(str(problem))] * len(lanes)
    except ParameterError as problem:
        return [Answer.blocked(f"cannot be represented: {problem}")] * len(lanes)
    except Exception as problem:
        return [Answer.blocked(f"{type(problem).__name__}: {problem}")] * len(lanes)
    seconds = (time.perf_counter() - begin) / len(lanes)
    return [_answer(orbit, seconds) for orbit in orbits]


def _answer(orbit: PeriodicOrbit, seconds: float) -> Answer:
    """Read an orbit; one that has diverged has no numbers."""
    if orbit.status is OrbitStatus.DIVERGED:
        return Answer(status=str(orbit.status), periods=orbit.periods, seconds=seconds)
    found = SteadyState.of(orbit)
    return Answer(
        status=str(orbit.status),
        transmittance_db=found.transmittance_db,
        residual=orbit.residual,
        periods=orbit.periods,
        steps_per_period=orbit.trajectory.steps,
        period=orbit.lane.time_step * orbit.trajectory.steps,
        stuck_fraction=tuple(found.stuck_fraction.tolist()),
        transitions=tuple((change.cell, change.time, str(change.kind)) for change in found.transitions),
        seconds=seconds,
    )
