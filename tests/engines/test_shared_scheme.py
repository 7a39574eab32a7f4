"""Engines whose tuned presets take the scheme's own step: equal to it to round-off, in joint and in contact."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from engines.interface.engine import Engine
from engines.interface.registry import engine
from engines.interface.tolerances import CREEP
from reference_lcp.chain.harmonic import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.refusal import ParameterError
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUND_OFF,
    STEPS,
    assert_equals_scheme,
    lane_of,
    random_state,
    scheme,
    uneven_lane,
    with_coefficients,
)

SHARING = [
    name for name in ("mujoco", "pybullet", "dart", "pinocchio", "pymunk") if engine(name).unavailable_reason() is None
]


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Every engine, and where a test asks for a formulation, each that the engine has."""
    engines = [engine(name) for name in SHARING]
    if "formulation" in metafunc.fixturenames:
        pairs = [(one, str(formulation)) for one in engines for formulation in one.capabilities.presets]
        labels = [f"{one.name}-{formulation}" for one, formulation in pairs]
        metafunc.parametrize(("tested", "formulation"), pairs, ids=labels)
    else:
        metafunc.parametrize("tested", engines, ids=lambda one: one.name)


def round_off(tested: Engine, formulation: str = "joint") -> float:
    """Where a stuck contact keeps part of what it would gain in a step, motions differ by some of that part."""
    return ROUND_OFF + CREEP * tested.preset(formulation, "tuned").residual_slip_compliance


def assert_shares_scheme(
    tested: Engine, lane: Lane, state: State, trajectory: Trajectory, formulation: str = "joint",
    scale: float = AMPLITUDE,
) -> None:  # fmt: skip
    assert_equals_scheme(lane, state, trajectory, scale, round_off(tested, formulation))


def run(tested: Engine, lane: Lane, state: State, steps: int, formulation: str = "joint") -> Trajectory:
    simulation = tested.build([lane], formulation)
    trajectory = simulation.run(state, 0, steps)[0]
    simulation.close()
    return trajectory


@pytest.mark.parametrize("friction_ratio", [0.0, 0.1, 0.3, 0.6, 1.0, 5.0])
def test_motion_equals_the_scheme_from_frictionless_to_locked(
    tested: Engine, friction_ratio: float, formulation: str
) -> None:
    """Motors left on, a bound times the wrong step, a damping of the engine's own: each would show here."""
    lane = lane_of(friction_ratio)
    state = random_state(size=0.3)
    assert_shares_scheme(tested, lane, state, run(tested, lane, state, STEPS, formulation), formulation)


def test_uneven_cells_and_inner_dashpots_equal_the_scheme(tested: Engine, formulation: str) -> None:
    lane = uneven_lane()
    motion = run(tested, lane, random_state(), 2 * STEPS, formulation)
    assert_shares_scheme(tested, lane, random_state(), motion, formulation)


def test_lanes_of_one_batch_keep_their_own_chain_drive_and_time_step(tested: Engine) -> None:
    lanes = [lane_of(0.0, 0.3), uneven_lane(), lane_of(1.0, 1.3)]
    states = random_state(3)
    simulation = tested.build(lanes)
    for index, trajectory in enumerate(simulation.run(states, 0, STEPS)):
        assert_shares_scheme(tested, lanes[index], states.subset([index]), trajectory)


def test_two_halves_equal_the_whole(tested: Engine) -> None:
    simulation = tested.build([lane_of(), uneven_lane()])
    whole = simulation.advance(random_state(2), 0, 200)
    half = simulation.advance(random_state(2), 0, 100)
    halves = simulation.advance(half, 100, 100)
    tolerance = tested.preset("joint", "tuned").split_tolerance * AMPLITUDE
    np.testing.assert_allclose(halves.positions, whole.positions, rtol=0, atol=tolerance)


def test_nothing_is_remembered_between_runs(tested: Engine, formulation: str) -> None:
    simulation = tested.build([lane_of(), uneven_lane()], formulation)
    first = simulation.run(random_state(2), 0, STEPS)
    simulation.run(State.at_rest(2, 7), 50, 77)
    again = simulation.run(random_state(2), 0, STEPS)
    fresh = tested.build(simulation.lanes, formulation).run(random_state(2), 0, STEPS)
    for one, two, three in zip(first, again, fresh, strict=True):
        for name in ("positions", "velocities", "friction"):
            assert np.array_equal(getattr(one, name), getattr(two, name))
            assert np.array_equal(getattr(one, name), getattr(three, name))


def test_advance_and_subset_repeat_run_bit_by_bit(tested: Engine) -> None:
    simulation = tested.build([lane_of(), uneven_lane(), lane_of(1.0)])
    states = random_state(3)
    rows = np.array([trajectory.positions[-1] for trajectory in simulation.run(states, 0, STEPS)])
    assert np.array_equal(simulation.advance(states, 0, STEPS).positions, rows)
    chosen = simulation.subset([2, 0])
    assert np.array_equal(chosen.advance(states.subset([2, 0]), 0, STEPS).positions, rows[[2, 0]])


