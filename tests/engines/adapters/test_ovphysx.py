"""ovphysx: its two solvers, their softness, lanes of one scene, what carries what, and the friction that it tells."""

import dataclasses

import numpy as np
import pytest

from engines.interface.law import Law
from engines.interface.registry import law_of
from engines.interface.tolerances import FRICTION_TOLERANCE, ROUND_OFF, SINGLE
from engines.isolated.versioned_engine import EnvironmentEngine, Requirement
from engines.ovphysx import Ovphysx
from engines.ovphysx.step_model import SINGLE_PRECISION_PERIOD
from engines.shared.units import Units
from reference_lcp.chain.drives import StillBase
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from tests.engines.adapters.ovphysx_variants import SUBSTEPS, OvphysxVariants
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUNDINGS,
    STEPS,
    assert_equals_scheme,
    distance,
    lane_of,
    random_state,
    scheme,
    uneven_lane,
    unstable_lane,
)

ENGINE = EnvironmentEngine(Requirement(OvphysxVariants()))

needs_ovphysx = pytest.mark.needs("ovphysx")

SUBSTEP_PERIOD = SINGLE_PRECISION_PERIOD / 32
"""Of U0: what the roundings of one substep a step add up to in a period."""


def run(lane: Lane, state: State, steps: int = STEPS, preset: str = "tuned") -> Trajectory:
    simulation = ENGINE.build([lane], "joint", preset)
    try:
        return simulation.run(state, 0, steps)[0]
    finally:
        simulation.close()


def law_named(preset: str) -> Law:
    law = law_of(ENGINE.preset("joint", preset))
    assert law is not None
    return law


def softened(law: Law, softness: float) -> Law:
    return dataclasses.replace(law, constants={"c": dataclasses.replace(law.constants["c"], value=softness)})


def predicted(law: Law, lane: Lane, state: State, steps: int = STEPS) -> Trajectory:
    return law.build([lane]).run(state, 0, steps)[0]


def apart(one: Trajectory, other: Trajectory) -> float:
    """Largest distance of two motions over the displacement scale."""
    return float(np.max(np.abs(one.positions - other.positions)) / AMPLITUDE)


def test_law_of_one_substep_without_softness_is_the_scheme() -> None:
    lane, state = uneven_lane(), random_state()
    assert_equals_scheme(lane, state, predicted(softened(law_named("1/0"), 0.0), lane, state))


@pytest.mark.parametrize("iterations", SUBSTEPS)
def test_law_under_a_constant_force_moves_as_far_as_its_substeps_add_up_to(iterations: tuple[int, int]) -> None:
    """From rest, (n + 1) / (2 n) a Δt²: springs and dashpots are those of the start of the step."""
    lane = lane_of(0.0)
    substeps, corrections = iterations
    motion = predicted(law_named(f"{substeps}/{corrections}"), lane, State.at_rest(1, 7), 2)
    first = lane.loads(0, 2)[0] / lane.chain.outer_mass[0] * lane.time_step**2
    expected = first * (substeps + 1) / (2 * substeps)
    assert motion.positions[0, 0] == pytest.approx(expected, rel=1e-12, abs=1e-300)


@pytest.mark.parametrize("mass_ratio", [0.25, 1.0, 50.0])
def test_law_of_soft_links_leaves_a_stuck_contact_a_part_of_its_slip(mass_ratio: float) -> None:
    """c / (1 + ρ + c) in a substep, with ρ the lighter mass over the heavier; a correction leaves as much of that."""
    lane = lane_of(1e6, mass_ratio=mass_ratio)
    lane = dataclasses.replace(lane, drive=StillBase(AMPLITUDE))
    slipping = State(np.zeros((1, 14)), np.concatenate([np.zeros(7), np.ones(7)])[None])
    ratio = min(mass_ratio, 1 / mass_ratio)
    for velocity in (0, 1):
        motion = predicted(law_named(f"1/{velocity}"), lane, slipping, 1)
        left = (0.025 / (1 + ratio + 0.025)) ** (1 + velocity)
        np.testing.assert_allclose(motion.relative_velocity[0], left, rtol=1e-9)


