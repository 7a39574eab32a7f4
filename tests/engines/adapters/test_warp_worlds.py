"""Engines on Warp: what only their graphs, their worlds and their single precision do."""

import numpy as np
import pytest

from engines.interface.registry import engine
from engines.interface.tolerances import SINGLE
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUNDINGS,
    STEPS,
    assert_same_bits,
    distance,
    lane_of,
    lanes_of_all_kinds,
    random_state,
    uneven_lane,
    unstable_lane,
)

ENGINES = [pytest.param(name, marks=pytest.mark.needs(name)) for name in ("newton", "mujoco-warp")]

both_engines = pytest.mark.parametrize("name", ENGINES)
both_formulations = pytest.mark.parametrize("formulation", ["joint", "contact"])
both_presets = pytest.mark.parametrize("preset", ["tuned", "default"])


@both_engines
@both_formulations
@both_presets
def test_the_graph_of_a_step_computes_what_its_kernels_compute_one_by_one(name, formulation, preset) -> None:
    """A graph leaves Python out, and nothing else."""
    simulation = engine(name).build([lane_of(), uneven_lane()], formulation, preset)
    recorded = simulation.run(random_state(2), 0, 50)
    # Newton's lanes in SI units are each alone
    alone = [model._simulation for model in getattr(simulation, "models", [])]
    for each in alone or [simulation]:
        each._worlds.launch = each._worlds.eager_step
    for graph, eager in zip(recorded, simulation.run(random_state(2), 0, 50), strict=True):
        assert_same_bits(graph, eager)


@both_engines
@both_formulations
@both_presets
def test_worlds_of_other_time_steps_and_chains_move_as_each_alone(name, formulation, preset) -> None:
    """More steps than are recorded at once, too."""
    lanes, states = lanes_of_all_kinds(), random_state(6)
    together = engine(name).build(lanes, formulation, preset).run(states, 7, 200)
    for index, lane in enumerate(lanes):
        alone = engine(name).build([lane], formulation, preset).run(states.subset([index]), 7, 200)[0]
        assert_same_bits(alone, together[index])


@both_engines
@both_formulations
def test_worlds_of_other_time_steps_and_chains_equal_the_scheme_to_single_precision(name, formulation) -> None:
    lanes, states = lanes_of_all_kinds(), random_state(6)
    for index, motion in enumerate(engine(name).build(lanes, formulation).run(states, 0, STEPS)):
        apart = distance(lanes[index], states.subset([index]), motion)
        # more than single precision cannot be: a finer result would be another engine's
        assert SINGLE / 10 < apart < ROUNDINGS, f"lane {index} is off by {apart:.1g}"


@both_engines
@both_formulations
@both_presets
def test_a_diverged_world_stays_finite_and_leaves_the_others_and_later_runs_alone(name, formulation, preset) -> None:
    simulation = engine(name).build([unstable_lane(), lane_of()], formulation, preset)
    before = simulation.run(random_state(2), 0, 30)
    diverged, calm = simulation.run(random_state(2), 0, 1000)
    assert np.max(np.abs(diverged.positions)) > 1e6 * AMPLITUDE
    assert np.all(np.isfinite(diverged.positions))
    alone = engine(name).build([lane_of()], formulation, preset).run(random_state(2).subset([1]), 0, 1000)[0]
    assert_same_bits(calm, alone)
    for first, second in zip(before, simulation.run(random_state(2), 0, 30), strict=True):
        assert_same_bits(first, second)
