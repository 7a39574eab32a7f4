"""Modes, transitions and energies of contacts, on motions made by hand and on simulated ones."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reference_lcp import (
    Chain,
    HarmonicBase,
    Lane,
    Mode,
    PeriodicOrbit,
    Trajectory,
    dissipated_energy,
    steady_state,
    stuck_fraction,
    transitions,
)
from reference_lcp.chain.simulation import OrbitStatus
from reference_lcp.errors import ParameterError
from reference_lcp.observables.stick_slip import MATCHING_WINDOW, contact_modes, creep_velocity, match_transitions
from reference_lcp.observables.transmittance import fundamental
from tests.reference_lcp.cases import driven

STEPS = 20


STICK, FORWARD, BACKWARD = "stick", "forward slip", "backward slip"

PERIOD = 2.0

TIMES = st.floats(0, PERIOD, exclude_max=True)

TRANSITION = st.tuples(st.integers(1, 3), TIMES, st.sampled_from([STICK, FORWARD, BACKWARD]))
TRANSITIONS = st.lists(TRANSITION, max_size=12, unique=True)


def orbit_with_friction(force, velocity=None) -> PeriodicOrbit:
    """One cell with a bound of 1 N whose friction force over a period is given."""
    chain = Chain(
        cells=1, outer_mass=np.asarray(1.0), inner_mass=np.asarray(1.0), chain_stiffness=np.asarray(1.0),
        inner_stiffness=np.asarray(1.0), normal_force=np.asarray(2.0), friction_coefficient=np.asarray(0.5),
    )  # fmt: skip
    lane = Lane.periodic(chain, HarmonicBase(1.0, 2 * np.pi), STEPS)
    relative = -np.sign(force) if velocity is None else velocity
    velocities = np.column_stack([np.zeros(STEPS), relative])
    trajectory = Trajectory(
        lane.times(0, STEPS), np.zeros((STEPS, 2)), velocities, np.reshape(force, (STEPS, 1)), np.full((STEPS, 1), 2.0)
    )
    return PeriodicOrbit(lane, trajectory, 0.0, 1, OrbitStatus.CONVERGED)


def test_force_below_the_bound_sticks_and_at_the_bound_slips_against_it() -> None:
    orbit = orbit_with_friction(np.repeat([0.5, 1.0, -0.2, -1.0], 5))
    assert contact_modes(orbit)[:, 0].tolist() == [0] * 5 + [-1] * 5 + [0] * 5 + [1] * 5
    assert stuck_fraction(orbit) == pytest.approx([0.5])
    assert [(t.cell, round(t.time * STEPS), t.kind) for t in transitions(orbit)] == [
        (1, 0, Mode.STICK),
        (1, 5, Mode.BACKWARD),
        (1, 10, Mode.STICK),
        (1, 15, Mode.FORWARD),
    ]


def test_stick_of_one_step_is_a_reversal() -> None:
    force = np.array([1.0] * 9 + [0.3] + [-1.0] * 9 + [-0.3])
    orbit = orbit_with_friction(force)
    assert stuck_fraction(orbit) == pytest.approx([0.0])
    assert [(round(t.time * STEPS), t.kind) for t in transitions(orbit)] == [(9, Mode.FORWARD), (19, Mode.BACKWARD)]


def test_stick_across_the_start_of_the_period_is_one_stick() -> None:
    force = np.array([0.1] * 3 + [1.0] * 14 + [0.1] * 3)
    orbit = orbit_with_friction(force)
    assert [(round(t.time * STEPS), t.kind) for t in transitions(orbit)] == [(3, Mode.BACKWARD), (17, Mode.STICK)]


def test_contact_that_never_slips_has_no_transitions() -> None:
    orbit = orbit_with_friction(np.full(STEPS, 0.4))
    assert transitions(orbit) == []
    assert stuck_fraction(orbit) == pytest.approx([1.0])


def test_creep_is_the_largest_velocity_inside_sticks_only() -> None:
    force = np.repeat([0.5, 1.0], 10)
    velocity = np.concatenate([[5.0], np.full(8, 1e-3), [5.0], np.full(10, -1.0)])
    assert creep_velocity(orbit_with_friction(force, velocity)) == pytest.approx([1e-3])


def test_dissipated_energy_is_force_times_slip() -> None:
    orbit = orbit_with_friction(np.repeat([1.0, -1.0], 10), np.repeat([-0.5, 0.5], 10))
    assert dissipated_energy(orbit) == pytest.approx([0.5])


def test_frictionless_contact_never_sticks_and_has_no_transitions() -> None:
    chain = Chain.from_ratios(friction_ratio=0.0)
    steady = steady_state(chain, HarmonicBase.from_ratio(chain, 0.9))
    assert np.all(steady.stuck_fraction == 0)
    assert steady.transitions == []


def test_energy_put_in_by_the_drive_is_what_friction_and_dashpots_take_out() -> None:
    """Over a period of the steady state nothing is stored; the balance closes to the scheme's first order."""
    chain, drive = driven(0.62, friction_ratio=0.3)
    defects = []
    for steps in (800, 1600, 3200):
        orbit = steady_state(chain, drive, steps_per_period=steps).orbit
        run, dt = orbit.trajectory, orbit.lane.time_step
        work = np.sum(drive.load(chain, run.time) * run.velocities[:, 0]) * dt
        dashpots = np.einsum("ti,ij,tj->", run.velocities, chain.damping_matrix, run.velocities) * dt
        defects.append(abs(work - dashpots - dissipated_energy(orbit).sum()) / work)
    assert defects[-1] < 5e-3
    assert defects[0] / defects[2] == pytest.approx(4.0, rel=0.3)