@needs_ovphysx
@pytest.mark.parametrize("iterations", SUBSTEPS)
def test_iterations_of_the_temporal_solver_are_substeps(iterations: tuple[int, int]) -> None:
    lane, state = lane_of(), random_state(size=0.3)
    substeps, corrections = iterations
    preset = f"{substeps}/{corrections}"
    motion = run(lane, state, preset=preset)
    from_law = apart(motion, predicted(law_named(preset), lane, state))
    assert from_law < substeps * SUBSTEP_PERIOD
    assert distance(lane, state, motion) > 5 * from_law


@needs_ovphysx
@pytest.mark.parametrize(("preset", "softness"), [("1/0", 0.025), ("hard-links", 0.0)])
def test_links_are_as_soft_as_they_are_told_to_be(preset: str, softness: float) -> None:
    lane, state = lane_of(5.0, 0.3), State.at_rest(1, 7)
    motion, law = run(lane, state, preset=preset), law_named("1/0")
    assert apart(motion, predicted(softened(law, softness), lane, state)) < SUBSTEP_PERIOD
    assert apart(motion, predicted(softened(law, 0.025 - softness), lane, state)) > 10 * SUBSTEP_PERIOD


@needs_ovphysx
def test_what_slips_back_is_held_back_by_the_whole_step() -> None:
    """The correction after the substeps has the bound of all of them: a contact that turns has more than one's left."""
    lane, state = lane_of(0.1), random_state(size=0.3)
    with_it, without = (run(lane, state, preset=preset) for preset in ("4/1", "4/0"))
    assert apart(with_it, predicted(law_named("4/1"), lane, state)) < 4 * SUBSTEP_PERIOD
    assert apart(with_it, without) > 4 * SUBSTEP_PERIOD


@needs_ovphysx
def test_one_iteration_of_the_projected_solver_lets_stuck_contacts_creep() -> None:
    lane = lane_of(5.0, 0.3)
    tuned, once = (run(lane, State.at_rest(1, 7), preset=preset) for preset in ("tuned", "one-iteration"))
    speed = np.max(np.abs(tuned.velocities))
    assert np.max(np.abs(tuned.relative_velocity)) <= 4 * SINGLE * speed
    assert np.max(np.abs(once.relative_velocity)) > 20 * SINGLE * speed


@needs_ovphysx
@pytest.mark.parametrize("mass_ratio", [1e-6, 1e-3, 1.0, 1e3])
def test_neither_mass_of_a_cell_is_lost_beside_the_other(mass_ratio: float) -> None:
    rng = np.random.default_rng(1)
    lane = lane_of(0.3, 0.9, mass_ratio=mass_ratio * rng.uniform(0.7, 1.4, 7))
    state = State.at_rest(1, 7)
    motion, expected = run(lane, state), scheme(lane, state, STEPS)
    assert distance(lane, state, motion) < ROUNDINGS
    error = np.abs(motion.friction - expected[2]) / lane.chain.friction_bound
    assert np.max(error) < FRICTION_TOLERANCE["single"]


@needs_ovphysx
def test_friction_of_a_sliding_contact_is_its_bound_and_of_a_stuck_one_what_it_takes() -> None:
    lane, state = lane_of(0.01), random_state()
    motion, expected = run(lane, state), scheme(lane, state, STEPS)[2]
    sliding = np.isclose(np.abs(expected), lane.chain.friction_bound[0], rtol=ROUND_OFF["double"])
    assert np.mean(sliding) > 0.9
    np.testing.assert_allclose(motion.friction[sliding], expected[sliding], rtol=ROUND_OFF["double"])
    lane = lane_of(5.0, 0.3)
    motion, expected = run(lane, State.at_rest(1, 7)), scheme(lane, State.at_rest(1, 7), STEPS)[2]
    assert np.max(np.abs(motion.friction - expected)) < FRICTION_TOLERANCE["single"] * np.max(np.abs(expected))


