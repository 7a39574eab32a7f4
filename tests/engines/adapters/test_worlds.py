"""Engines that step many chains as worlds of one scene: graphs on Warp, worlds beside each other, masses far apart."""

import dataclasses

import numpy as np
import pytest

from multibody_xval.engines.interface.tolerances import ROUND_OFF
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import (
    ROUNDINGS,
    STEPS,
    assert_same_bits,
    chain_of,
    distance,
    lane_of,
    random_state,
    run,
    uneven_lane,
    with_coefficients,
)
from tests.installed import each_variant

ON_WARP = [
    f"{name}:{formulation}:{preset}"
    for name in ("newton", "mujoco-warp") for formulation in ("joint", "contact") for preset in ("tuned", "default")
]  # fmt: skip
IN_SCENES = [*(f"genesis:{own}" for own in ("joint:tuned", "joint:default", "contact:tuned", "contact:default")),
             "genesis:contact:default:across=held"]  # fmt: skip


def each(*names: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("one", each_variant(map(Variant.parse, names)))


@each(*ON_WARP)
def test_the_graph_of_a_step_computes_what_its_kernels_compute_one_by_one(one: Variant) -> None:
    """A graph leaves Python out, and nothing else."""
    simulation = one.build([lane_of(), uneven_lane()])
    recorded = simulation.run(random_state(2), 0, 50)
    # Newton's lanes in SI units are each alone
    for own in [model._simulation for model in getattr(simulation, "models", [])] or [simulation]:
        own._worlds.launch = own._worlds.eager_step
    for graph, eager in zip(recorded, simulation.run(random_state(2), 0, 50), strict=True):
        assert_same_bits(graph, eager)


def lanes_of_all_kinds() -> list[Lane]:
    """Lanes that differ in time step, frequency, friction, units and coefficient; the first has no dashpots."""
    lanes = [lane_of(0.3, 0.6, damping_ratio=0.0), lane_of(0.1, 0.9, 2 * STEPS), lane_of(0.0, 1.3), uneven_lane()]
    return [*lanes, chain_of(20.0, 3e3, 0.1), with_coefficients([0.5, 0.05, 0.3, 1.0, 0.02, 2.0, 0.7])]


@each(*ON_WARP, *IN_SCENES)
def test_worlds_of_other_time_steps_and_chains_move_as_each_alone(one: Variant) -> None:
    """In the order in which they were given, and by more steps than are recorded at once."""
    lanes = lanes_of_all_kinds()[: 4 if one.engine == "genesis" else None]  # it refuses small coefficients by default
    state = random_state(len(lanes))
    together = one.build(lanes).run(state, 7, 200)
    for index, lane in enumerate(lanes):
        assert_same_bits(one.build([lane]).run(state.subset([index]), 7, 200)[0], together[index])


MASSES = [
    *((f"{name}{own}", ratio, ratio, ROUNDINGS) for name in ("newton", "mujoco-warp") for own in ("", ":contact")
      for ratio in (1e-6, 1e-3)),
    ("mujoco-warp", 10.0, 10.0, ROUNDINGS), ("mujoco-warp:contact", 10.0, 10.0, ROUNDINGS),
    # in Newton with bounds up to those of equal masses
    ("newton", 10.0, 1.0, ROUNDINGS), ("newton:contact", 10.0, 1.0, ROUNDINGS),
    # the heaviest that are taken
    ("newton", 1000.0, 1.0, 5e-5), ("newton:contact", 1000.0, 1.0, 5e-5), ("mujoco-warp", 100.0, 1.0, 2e-5),
    ("mujoco-warp:contact", 20.0, 1.0, ROUNDINGS),
]  # fmt: skip
"""Inner masses and friction over those of the canonical chain, and how far a chain may be from the scheme."""


@pytest.mark.parametrize(
    ("name", "ratio", "scale", "allowed"),
    [pytest.param(*row, marks=pytest.mark.needs(row[0].split(":")[0])) for row in MASSES],
)
def test_light_and_heavy_inner_masses_move_by_the_scheme(name: str, ratio: float, scale: float, allowed: float) -> None:
    """Friction beside a heavy outer mass: a contact of a small mass, in units of a large one, has none."""
    lane, rest = lane_of(0.3 * scale, 0.8, mass_ratio=ratio, stiffness_ratio=scale), State.at_rest(1, 7)
    assert distance(lane, rest, run(name, lane, rest)) < allowed


@each("newton", "mujoco-warp", "genesis")
@pytest.mark.parametrize(("modulation", "multiple"), [(0.5, 2), (1.0, STEPS / 4)])
def test_a_world_whose_bounds_change_in_time_leaves_those_of_the_others_alone(one, modulation, multiple) -> None:
    """Down to zero, which Newton takes for no limit."""
    constant, usual, state = uneven_lane(), lane_of(), random_state(2)
    preload = Preload(modulation=modulation, angular_frequency=multiple * usual.drive.angular_frequency)
    modulated = dataclasses.replace(usual, preload=preload)
    together = one.build([modulated, constant]).run(state, 3, 200)
    for index, lane in enumerate([modulated, constant]):
        assert_same_bits(one.build([lane]).run(state.subset([index]), 3, 200)[0], together[index])
    bound = usual.chain.friction_coefficient * modulated.preloads(3, 200)
    over = np.max(np.abs(together[0].friction) - bound)
    assert abs(over) <= ROUND_OFF["single"] * np.max(usual.chain.friction_bound)