def test_steady_state_is_symmetric_in_time_as_the_drive_is() -> None:
    """Half a period later everything has the other sign: transitions come in pairs of opposite direction."""
    chain = Chain.from_ratios(friction_ratio=0.3)
    steady = steady_state(chain, HarmonicBase.from_ratio(chain, 0.9))
    modes = contact_modes(steady.orbit)
    assert np.mean(modes[:200] == -modes[200:]) > 0.98


def test_fundamental_of_a_sine_is_its_amplitude_and_phase() -> None:
    phase = 2 * np.pi * np.arange(1, 401) / 400
    signal = 3 * np.sin(phase + 0.4) + 0.5 * np.sin(3 * phase) + 2
    assert fundamental(signal) == pytest.approx(3 * np.exp(0.4j))


def test_equal_transitions_match_without_error() -> None:
    same = [(1, 0.1, STICK), (1, 0.5, FORWARD), (2, 0.1, BACKWARD)]
    match = match_transitions(same, same, PERIOD)
    assert match == (dict.fromkeys(same, 0.0), [])


def test_a_late_transition_has_a_positive_error_over_the_period() -> None:
    match = match_transitions([(1, 0.52, STICK)], [(1, 0.50, STICK)], PERIOD)
    assert match.errors == {(1, 0.50, STICK): pytest.approx(0.01)}


@pytest.mark.parametrize(
    "observed", [(2, 0.5, STICK), (1, 0.5, FORWARD), (1, 0.5 + 1.01 * MATCHING_WINDOW * PERIOD, STICK)]
)
def test_another_cell_another_mode_or_too_far_is_missed_and_spurious(observed: tuple[int, float, str]) -> None:
    expected = (1, 0.5, STICK)
    match = match_transitions([observed], [expected], PERIOD)
    assert match == ({}, [observed])


def test_the_ends_of_the_period_are_neighbours() -> None:
    first, last = (1, 0.01, STICK), (1, PERIOD - 0.01, STICK)
    assert match_transitions([first], [last], PERIOD).errors == {last: pytest.approx(0.01)}
    assert match_transitions([last], [first], PERIOD).errors == {first: pytest.approx(-0.01)}


def test_each_transition_pairs_once_and_the_closest_first() -> None:
    expected = [(1, 0.50, STICK), (1, 0.53, STICK)]
    match = match_transitions([(1, 0.525, STICK)], expected, PERIOD)
    assert list(match.errors) == expected[1:]
    assert match.spurious == []


def test_a_wider_window_pairs_what_is_further_apart() -> None:
    assert match_transitions([(1, 0.8, STICK)], [(1, 0.5, STICK)], PERIOD, window=0.2).spurious == []


@pytest.mark.parametrize(("period", "window"), [(0.0, 0.02), (float("nan"), 0.02), (1.0, 0.0), (1.0, -1.0)])
def test_a_period_or_window_that_is_not_positive_is_refused(period: float, window: float) -> None:
    with pytest.raises(ParameterError, match=r"period|window"):
        match_transitions([], [], period, window)


@given(TRANSITIONS, TRANSITIONS)
def test_every_transition_is_in_one_place_and_swapping_the_sides_swaps_the_outcome(
    observed: list[tuple[int, float, str]], expected: list[tuple[int, float, str]]
) -> None:
    match, other = match_transitions(observed, expected, PERIOD), match_transitions(expected, observed, PERIOD)
    assert len(match.errors) + len(match.spurious) == len(observed)
    assert sorted([*match.errors, *other.spurious]) == sorted(expected)
    assert sorted([*other.errors, *match.spurious]) == sorted(observed)
    assert all(abs(error) <= MATCHING_WINDOW for error in match.errors.values())


@given(TRANSITIONS, st.floats(0, PERIOD, exclude_max=True))
def test_a_common_shift_around_the_cycle_changes_no_count(
    transitions: list[tuple[int, float, str]], shift: float
) -> None:
    moved = [(cell, (time + shift) % PERIOD, kind) for cell, time, kind in transitions]
    assert match_transitions(moved, moved, PERIOD).spurious == []
