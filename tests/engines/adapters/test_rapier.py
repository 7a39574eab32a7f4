"""Rapier: what only its substeps, its motors, its passes over contacts, sleep and single precision do."""

import dataclasses

import numpy as np
import pytest

from multibody_xval.engines.interface.laws import law_of
from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.rapier import Rapier
from multibody_xval.engines.rapier.contact import RapierContactLane
from multibody_xval.engines.rapier.law import SINGLE_PRECISION_PERIOD
from reference_lcp.chain.drives import HarmonicBase, HarmonicForce, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.errors import ParameterError
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUNDINGS,
    STEPS,
    built_with,
    distance,
    lane_of,
    random_state,
    scheme,
    uneven_lane,
)

pytestmark = pytest.mark.needs("rapier")

FORMULATIONS = ("joint", "contact")


def run(lane: Lane, state: State, steps: int = STEPS, formulation: str = "joint", **options: object) -> Trajectory:
    return built_with(Rapier(), lane, formulation, **options).run(state, 0, steps)[0]


@pytest.mark.parametrize("iterations", [1, 2, 4, 8])
def test_iterations_of_the_solver_are_substeps_under_one_force(iterations: int) -> None:
    """From rest, n substeps under a force F lead to F dt² / m · n (n + 1) / (2 n²): Euler's step has the factor 1."""
    chain = Chain.from_ratios(friction_ratio=0.0)
    lane = Lane.periodic(chain, HarmonicForce(3.0, 20.0), STEPS)
    start = STEPS // 4
    (force,) = lane.loads(start, 1)
    motion = built_with(Rapier(), lane, num_solver_iterations=iterations).run(State.at_rest(1, 7), start, 1)[0]
    euler = force * lane.time_step**2 / chain.outer_mass[0]
    part = (iterations + 1) / (2 * iterations)
    assert force != 0
    assert motion.positions[0, 0] == pytest.approx(part * euler, rel=10 * SINGLE)
    assert motion.velocities[0, 0] == pytest.approx(euler / lane.time_step, rel=10 * SINGLE)


@pytest.mark.parametrize(("warm", "missing"), [(0.0, 1.0), (1.0, 0.0)])
def test_contacts_as_they_come_move_by_the_friction_that_they_start_from(warm: float, missing: float) -> None:
    """Rapier finds friction after positions have moved: by none in a new world, but for contacts that start warm."""
    lane = lane_of(0.3)
    sliding = State(np.zeros((1, 14)), np.repeat([[0.0, 1.0]], 7, axis=1))
    motion = run(lane, sliding, 1, "contact", friction_in_bias_pass=False, warmstart_coefficient=warm)
    positions, velocities, friction = scheme(lane, sliding, 1)
    assert np.all(friction[0] == -lane.chain.friction_bound)
    without = lane.time_step**2 * friction[0] / lane.chain.inner_mass
    np.testing.assert_allclose(motion.inner_positions[0], positions[0, 7:] - missing * without, rtol=10 * SINGLE)
    np.testing.assert_allclose(motion.velocities[0, 7:], velocities[0, 7:], rtol=10 * SINGLE)
    assert np.min(np.abs(without / positions[0, 7:])) > 1000 * SINGLE


def test_recycled_points_of_contact_pull_back_to_where_they_were() -> None:
    lane, state = lane_of(), random_state()
    assert distance(lane, state, run(lane, state, formulation="contact", contact_recycling=True)) > 100 * ROUNDINGS