@needs_ovphysx
def test_lanes_of_one_scene_move_as_each_alone_whatever_carries_and_however_long_its_step() -> None:
    lanes = [lane_of(0.3, 0.6), lane_of(0.1, 1.3, 1600, mass_ratio=30.0), uneven_lane(), lane_of(1.0, mass_ratio=0.1)]
    assert len({lane.time_step for lane in lanes}) > 2
    state = random_state(len(lanes))
    together = ENGINE.build(lanes, "joint")
    rows = together.run(state, 7, 50)
    ends = together.advance(state, 7, 50)
    for index, lane in enumerate(lanes):
        alone = ENGINE.build([lane], "joint").run(state.subset([index]), 7, 50)[0]
        assert np.array_equal(rows[index].positions, alone.positions)
        assert np.array_equal(rows[index].friction, alone.friction)
        assert np.array_equal(ends.positions[index], alone.positions[-1])
    assert np.array_equal(together.subset([2]).run(state.subset([2]), 7, 50)[0].positions, rows[2].positions)


@needs_ovphysx
def test_a_lane_that_diverges_stops_and_does_not_disturb_the_others() -> None:
    state = random_state(2)
    wild, calm = ENGINE.build([unstable_lane(), lane_of()], "joint").run(state, 0, STEPS)
    assert np.array_equal(calm.positions, run(lane_of(), state.subset([1])).positions)
    assert np.all(np.isfinite(wild.positions))
    assert np.max(np.abs(wild.positions)) > 1e6 * AMPLITUDE
    assert np.array_equal(wild.positions[-1], wild.positions[-2])


@needs_ovphysx
def test_simulations_that_take_turns_do_not_disturb_each_other() -> None:
    lane, state = lane_of(), random_state()
    tuned, default = (ENGINE.build([lane], "joint", preset) for preset in ("tuned", "default"))
    first, _, second = tuned.run(state, 0, 50)[0], default.run(state, 0, 50)[0], tuned.run(state, 0, 50)[0]
    assert np.array_equal(first.positions, second.positions)


@needs_ovphysx
def test_cells_of_a_long_chain_are_in_order() -> None:
    lane = lane_of(0.3, cells=30, mass_ratio=np.linspace(0.3, 3.0, 30))
    rng = np.random.default_rng(4)
    state = State(AMPLITUDE * rng.normal(size=(1, 60)), AMPLITUDE * rng.normal(size=(1, 60)))
    assert distance(lane, state, run(lane, state)) < ROUNDINGS


@needs_ovphysx
@pytest.mark.parametrize("size", [1e-6, 100.0])
def test_motion_far_from_the_displacement_scale_is_neither_put_to_sleep_nor_cut_off(size: float) -> None:
    lane = dataclasses.replace(lane_of(0.0), drive=StillBase(AMPLITUDE))
    state = random_state(size=size)
    assert distance(lane, state, run(lane, state)) < ROUNDINGS


@needs_ovphysx
def test_no_joint_is_faster_than_100_units_of_length_in_one_of_time() -> None:
    """Whatever is set: in the lane's units that is far beyond any motion."""
    lane = dataclasses.replace(lane_of(0.0), drive=StillBase(AMPLITUDE))
    unit = Units.in_steps("lane", lane).velocity
    slow, fast = (State(np.zeros((1, 14)), np.full((1, 14), speed * unit)) for speed in (99.0, 1e6))
    assert distance(lane, slow, run(lane, slow, 1)) < ROUNDINGS
    assert np.max(np.abs(run(lane, fast, 1).velocities)) < 0.01 * 1e6 * unit


def test_the_terms_of_its_licence_are_known() -> None:
    assert Ovphysx.capabilities.licence == "LicenseRef-NVIDIA-Omniverse"
    assert Ovphysx.capabilities.terms.startswith("https://www.nvidia.com/")
