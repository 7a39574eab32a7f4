"""A chain with inclined contacts, step by step: its linear limits, its uniqueness, its state in and out."""

import dataclasses
import math

import numpy as np
import pytest

from reference_lcp import Chain, CompiledSimulation, HarmonicBase, Lane, ParameterError, Preload, State
from reference_lcp.chain.simulation import uniqueness_margin
from reference_lcp.lcp.pivoting import RAY
from reference_lcp.lcp.systems import simulate_system
from reference_lcp.lcp.time_step import StepFailed
from reference_lcp.schemes import inclined
from reference_lcp.schemes.inclined import InclinedLane
from tests.reference_lcp.cases import driven
from tests.reference_lcp.resolved_lane import ResolvedLane

AMPLITUDE, STEPS, CELLS = 0.01, 400, 7
INCLINATION = 0.2
ROUND_OFF = 1e-12


def lane_of(friction_ratio: float, *, modulation: float = 0.0, inclination: float = INCLINATION, **changed) -> Lane:
    chain = dataclasses.replace(Chain.from_ratios(friction_ratio=friction_ratio), **changed)
    drive = HarmonicBase.from_ratio(chain, 0.6, AMPLITUDE)
    preload = Preload.at_multiple(drive, modulation, 2)
    return dataclasses.replace(Lane.periodic(chain, drive, STEPS, preload), inclination=inclination)


def run(lane: Lane, steps: int = STEPS):
    return InclinedLane(lane).run(State.at_rest(1, CELLS), 0, steps)


def test_without_friction_a_closed_contact_adds_to_the_inertia_of_the_slip() -> None:
    """Energy ½ m_o u̇² + ½ m_i (v̇² + tan² α (v̇ − u̇)²): equation (5) with this mass matrix, and no other force."""
    masses = {"outer_mass": np.linspace(1.0, 2.0, CELLS), "inner_mass": np.linspace(0.6, 1.5, CELLS)}
    lane = lane_of(1.0, friction_coefficient=np.zeros(CELLS), inner_damping=np.linspace(0.1, 0.9, CELLS), **masses)
    chain, h = lane.chain, lane.time_step
    directions = chain.contact_directions
    mass = chain.mass_matrix + math.tan(INCLINATION) ** 2 * directions @ np.diag(chain.inner_mass) @ directions.T
    position, velocity = np.zeros((2, 2 * CELLS))
    motion = run(lane)
    for row, load in enumerate(lane.loads(0, STEPS)):
        force = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
        force[0] += load
        velocity = velocity + h * np.linalg.solve(mass, force)
        position = position + h * velocity
        assert motion.positions[row] == pytest.approx(position, abs=ROUND_OFF * AMPLITUDE)
    assert np.max(np.abs(motion.friction)) < ROUND_OFF * chain.normal_force[0]
    assert np.max(np.abs(motion.normal_gap)) < ROUND_OFF * AMPLITUDE


def test_locked_contacts_move_as_those_along_the_row() -> None:
    lane = lane_of(50.0)
    flat = CompiledSimulation([dataclasses.replace(lane, inclination=0.0)]).run(State.at_rest(1, CELLS), 0, STEPS)[0]
    motion = run(lane)
    assert motion.positions == pytest.approx(flat.positions, abs=ROUND_OFF * AMPLITUDE)
    assert np.ptp(motion.normal_force) > 1e-3 * lane.chain.normal_force[0]


def test_contacts_along_the_row_are_those_of_a_given_normal_force() -> None:
    """Lift-off and landing included."""
    lane = lane_of(0.3, modulation=1.5, inclination=0.0)
    flat = CompiledSimulation([lane]).run(State.at_rest(1, CELLS), 0, STEPS)[0]
    motion = run(lane)
    assert np.max(motion.normal_gap) > 0.1 * AMPLITUDE
    assert motion.positions == pytest.approx(flat.positions, abs=ROUND_OFF * AMPLITUDE)
    assert motion.normal_gap == pytest.approx(flat.normal_gap, abs=ROUND_OFF * AMPLITUDE)