def test_contact_that_can_slide_in_one_direction_only_has_no_friction(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rapier solves both directions of a contact's plane at once, and gives up in silence where one has no mass."""
    lane, state = lane_of(), random_state()
    monkeypatch.setattr(RapierContactLane, "FREE_INNER", (True, False, True))
    motion = run(lane, state, 50, "contact")
    frictionless = scheme(lane_of(0.0), state, 50)[0]
    assert np.all(motion.friction == 0)
    assert np.max(np.abs(motion.positions - frictionless)) < ROUNDINGS * np.max(np.abs(frictionless))


def test_the_simplified_friction_moves_the_same_and_reports_none() -> None:
    lane, state = lane_of(), random_state()
    motion = run(lane, state, formulation="contact", friction_model="SIMPLIFIED")
    assert distance(lane, state, motion) < ROUNDINGS
    assert np.all(motion.friction == 0)


@pytest.mark.parametrize(("factor", "creeps"), [(1e9, False), (1e3, True)])
def test_motors_creep_unless_they_are_hard(factor: float, creeps: bool) -> None:
    lane = lane_of(5.0, 0.3)
    motion = run(lane, State.at_rest(1, 7), 3 * STEPS, **{"motor factor": factor})
    speed = np.max(np.abs(motion.velocities))
    assert (np.max(np.abs(motion.relative_velocity)) > 4 * SINGLE * speed) == creeps


def test_motion_far_above_the_displacement_scale_is_not_cut_off() -> None:
    """Rapier stops bodies from being faster than 400 units."""
    lane, state = lane_of(), random_state(size=1e7)
    assert distance(lane, state, run(lane, state, 50)) < ROUNDINGS
    assert distance(lane, state, run(lane, state, 50, normalized_max_linear_velocity=400.0)) > 0.1


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_slow_chains_sleep_in_long_steps_only(formulation: str) -> None:
    """Forces keep bodies awake, unless a step alone is as long as the time after which Rapier stops a slow one."""
    lane, state = dataclasses.replace(lane_of(), drive=StillBase(1e-5)), random_state(size=1e-3)
    short = run(lane, state, 3 * STEPS, formulation, can_sleep=True, units="SI")
    awake = run(lane, state, 3 * STEPS, formulation, units="SI")
    assert short.time[-1] > 0.5
    assert np.max(np.abs(short.velocities)) < 0.05
    assert np.array_equal(short.positions, awake.positions)
    # in the lane's own units a step is as long as one or two of their time
    asleep = run(lane, state, STEPS, formulation, can_sleep=True)
    assert distance(lane, state, asleep) > 0.1


def default_lane(length: float, mass: float = 1.0, stiffness: float = 1e3) -> Lane:
    """Give the canonical chain in other units."""
    chain = Chain.from_ratios(friction_ratio=0.3, outer_mass=mass, chain_stiffness=stiffness, base_amplitude=length)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, length), STEPS)


def off_the_law(lane: Lane, formulation: str) -> float:
    """Distance of the default from its law over two periods from rest, over U0."""
    law, start = law_of(Variant("rapier", formulation, "default")), State.at_rest(1, 7)
    assert law is not None
    own = Rapier().build([lane], formulation, "default").run(start, 0, 2 * STEPS)[0].positions
    return float(np.max(np.abs(own - law.positions(lane, start, 2 * STEPS)))) / lane.drive.displacement_scale(
        lane.chain
    )


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("length", [1e-12, 1e-6, 1e-2])
def test_default_is_the_same_for_motions_of_any_smallness_in_si_units(length: float, formulation: str) -> None:
    """A sphere touches exactly, in whatever size: no absolute length of Rapier's has a part in the motion."""
    assert off_the_law(default_lane(length), formulation) < SINGLE_PRECISION_PERIOD


def test_motors_of_the_default_yield_in_heavy_and_stiff_chains_and_contacts_do_not() -> None:
    """A stuck contact slips at its friction over the motor's damping, which is the same number in every chain."""
    heavy = default_lane(AMPLITUDE, 1e6, 1e9)
    assert off_the_law(heavy, "joint") > 10 * SINGLE_PRECISION_PERIOD
    assert off_the_law(heavy, "contact") < SINGLE_PRECISION_PERIOD


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_default_cuts_velocities_off(formulation: str) -> None:
    """At 400 m/s; of a contact, the velocity across that its pressing force makes in a substep is a part of it."""
    assert off_the_law(default_lane(100.0), formulation) > 0.1


def test_friction_of_all_substeps_explains_the_momentum_of_inner_masses() -> None:
    """Of contacts; motors report the last substep, which differs where one starts or stops within a step."""
    lane = lane_of()
    motion = Rapier().build([lane], "contact", "default").run(random_state(), 0, STEPS)[0]
    stiffness, damping = lane.chain.stiffness_matrix[7:], lane.chain.damping_matrix[7:]
    force = -motion.positions[:-1] @ stiffness.T - motion.velocities[:-1] @ damping.T
    gained = np.diff(motion.velocities[:, 7:], axis=0) * lane.chain.inner_mass / lane.time_step
    rounding = 10 * SINGLE * np.max(np.abs(motion.velocities)) * np.max(lane.chain.inner_mass) / lane.time_step
    np.testing.assert_allclose(motion.friction[1:], gained - force, rtol=0, atol=rounding)


def test_a_builder_is_left_as_it_was_and_a_force_stays() -> None:
    """Of Rapier itself, where it would mislead an adapter without a message."""
    import rapier3d

    builder = rapier3d.RigidBody.dynamic()
    heavier = builder.additional_mass(2.0)
    world = rapier3d.PhysicsWorld()
    world.integration_parameters.dt = 1.0 / 64
    light, heavy = (world.rigid_bodies[world.add_body(each)] for each in (builder, heavier))
    for body in (light, heavy):
        body.add_force((2.0, 0.0, 0.0), True)
    for steps in (1, 2):
        world.step()
        assert (light.linvel.x, heavy.linvel.x) == (0.0, steps / 64)
    heavy.reset_forces(True)
    world.step()
    assert heavy.linvel.x == 2 / 64


