"""Engines on Warp: what only their graphs, their worlds and their single precision do."""

import dataclasses
import re

import numpy as np
import pytest

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.tolerances import ROUND_OFF
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
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
from tests.installed import each_variant

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


def cell_ratios(name: str, ratio: float) -> Chain:
    """A chain of light or heavy inner masses, whose bounds are in proportion to them, in Newton up to equal ones."""
    scale = min(ratio, 1.0) if name == "newton" else ratio
    return Chain.from_ratios(mass_ratio=ratio, stiffness_ratio=scale, friction_ratio=0.3 * scale)


@both_engines
@both_formulations
@pytest.mark.parametrize("ratio", [1e-6, 1e-4, 1e-3, 1e-2, 10.0])
def test_light_and_heavy_inner_masses_move_by_the_scheme(name, ratio, formulation) -> None:
    """Friction beside a heavy outer mass: a contact of a small mass, in units of a large one, has none."""
    chain = cell_ratios(name, ratio)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.8), STEPS)
    motion = engine(name).build([lane], formulation).run(State.at_rest(1, 7), 0, STEPS)[0]
    assert distance(lane, State.at_rest(1, 7), motion) < ROUNDINGS


@pytest.mark.parametrize(
    ("one", "largest", "allowed"),
    [
        pytest.param(*one.values, *limits, id=one.id, marks=one.marks)
        for names, *limits in (
            (("newton", "newton:joint:default", "newton:contact", "newton:contact:default"), 1000.0, 5e-5),
            (("mujoco-warp",), 100.0, 2e-5),
            (("mujoco-warp:contact",), 20.0, ROUNDINGS),
        )
        for one in each_variant(map(Variant.parse, names))
    ],
)
def test_inner_masses_beside_which_single_precision_loses_the_outer_are_refused(one, largest, allowed) -> None:
    """At the limit a period is still that of the scheme."""

    def lane(ratio: float) -> Lane:
        chain = Chain.from_ratios(mass_ratio=ratio, friction_ratio=0.3)
        return Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), STEPS)

    motion = one.build([lane(largest)]).run(State.at_rest(1, 7), 0, STEPS)[0]
    assert distance(lane(largest), State.at_rest(1, 7), motion) < allowed
    refused = f"= {2 * largest:g}; allowed: at most {largest:g} in {one.capabilities.title}"
    with pytest.raises(ParameterError, match=re.escape(refused)):
        one.build([lane(0.5), lane(2 * largest)])


@both_engines
@pytest.mark.parametrize(("modulation", "multiple"), [(0.5, 2), (1.0, STEPS / 4)])
def test_a_world_whose_bounds_change_in_time_leaves_those_of_the_others_alone(name, modulation, multiple) -> None:
    """Down to zero, which Newton takes for no limit."""
    constant, state = uneven_lane(), random_state(2)
    preload = Preload(modulation=modulation, angular_frequency=multiple * lane_of().drive.angular_frequency)
    modulated = dataclasses.replace(lane_of(), preload=preload)
    together = engine(name).build([modulated, constant]).run(state, 3, 200)
    for index, lane in enumerate([modulated, constant]):
        assert_same_bits(engine(name).build([lane]).run(state.subset([index]), 3, 200)[0], together[index])
    bound = lane_of().chain.friction_coefficient * modulated.preloads(3, 200)
    over = np.max(np.abs(together[0].friction) - bound)
    assert abs(over) <= ROUND_OFF["single"] * np.max(lane_of().chain.friction_bound)


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
