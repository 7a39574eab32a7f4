"""Lemke's method on what the literature prints: solutions, rays, numbers of pivots; and what is refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reference_lcp import ParameterError, lemke
from reference_lcp.lcp.lemke import LemkeStatus
from tests.reference_lcp.lcp.collection import CASES, friction_matrix, murty_worst_case
from tests.reference_lcp.lcp.test_lemke_collection import checked

PRINTED = {
    "Murty 1.1": ([4 / 3, 7 / 3], [0, 0]),
    "Cottle, Pang, Stone 4.3.3": ([0, 1, 3], [2, 0, 0]),
    "Kostreva 1": ([1 / 3, 1 / 3, 1 / 3], [0, 0, 0]),
}

UNSOLVABLE = ("Murty 2.9", "Kostreva 2", "w = -1")


@pytest.mark.parametrize("case", PRINTED)
def test_literature_case_is_solved_as_printed(case) -> None:
    result = checked(*CASES[case])
    assert result.solved
    assert np.allclose([result.z, result.w], PRINTED[case])


@pytest.mark.parametrize("case", UNSOLVABLE)
def test_literature_case_without_a_solution_is_shown_to_have_none(case) -> None:
    result = lemke(*CASES[case])
    assert result.status is LemkeStatus.NO_SOLUTION
    assert np.all(np.isnan(result.z))


def test_ray_of_one_covering_vector_proves_nothing() -> None:
    """Murty 2.11 is solved with ones, and ends on a ray with (5, 16)."""
    result = lemke(*CASES["Murty 2.11"], covering=[5, 16])
    assert result.status is LemkeStatus.RAY_TERMINATION
    assert np.all(np.isnan(result.z))


@pytest.mark.parametrize("n", [3, 5, 8])
def test_murty_1978_worst_case_takes_two_to_the_n_pivots_and_ends(n) -> None:
    """Triangular matrix of twos with q_i = −(2^n + … + 2^(n−i)): Lemke visits 2^n bases."""
    M, q = murty_worst_case(n)
    result = lemke(M, q, covering=np.ones(n), max_pivots=2**n)
    assert (result.status, result.pivots) == (LemkeStatus.SOLVED, 2**n)
    assert np.allclose(result.w, M @ result.z + q, atol=1e-10 * np.max(np.abs(q)))


def test_pivot_limit_is_reported_and_gives_no_numbers() -> None:
    result = lemke(*CASES["Kostreva 1"], max_pivots=1)
    assert result.status is LemkeStatus.PIVOT_LIMIT
    assert np.all(np.isnan(result.w))


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 7), st.floats(-9, 9), st.floats(-9, 9))
def test_units_do_not_matter(seed, contacts, row_power, column_power) -> None:
    """Rows and columns of a friction problem in units up to 1e9 apart: the same solution in those units."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(contacts, contacts))
    M = friction_matrix(root @ root.T + np.eye(contacts))
    q = np.concatenate([5 * rng.normal(size=contacts), np.full(contacts, 1.0)])
    rows = np.repeat(10.0 ** np.array([row_power, -row_power]), contacts)
    columns = np.repeat(10.0 ** np.array([column_power, -column_power]), contacts)
    plain, scaled = lemke(M, q), lemke(rows[:, None] * M * columns, rows * q)
    assert plain.solved
    assert scaled.solved
    assert np.allclose(scaled.z * columns, plain.z, atol=1e-9)


@pytest.mark.parametrize(
    ("M", "q", "covering", "message"),
    [
        ([[1.0, 2.0]], [1.0], None, "shapes"),
        ([[np.nan]], [1.0], None, "M = nan"),
        ([[1.0]], [np.inf], None, "q = inf"),
        (np.zeros((0, 0)), [], None, "n >= 1"),
        (np.eye(2), [-1, -1], [1, 0], "covering = 0"),
    ],
)
def test_impossible_problem_is_refused_with_its_value(M, q, covering, message) -> None:
    with pytest.raises(ParameterError, match=message):
        lemke(M, q, covering=covering)
