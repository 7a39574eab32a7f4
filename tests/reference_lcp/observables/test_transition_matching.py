"""Matching of transitions: what pairs, what is missed, what is spurious."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reference_lcp.observables.transition_matching import MATCHING_WINDOW, match_transitions
from reference_lcp.refusal import ParameterError

STICK, FORWARD, BACKWARD = "stick", "forward slip", "backward slip"
PERIOD = 2.0


def test_equal_transitions_match_without_error() -> None:
    same = [(1, 0.1, STICK), (1, 0.5, FORWARD), (2, 0.1, BACKWARD)]
    match = match_transitions(same, same, PERIOD)
    assert match.time_errors == (0.0, 0.0, 0.0)
    assert match.missed == match.spurious == ()


def test_a_late_transition_has_a_positive_error_over_the_period() -> None:
    match = match_transitions([(1, 0.52, STICK)], [(1, 0.50, STICK)], PERIOD)
    assert match.time_errors == pytest.approx([0.01])


@pytest.mark.parametrize(
    "observed", [(2, 0.5, STICK), (1, 0.5, FORWARD), (1, 0.5 + 1.01 * MATCHING_WINDOW * PERIOD, STICK)]
)
def test_another_cell_another_mode_or_too_far_is_missed_and_spurious(observed: tuple[int, float, str]) -> None:
    expected = (1, 0.5, STICK)
    match = match_transitions([observed], [expected], PERIOD)
    assert (match.pairs, match.missed, match.spurious) == ((), (expected,), (observed,))


def test_the_ends_of_the_period_are_neighbours() -> None:
    match = match_transitions([(1, 0.01, STICK)], [(1, PERIOD - 0.01, STICK)], PERIOD)
    assert match.time_errors == pytest.approx([0.01])
    assert match_transitions([(1, PERIOD - 0.01, STICK)], [(1, 0.01, STICK)], PERIOD).time_errors == pytest.approx(
        [-0.01]
    )


def test_each_transition_pairs_once_and_the_closest_first() -> None:
    expected = [(1, 0.50, STICK), (1, 0.53, STICK)]
    match = match_transitions([(1, 0.525, STICK)], expected, PERIOD)
    assert match.pairs == (((1, 0.525, STICK), expected[1]),)
    assert match.missed == (expected[0],)


def test_a_wider_window_pairs_what_is_further_apart() -> None:
    assert match_transitions([(1, 0.8, STICK)], [(1, 0.5, STICK)], PERIOD, window=0.2).missed == ()


@pytest.mark.parametrize(("period", "window"), [(0.0, 0.02), (float("nan"), 0.02), (1.0, 0.0), (1.0, -1.0)])
def test_a_period_or_window_that_is_not_positive_is_refused(period: float, window: float) -> None:
    with pytest.raises(ParameterError, match=r"period|window"):
        match_transitions([], [], period, window)


TIMES = st.floats(0, PERIOD, exclude_max=True)
TRANSITIONS = st.lists(st.tuples(st.integers(1, 3), TIMES, st.sampled_from([STICK, FORWARD, BACKWARD])), max_size=12)


@given(TRANSITIONS, TRANSITIONS)
def test_every_transition_is_in_one_place_and_swapping_the_sides_swaps_the_outcome(
    observed: list[tuple[int, float, str]], expected: list[tuple[int, float, str]]
) -> None:
    match = match_transitions(observed, expected, PERIOD)
    assert sorted([*(pair[0] for pair in match.pairs), *match.spurious]) == sorted(observed)
    assert sorted([*(pair[1] for pair in match.pairs), *match.missed]) == sorted(expected)
    assert all(f[0] == e[0] and f[2] == e[2] for f, e in match.pairs)
    assert all(abs(error) <= MATCHING_WINDOW for error in match.time_errors)


@given(TRANSITIONS, st.floats(0, PERIOD, exclude_max=True))
def test_a_common_shift_around_the_cycle_changes_no_count(
    transitions: list[tuple[int, float, str]], shift: float
) -> None:
    moved = [(cell, (time + shift) % PERIOD, kind) for cell, time, kind in transitions]
    assert match_transitions(moved, moved, PERIOD).missed == ()
