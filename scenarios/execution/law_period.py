"""How an engine is compared with its law: both are advanced by one period from the same state."""

import time
from collections.abc import Sequence

import numpy as np

from engines.interface.law_engine import law_of
from engines.interface.registry import engine
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from scenarios.execution.checked_simulation import CheckedSimulation
from scenarios.execution.failures import results_together
from scenarios.tasks.law_period import APPROACH_PERIODS, LawPeriodTask
from scenarios.tasks.result import Result, ResultStatus


def run_law_periods(tasks: Sequence[LawPeriodTask]) -> list[Result]:
    """Compare a period of one variant with its law's, in order; tasks without a law are blocked."""
    return results_together(tasks, _results)


def _results(tasks: Sequence[LawPeriodTask]) -> list[Result]:
    """Compare one by one: their steps a period may differ."""
    return [_result(task) for task in tasks]


def _result(task: LawPeriodTask) -> Result:
    begin = time.perf_counter()
    law = law_of(task.variant.preset)
    if law is None:
        return Result.blocked(f"{task.variant} has no law that is a model")
    lane, steps = task.lane()
    reason = law.unmodelled_reason(lane)
    if reason is not None:
        return Result.blocked(f"{task.variant}: {reason}")
    model = law.build([lane])
    state = model.advance(State.at_rest(1, lane.chain.cells), 0, APPROACH_PERIODS * steps)
    runs = [_period(simulation, state, steps) for simulation in _simulations(task, lane, model)]
    scale = lane.drive.displacement_scale(lane.chain)
    distances = [np.max(np.abs(runs[0].positions - run.positions)) / scale for run in runs[1:]]
    return Result(
        status=ResultStatus.FINISHED,
        series={"distance": (float(distances[0]),), "reference": (float(distances[1]),)},
        steps_per_period=steps,
        seconds=time.perf_counter() - begin,
    )


def _simulations(task: LawPeriodTask, lane: Lane, model: Simulation) -> list[Simulation]:
    """Give engine, law and reference."""
    return [CheckedSimulation(task.variant.build([lane])), model, engine("reference").build([lane])]


def _period(simulation: Simulation, state: State, steps: int) -> Trajectory:
    """Advance by a period from a whole number of them; the reference has no internal state."""
    try:
        return simulation.run(state, 0, steps)[0]
    finally:
        simulation.close()