def native(lane: Lane, state: State, steps: int = STEPS, **options: object) -> Trajectory:
    return built_with(Rapier(), lane, "joint", "native", **options).run(state, 0, steps)[0]


@pytest.mark.parametrize("lane", [lane_of(), uneven_lane()])
def test_frictionloss_of_a_multibody_is_the_step_of_the_scheme(lane: Lane) -> None:
    """With one iteration; friction is read from slips, and is at its bound wherever a contact slides."""
    state = random_state()
    motion, friction = native(lane, state), scheme(lane, state, STEPS)[2]
    assert distance(lane, state, motion) < ROUNDINGS
    bound = lane.chain.friction_bound
    assert np.max(np.abs(motion.friction - friction)) < 1e-3 * np.max(bound)
    assert np.all(np.abs(motion.friction) <= bound)
    slides = np.abs(motion.relative_velocity) > 1e-3 * AMPLITUDE
    assert np.all((np.abs(motion.friction) == bound)[slides])


def test_four_iterations_of_a_multibody_are_the_substeps_of_motors() -> None:
    lane, law = default_lane(AMPLITUDE), law_of(Variant("rapier", "joint", "default"))
    assert law is not None
    expected = law.positions(lane, random_state(), STEPS)
    four = native(lane, random_state(), num_solver_iterations=4, units="SI").positions
    one = native(lane, random_state()).positions
    assert np.max(np.abs(four - expected)) < SINGLE_PRECISION_PERIOD * AMPLITUDE
    assert np.max(np.abs(one - expected)) > 1e-3 * AMPLITUDE


def test_friction_of_a_multibody_repeats_in_single_precision_bit_by_bit() -> None:
    """One block on a slide, under a load that swings up to twice its friction of 3 N: p = clip(m v, ±3 N h)."""
    single = np.float32
    mass, friction, step = single(2.0), single(3.0), single(1e-3)
    world, blocks, multibody = loaded_blocks(1, 2.0, 3.0)
    world.step()
    velocity, largest = single(0), single(friction * step)
    for index in range(2000):
        load = single(6 * np.sin(index * 0.004))
        blocks[0].reset_forces(True)
        blocks[0].add_force((float(load), 0.0, 0.0), True)
        world.step()
        velocity = single(velocity + single(single(load / mass) * step))
        impulse = np.clip(single(velocity * mass), -largest, largest)
        velocity = single(velocity - single(impulse / mass))
        assert multibody().generalized_velocity()[0] == velocity


def loaded_blocks(count: int, mass: float, friction: float):
    """Load blocks on slides, each on the one before; gives the world, the blocks, and what gives their multibody."""
    import rapier3d
    from rapier3d.loaders import mjcf

    inertial = f'<inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/>'
    block = f'<body><joint type="slide" axis="1 0 0" frictionloss="{friction}"/>{inertial}'
    text = f"<mujoco><worldbody>{block * count}{'</body>' * count}</worldbody></mujoco>"
    world = rapier3d.PhysicsWorld()
    world.gravity = rapier3d.Vec3(0.0, 0.0, 0.0)
    world.integration_parameters.dt, world.integration_parameters.num_solver_iterations = 1e-3, 1
    robot, _ = mjcf.MjcfRobot.from_str(text)
    sets = world.rigid_bodies, world.colliders, world.multibody_joints, world.impulse_joints
    loaded = robot.insert_using_multibody_joints(*sets)
    blocks = [world.rigid_bodies[each.body] for each in loaded.bodies[1:]]
    return world, blocks, lambda: world.multibody_joints.multibody(loaded.joints[0].joint)


def test_velocities_of_links_are_those_of_the_step_before() -> None:
    """Of Rapier itself: the adapter reads those of the joints."""
    world, (block,), multibody = loaded_blocks(1, 2.0, 3.0)
    world.step()
    before = 0.0
    for _ in range(3):
        block.reset_forces(True)
        block.add_force((5.0, 0.0, 0.0), True)
        world.step()
        assert block.linvel.x == pytest.approx(before)
        before = multibody().generalized_velocity()[0]
    assert before > 0


def test_a_multibody_has_coordinates_of_its_root_until_its_first_step() -> None:
    """Of Rapier itself: the adapter takes a step at rest before a motion begins."""
    world, _, multibody = loaded_blocks(2, 2.0, 3.0)
    assert multibody().ndofs == 8
    world.step()
    assert multibody().ndofs == 2


@pytest.mark.parametrize("ratio", [1e-3, 1.0, 100.0])
def test_outer_masses_carry_inner_ones_up_to_a_hundred_times_as_heavy(ratio: float) -> None:
    lane, state = lane_of(mass_ratio=ratio), random_state()
    assert distance(lane, state, native(lane, state)) < ROUNDINGS
    with pytest.raises(ParameterError, match=r"= 101; allowed: at most 100 in a multibody of Rapier"):
        native(lane_of(mass_ratio=101.0), state)