def test_friction_stays_within_its_bound_and_never_feeds_energy(tested: Engine) -> None:
    lane = uneven_lane()
    trajectory = run(tested, lane, random_state(), 2 * STEPS)
    bound = lane.chain.friction_bound
    speed = np.max(np.abs(trajectory.relative_velocity))
    assert np.all(np.abs(trajectory.friction) <= bound * (1 + 1e-9))
    assert np.all(trajectory.friction * trajectory.relative_velocity <= 1e-12 * bound.max() * speed)


def test_a_stuck_contact_does_not_creep(tested: Engine) -> None:
    lane = lane_of(5.0, 0.3)
    trajectory, residual_slip_compliance = (
        run(tested, lane, State.at_rest(1, 7), 3 * STEPS),
        tested.preset("joint", "tuned").residual_slip_compliance,
    )
    assert (
        np.max(np.abs(trajectory.relative_velocity))
        <= (1e-13 + residual_slip_compliance) * AMPLITUDE * lane.drive.angular_frequency
    )
    slip = np.max(np.abs(trajectory.inner_positions - trajectory.outer_positions))
    assert slip <= (1e-12 + residual_slip_compliance) * AMPLITUDE


@pytest.mark.parametrize(("mass", "stiffness", "length"), [(1e-15, 1e6, 1e-9), (1e9, 1e3, 100.0), (1e-3, 1e15, 1e-6)])
def test_units_do_not_matter(tested: Engine, mass: float, stiffness: float, length: float, formulation: str) -> None:
    """Nanometres at gigahertz pass the engine's built-in numbers in SI units, and must not here."""
    chain = Chain.from_ratios(friction_ratio=0.3, outer_mass=mass, chain_stiffness=stiffness, base_amplitude=length)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6, length), STEPS)
    positions = scheme(lane, State.at_rest(1, 7), STEPS)[0]
    trajectory = run(tested, lane, State.at_rest(1, 7), STEPS, formulation)
    np.testing.assert_allclose(trajectory.positions, positions, rtol=0, atol=round_off(tested, formulation) * length)


def test_motion_far_above_the_displacement_scale_is_not_cut_off(tested: Engine) -> None:
    lane, state = lane_of(), random_state(size=1e4)
    assert_shares_scheme(tested, lane, state, run(tested, lane, state, STEPS), scale=1e4 * AMPLITUDE)


def test_it_is_silent_writes_nothing_and_survives_divergence(tested: Engine, tmp_path: Path) -> None:
    """Standard output and error are read as file descriptors: compiled code does not write to sys.stderr."""
    program = (
        f"import sys, numpy as np; from engines import engine; tested = engine({tested.name!r})\n"
        f"assert {tested.capabilities.package!r} not in sys.modules\n"
        "from reference_lcp.chain.mass_in_mass import Chain; from reference_lcp.chain.harmonic import HarmonicBase\n"
        "from reference_lcp.chain.simulation import Lane; from reference_lcp.chain.trajectory import State\n"
        "chain = Chain.from_ratios(friction_ratio=0.1)\n"
        "unstable = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.1), 20)\n"
        "end = tested.build([unstable]).advance(State.at_rest(1, 7), 0, 400)\n"
        "assert np.max(np.abs(end.positions)) > 1e6 * 0.01\n"
    )
    path = os.pathsep.join(filter(None, [str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH")]))
    done = subprocess.run(
        [sys.executable, "-B", "-c", program],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert list(tmp_path.iterdir()) == []


def test_states_of_a_wrong_shape_are_refused(tested: Engine) -> None:
    simulation = tested.build([lane_of()])
    with pytest.raises(ParameterError, match=r"shape \(1, 6\)"):
        simulation.run(State.at_rest(1, 3), 0, 1)


@pytest.mark.parametrize("coefficient", [0.001, 0.1, 3.0, [0.5, 0.05, 0.3, 1.0, 0.02, 2.0, 0.7]])
def test_only_the_bound_enters_the_motion_whatever_the_coefficient(
    tested: Engine, formulation: str, coefficient: object
) -> None:
    lane, state = with_coefficients(coefficient), random_state()
    if (tested.name, formulation, coefficient) == ("dart", "contact", 0.001):
        with pytest.raises(ParameterError, match="friction_coefficient"):  # DART takes it for zero
            tested.build([lane], formulation)
        return
    trajectory = run(tested, lane, state, STEPS, formulation)
    assert_shares_scheme(tested, lane, state, trajectory, formulation)
    tolerance = 1e-9 + CREEP * tested.preset(formulation, "tuned").residual_slip_compliance
    assert trajectory.normal_force == pytest.approx(np.broadcast_to(lane.chain.normal_force, (STEPS, 7)), rel=tolerance)
