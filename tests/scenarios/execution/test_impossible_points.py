"""A point that cannot be built is blocked with its reason; the points beside it are computed."""

from engines.interface.variant import Variant
from scenarios.execution.computation.steady import run_steady_states
from scenarios.tasks.task import SteadyStateTask


def test_point_that_needs_too_many_steps_is_blocked_and_its_neighbours_are_computed() -> None:
    tasks = [
        SteadyStateTask(variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=eta)
        for eta in (0.9, 1e-9, 1.3)
    ]
    before, impossible, after = run_steady_states(tasks)
    assert before.converged
    assert after.converged
    assert impossible.status == "blocked"
    assert "steps; allowed: ratios that need <= 1000000" in impossible.reason
