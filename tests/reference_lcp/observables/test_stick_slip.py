"""Modes, transitions and energies of contacts, on motions made by hand and on simulated ones."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reference_lcp import (
    HarmonicBase,
    Lane,
    PeriodicOrbit,
    Trajectory,
    dissipated_energy,
    stuck_fraction,
    transitions,
)
from reference_lcp.chain.simulation import OrbitStatus
from reference_lcp.errors import ParameterError
from reference_lcp.observables.stick_slip import MATCHING_WINDOW, creep_velocity, match_transitions
from reference_lcp.observables.transmittance import fundamental
from tests.reference_lcp.cases import one_cell

STEPS = 20
PERIOD = 2.0

STICK, FORWARD, BACKWARD = "stick", "forward slip", "backward slip"
TIMES = st.floats(0, PERIOD, exclude_max=True)

KINDS = st.sampled_from([STICK, FORWARD, BACKWARD])
TRANSITIONS = st.lists(st.tuples(st.integers(1, 3), TIMES, KINDS), max_size=12, unique=True)


def orbit_with_friction(force, velocity=None) -> PeriodicOrbit:
    """One cell with a bound of 1 N whose friction force over a period is given."""
    lane = Lane.periodic(one_cell(bound=1.0), HarmonicBase(1.0, 2 * np.pi), STEPS)
    relative = -np.sign(force) if velocity is None else velocity
    velocities = np.column_stack([np.zeros(STEPS), relative])
    trajectory = Trajectory(
        lane.times(0, STEPS), np.zeros((STEPS, 2)), velocities, np.reshape(force, (STEPS, 1)), np.ones((STEPS, 1))
    )
    return PeriodicOrbit(lane, trajectory, 0.0, 1, OrbitStatus.CONVERGED)


MOTIONS = {
    "slip against the force where it is at its bound": (
        np.repeat([0.5, 1.0, -0.2, -1.0], 5),
        [(0, STICK), (5, BACKWARD), (10, STICK), (15, FORWARD)],
        0.5,
    ),
    "a stick of one step is a reversal": (
        np.repeat([1.0, 0.3, -1.0, -0.3], [9, 1, 9, 1]),
        [(9, FORWARD), (19, BACKWARD)],
        0.0,
    ),
    "a stick across the start of the period is one": (
        np.repeat([0.1, 1.0, 0.1], [3, 14, 3]),
        [(3, BACKWARD), (17, STICK)],
        0.3,
    ),
    "what never slips has no transitions": (np.full(STEPS, 0.4), [], 1.0),
}


@pytest.mark.parametrize("case", MOTIONS)
def test_friction_over_a_period_says_when_a_contact_sticks_and_when_that_changes(case) -> None:
    force, changes, stuck = MOTIONS[case]
    orbit = orbit_with_friction(force)
    assert [(round(change.time * STEPS), change.kind) for change in transitions(orbit)] == changes
    assert stuck_fraction(orbit) == pytest.approx([stuck])


def test_creep_is_the_largest_velocity_inside_sticks_only() -> None:
    force = np.repeat([0.5, 1.0], 10)
    velocity = np.concatenate([[5.0], np.full(8, 1e-3), [5.0], np.full(10, -1.0)])
    assert creep_velocity(orbit_with_friction(force, velocity)) == pytest.approx([1e-3])


def test_dissipated_energy_is_force_times_slip() -> None:
    orbit = orbit_with_friction(np.repeat([1.0, -1.0], 10), np.repeat([-0.5, 0.5], 10))
    assert dissipated_energy(orbit) == pytest.approx([0.5])


def test_fundamental_of_a_sine_is_its_amplitude_and_phase() -> None:
    phase = 2 * np.pi * np.arange(1, 401) / 400
    signal = 3 * np.sin(phase + 0.4) + 0.5 * np.sin(3 * phase) + 2
    assert fundamental(signal) == pytest.approx(3 * np.exp(0.4j))


@pytest.mark.parametrize(
    ("observed", "expected", "error"),
    [(0.50, 0.50, 0.0), (0.52, 0.50, 0.01), (0.01, PERIOD - 0.01, 0.01), (PERIOD - 0.01, 0.01, -0.01)],
)
def test_error_of_a_time_is_over_the_period_whose_ends_are_neighbours(observed, expected, error) -> None:
    match = match_transitions([(1, observed, STICK)], [(1, expected, STICK)], PERIOD)
    assert match.errors == {(1, expected, STICK): pytest.approx(error)}


@pytest.mark.parametrize(
    "observed", [(2, 0.5, STICK), (1, 0.5, FORWARD), (1, 0.5 + 1.01 * MATCHING_WINDOW * PERIOD, STICK)]
)
def test_another_cell_another_mode_or_too_far_is_missed_and_spurious(observed) -> None:
    match = match_transitions([observed], [(1, 0.5, STICK)], PERIOD)
    assert (match.errors, list(match.spurious)) == ({}, [observed])


def test_each_transition_pairs_once_and_the_closest_first() -> None:
    expected = [(1, 0.50, STICK), (1, 0.53, STICK)]
    assert list(match_transitions([(1, 0.525, STICK)], expected, PERIOD).errors) == expected[1:]


@pytest.mark.parametrize("period", [0.0, float("nan")])
def test_a_period_that_is_not_positive_is_refused(period) -> None:
    with pytest.raises(ParameterError, match="period"):
        match_transitions([], [], period)


@given(TRANSITIONS, TRANSITIONS)
def test_every_transition_is_in_one_place_whichever_side_it_is_on(observed, expected) -> None:
    match, other = match_transitions(observed, expected, PERIOD), match_transitions(expected, observed, PERIOD)
    assert len(match.errors) + len(match.spurious) == len(observed)
    assert sorted([*match.errors, *other.spurious]) == sorted(expected)
    assert sorted([*other.errors, *match.spurious]) == sorted(observed)
    assert all(abs(error) <= MATCHING_WINDOW for error in match.errors.values())
