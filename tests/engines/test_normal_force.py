"""Contacts that are pressed on each other, by a force that is constant or changes in time."""

import dataclasses

import numpy as np
import pytest

from multibody_xval.engines.interface.presets import NormalForce
from multibody_xval.engines.interface.registry import engine_names
from multibody_xval.engines.interface.tolerances import CREEP, ROUND_OFF, TRAJECTORY_TOLERANCE
from multibody_xval.engines.interface.variant import Variant, variants_of
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, lane_of, random_state, run, uneven_lane
from tests.installed import each_engine, each_variant

TUNED = [
    own for name in engine_names() if name != "reference" for own in variants_of(name) if own.preset_name == "tuned"
]
SHARING = [own for own in TUNED if own.preset.shares_scheme]
FOLLOWING = each_variant(one for one in SHARING if one.preset.represents(NormalForce.MODULATED))
LIFTING = each_variant(one for one in SHARING if one.preset.represents(NormalForce.LIFTING))

AS_IT_COMES = (
    "mujoco", "mujoco-warp", "pybullet", "exudyn-regularised", "dart", "drake", "sapien", "rapier", "newton", "ode",
    "siconos", "genesis", "box2d3",
)  # fmt: skip
"""Engines whose default contact is one that a newcomer would build: nothing but a given force acts across the row."""

LANDING = 0.05
"""Part of a period that a hop may still be under way at its end, in which nothing presses: MuJoCo's spheres hop."""


@pytest.mark.parametrize("preset", ["tuned", "default"])
@pytest.mark.parametrize("name", each_engine(["box2d3", "pymunk", "rapier"]))
def test_a_pressed_box_neither_bounces_nor_sinks_nor_is_pushed_out(name: str, preset: str) -> None:
    """Over a hundred periods every contact is there in every step, with the force that presses it."""
    lane, own = lane_of(0.3, 0.9), Variant(name, "contact", preset)
    simulation = own.build([lane])
    motion = simulation.run(simulation.advance(random_state(), 0, 100 * STEPS), 0, STEPS)[0]
    given, allowed = np.broadcast_to(lane.chain.normal_force, (STEPS, 7)), ROUND_OFF[own.capabilities.precision]
    np.testing.assert_allclose(motion.normal_force, given, rtol=allowed)


@pytest.mark.parametrize("name", each_engine(AS_IT_COMES))
def test_friction_of_a_default_contact_takes_nothing_from_what_presses_it(name: str) -> None:
    """What presses a body is what carries it, however it slips: the mean is λ_N, by the balance of momentum across."""
    lane = lane_of(0.3, 0.6)
    mean = np.mean(run(f"{name}:contact:default", lane, random_state()).normal_force, axis=0) / lane.chain.normal_force
    assert mean == pytest.approx(np.ones(7), abs=LANDING)


@pytest.mark.parametrize("name", ["mujoco:contact:default", "genesis:contact:default:across=held"])
def test_in_the_default_pyramid_friction_presses_a_contact(name: str) -> None:
    if (reason := Variant.parse(name).unavailable_reason) is not None:
        pytest.skip(reason)
    lane = lane_of(0.3, 0.9)
    assert np.max(run(name, lane, random_state()).normal_force / lane.chain.normal_force) > 1.5


@pytest.mark.needs("mujoco-warp")
def test_friction_of_mujoco_warp_raises_the_normal_force_by_the_square_of_the_coefficient() -> None:
    """Of a slip a hundred times as fast as the chain's; the preset's small coefficient makes it vanish otherwise."""
    lane, state = lane_of(), random_state(size=100.0)
    excess = [
        np.max(run("mujoco-warp:contact", lane, state, 50, coefficient=own).normal_force / lane.chain.normal_force - 1)
        for own in (0.1, 0.01)
    ]
    assert excess[0] > 0.01
    assert excess[0] == pytest.approx(100 * excess[1], rel=0.05)


def modulated(lane: Lane, modulation: float, multiple: int = 1, phase: float = 0.0) -> Lane:
    return dataclasses.replace(lane, preload=Preload.at_multiple(lane.drive, modulation, multiple, phase))


@pytest.mark.parametrize("variant", FOLLOWING)
def test_uneven_cells_each_follow_their_own_normal_force(variant: Variant) -> None:
    lanes = [modulated(uneven_lane(), 0.8, 2, phase=0.7), uneven_lane(), modulated(uneven_lane(), 0.5)]
    state, creep = random_state(3, size=0.3), CREEP * variant.preset.modulated().residual_slip_compliance
    allowed = TRAJECTORY_TOLERANCE[variant.capabilities.precision] + creep
    own, of_reference = (each.build(lanes).run(state, 7, STEPS) for each in (variant, Variant("reference")))
    for motion, expected in zip(own, of_reference, strict=True):
        assert np.max(np.abs(motion.positions - expected.positions)) <= allowed * AMPLITUDE
        assert motion.normal_force == pytest.approx(expected.normal_force, rel=1e-3)


@pytest.mark.parametrize("variant", LIFTING)
def test_a_chain_in_flight_keeps_its_gap_beside_one_that_stays_closed(variant: Variant) -> None:
    pair, alone = (variant.build([modulated(lane_of(), a) for a in both]) for both in ((0.5, 1.5), (1.5,)))
    half = pair.advance(State.at_rest(2, 7), 0, 3 * STEPS // 4)
    assert np.all(half.internal_state[1, :7] > 0)
    end = pair.advance(half, 3 * STEPS // 4, 50)
    expected = alone.advance(half.subset([1]), 3 * STEPS // 4, 50)
    assert np.array_equal(end.positions[1], expected.positions[0])


@pytest.mark.needs("mujoco")
def test_sphere_sinks_into_its_plate_by_less_and_less_with_finer_steps() -> None:
    """Its contact is as stiff as a step allows, and no stiffer: the static depth is in proportion to N dt² / m."""
    depths = []
    for steps in (STEPS, 2 * STEPS):
        lane = modulated(lane_of(0.3, 0.5, steps), 0.0)
        depths.append(-Variant("mujoco", "contact").build([lane]).run(State.at_rest(1, 7), 0, steps)[0].normal_gap[-1])
    assert np.all(depths[0] < 1e-6 * AMPLITUDE)
    assert depths[0] / depths[1] == pytest.approx(np.full(7, 4.0), rel=0.01)