@pytest.mark.parametrize("modulation", [0.0, 1.5])
def test_lemke_contact_by_contact_solves_the_system_of_all_contacts(modulation) -> None:
    """No contact touches a mass of another: the blocks of equation (7) are diagonal. Lift-off and landing included."""
    lane = lane_of(0.3, modulation=modulation)
    still = np.zeros(3 * CELLS)
    whole = simulate_system(ResolvedLane(lane), position=still, velocity=still, time_step=lane.time_step, steps=STEPS)
    motion, bound = run(lane), lane.chain.friction_bound[0]
    speed = AMPLITUDE * lane.drive.angular_frequency
    assert motion.positions == pytest.approx(whole.positions[:, : 2 * CELLS], abs=ROUND_OFF * AMPLITUDE)
    assert motion.velocities == pytest.approx(whole.velocities[:, : 2 * CELLS], abs=ROUND_OFF * speed)
    assert motion.friction == pytest.approx(whole.friction, abs=ROUND_OFF * bound)
    assert motion.normal_force == pytest.approx(whole.normal_force, abs=ROUND_OFF * np.max(whole.normal_force))
    assert bool(np.any(motion.normal_force == 0)) is (modulation > 1)


def test_step_that_lemke_cannot_solve_is_named(monkeypatch) -> None:
    monkeypatch.setattr(inclined, "advance_inclined", lambda *_: (3, RAY))
    lane = lane_of(0.3)
    with pytest.raises(StepFailed, match=rf"step 8 at t = {8 * lane.time_step:.6g} s: .*: ray termination"):
        InclinedLane(lane).run(State.at_rest(1, CELLS), 5, 10)


def test_normal_force_depends_on_the_motion_and_its_sign_on_that_of_the_inclination() -> None:
    one_way, other_way = (run(lane_of(0.3, inclination=angle)) for angle in (INCLINATION, -INCLINATION))
    parts = np.array([one_way.normal_force[:20, 0].mean(), other_way.normal_force[:20, 0].mean()])
    mean = lane_of(0.3).chain.normal_force[0]
    assert (parts[0] - mean) * (parts[1] - mean) < 0


def test_run_that_is_split_in_a_flight_equals_the_whole_one() -> None:
    lane = lane_of(0.3, modulation=1.5)
    model, half = InclinedLane(lane), 3 * STEPS // 8
    whole = model.run(State.at_rest(1, CELLS), 0, STEPS)
    first = model.run(State.at_rest(1, CELLS), 0, half)
    assert np.any(first.normal_gap[-1] > 1e-3 * AMPLITUDE)
    second = model.run(first.end, half, STEPS - half)
    assert second.positions == pytest.approx(whole.positions[half:], abs=ROUND_OFF * AMPLITUDE)


@pytest.mark.parametrize("mu", [0.3, 0.5, 2.0])
def test_the_least_outer_mass_at_which_every_inclination_is_unique(mu) -> None:
    """m_o / m_i = (√(1 + μ²) − 1) / 2, with the worst inclination arctan(μ) / 2."""
    least = (math.sqrt(1 + mu**2) - 1) / 2
    for factor, unique in ((1.001, True), (0.999, False)):
        chain = Chain.from_ratios(cells=1, mass_ratio=1 / (factor * least), friction_ratio=0.3, friction_coefficient=mu)
        assert bool(uniqueness_margin(chain, math.atan(mu) / 2)[0] > 0) is unique
        angles = np.linspace(-1.5, 1.5, 301)
        assert all(uniqueness_margin(chain, angle)[0] > 0 for angle in angles) or not unique


def test_chain_whose_motion_would_not_be_unique_is_refused_with_the_largest_friction() -> None:
    chain, drive = driven(0.6, cells=1, mass_ratio=20.0, friction_ratio=0.3, friction_coefficient=0.9)
    preload = Preload.at_multiple(drive, 0.0)
    largest = (1 / 20 + math.sin(0.3) ** 2) / (math.sin(0.3) * math.cos(0.3))
    with pytest.raises(ParameterError, match=rf"not unique; allowed: < {largest:.4g}"):
        Lane(chain, drive, 1e-4, preload, inclination=0.3)
    at_the_end = dataclasses.replace(chain, friction_coefficient=np.full(1, largest))
    assert uniqueness_margin(at_the_end, 0.3) == pytest.approx(0, abs=1e-12)


def test_inclined_contacts_need_a_preload_and_a_row_that_is_not_turned() -> None:
    flat = lane_of(0.3, inclination=0.0)
    with pytest.raises(ParameterError, match=r"inclination = 0\.2 in a row without preload"):
        dataclasses.replace(flat, preload=None, inclination=0.2)
    with pytest.raises(ParameterError, match=r"inclination = 1\.6 is outside its range"):
        dataclasses.replace(flat, inclination=1.6)
