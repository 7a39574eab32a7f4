"""Lemke's method on cases of the literature, against an enumeration of all bases and against QuantEcon's."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from quantecon.optimize import lcp_lemke

from reference_lcp import ParameterError, lemke
from reference_lcp.lcp.lemke import LemkeStatus
from tests.reference_lcp.cases import natural_residual

RESIDUAL = 1e-10
"""Natural residual of a solved problem of order one: round-off of a few pivots is below 1e-13."""


def assert_solves(M, q, result) -> None:
    assert result.status is LemkeStatus.SOLVED
    scale = max(1.0, float(np.max(np.abs(q))))
    assert np.all(result.z >= 0)
    assert np.all(result.w >= 0)
    assert np.allclose(result.w, np.asarray(M) @ result.z + q, atol=RESIDUAL * scale)
    assert natural_residual(M, q, result.z) <= RESIDUAL * scale


def solvable_by_enumeration(M, q) -> bool:
    """Whether any complementary basis is feasible."""
    n = len(q)
    for basis in itertools.product((False, True), repeat=n):
        inside = np.array(basis)
        z = np.zeros(n)
        if inside.any():
            block = M[np.ix_(inside, inside)]
            if np.linalg.matrix_rank(block) < inside.sum():
                continue
            z[inside] = np.linalg.solve(block, -q[inside])
        if np.all(z >= -1e-9) and np.all(M @ z + q >= -1e-9):
            return True
    return False


SOLVABLE = {
    "Murty 1988, example 2.8": ([[1, -1, -1, -1], [-1, 1, -1, -1], [1, 1, 2, 0], [1, 1, 0, 2]], [3, 5, -9, -5]),
    "Kostreva 1979, example 1: cycles without tie-breaking": ([[1, 2, 0], [0, 1, 2], [2, 0, 1]], [-1, -1, -1]),
    "Murty 1988, example 2.11, covering vector of ones": ([[-1.5, 2], [-4, 4]], [-5, 17]),
    "Murty 1988, section 1.1, a P-matrix": ([[2, 1], [1, 2]], [-5, -6]),
    "Cottle, Pang, Stone 1992, example 4.3.3": ([[0, -1, 2], [2, 0, -2], [-1, 1, 0]], [-3, 6, -1]),
    "zero vector in reach: q >= 0": ([[-1, 0], [0, -1]], [1, 0]),
    "degenerate: the solution has z = w = 0": ([[1, 0], [0, 1]], [-1, 0]),
    "a single variable": ([[2]], [-4]),
}

RAYS = {
    "Murty 1988, example 2.9": ([[-1, 0, -3], [1, -2, -5], [-2, -1, -2]], [-3, -2, -1], None),
    "Kostreva 1979, example 2: cycles untied": ([[1, -1, 3], [2, -1, 3], [-1, -2, 0]], [-1, -1, -1], None),
    "Murty 1988, example 2.11, its covering vector": ([[-1.5, 2], [-4, 4]], [-5, 17], [5, 16]),
    "no solution at all: w = -1": ([[0]], [-1], None),
}


@pytest.mark.parametrize("case", SOLVABLE)
def test_literature_case_is_solved(case) -> None:
    M, q = (np.array(part, dtype=float) for part in SOLVABLE[case])
    assert_solves(M, q, lemke(M, q))


def test_printed_solutions_are_found() -> None:
    printed = {
        "Murty 1988, section 1.1, a P-matrix": ([4 / 3, 7 / 3], [0, 0]),
        "Cottle, Pang, Stone 1992, example 4.3.3": ([0, 1, 3], [2, 0, 0]),
        "Kostreva 1979, example 1: cycles without tie-breaking": ([1 / 3, 1 / 3, 1 / 3], [0, 0, 0]),
    }
    for case, (z, w) in printed.items():
        result = lemke(*SOLVABLE[case])
        assert result.z == pytest.approx(z)
        assert result.w == pytest.approx(w)


@pytest.mark.parametrize("case", RAYS)
def test_literature_case_ends_on_a_ray(case) -> None:
    M, q, covering = RAYS[case]
    result = lemke(M, q, covering=covering)
    assert result.status is LemkeStatus.RAY_TERMINATION
    assert np.all(np.isnan(result.z))


@pytest.mark.parametrize("n", [3, 5, 8])
def test_murty_1978_worst_case_takes_two_to_the_n_pivots_and_ends(n) -> None:
    """Triangular matrix of twos with q_i = −(2^n + … + 2^(n−i)): Lemke visits 2^n bases."""
    M = np.eye(n) + 2 * np.tril(np.ones((n, n)), -1)
    q = -np.cumsum(2.0 ** np.arange(n - 1, -1, -1))
    result = lemke(M, q, covering=np.ones(n), max_pivots=2**n)
    assert_solves(M, q, result)
    assert result.pivots == 2**n


def test_pivot_limit_is_reported_and_gives_no_numbers() -> None:
    M, q = SOLVABLE["Kostreva 1979, example 1: cycles without tie-breaking"]
    result = lemke(M, q, max_pivots=1)
    assert result.status is LemkeStatus.PIVOT_LIMIT
    assert np.all(np.isnan(result.w))


matrices = st.integers(1, 5).flatmap(
    lambda n: st.tuples(
        st.lists(st.integers(-4, 4), min_size=n * n, max_size=n * n).map(lambda x: np.reshape(x, (n, n)) * 1.0),
        st.lists(st.integers(-4, 4), min_size=n, max_size=n).map(lambda x: np.array(x) * 1.0),
    )
)


@settings(max_examples=400, deadline=None)
@given(matrices)
def test_small_integers_degenerate_as_they_come_never_give_a_wrong_solution(problem) -> None:
    M, q = problem
    result = lemke(M, q)
    assert result.status in (LemkeStatus.SOLVED, LemkeStatus.RAY_TERMINATION)
    if result.solved:
        assert_solves(M, q, result)


@settings(max_examples=300, deadline=None)
@given(matrices)
def test_positive_semidefinite_matrix_ray_means_that_no_basis_is_feasible(problem) -> None:
    root, q = problem
    M = root.T @ root
    result = lemke(M, q)
    assert result.solved == solvable_by_enumeration(M, q)


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 21))
def test_positive_definite_nonsymmetric_has_the_one_solution_that_quantecon_finds(seed, n) -> None:
    rng = np.random.default_rng(seed)
    root, skew = rng.normal(size=(2, n, n))
    M = root @ root.T + np.eye(n) + skew - skew.T
    q = 10 * rng.normal(size=n)
    result, other = lemke(M, q), lcp_lemke(M, q)
    assert_solves(M, q, result)
    assert np.allclose(result.z, other.z, atol=1e-8)


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 7), st.floats(-9, 9), st.floats(-9, 9))
def test_units_do_not_matter(seed, contacts, row_power, column_power) -> None:
    """Rows and columns of a friction problem in units up to 1e9 apart: the same solution in those units."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(contacts, contacts))
    delassus = root @ root.T + np.eye(contacts)
    one, zero = np.eye(contacts), np.zeros((contacts, contacts))
    M = np.block([[delassus, one], [-one, zero]])
    q = np.concatenate([5 * rng.normal(size=contacts), np.full(contacts, 1.0)])
    rows = np.repeat(10.0 ** np.array([row_power, -row_power]), contacts)
    columns = np.repeat(10.0 ** np.array([column_power, -column_power]), contacts)
    plain, scaled = lemke(M, q), lemke(rows[:, None] * M * columns, rows * q)
    assert plain.solved
    assert scaled.solved
    assert np.allclose(scaled.z * columns, plain.z, atol=1e-9)


@pytest.mark.parametrize(
    ("M", "q", "message"),
    [
        ([[1.0, 2.0]], [1.0], "shapes"),
        ([[np.nan]], [1.0], "M = nan"),
        ([[1.0]], [np.inf], "q = inf"),
        (np.zeros((0, 0)), [], "n >= 1"),
    ],
)
def test_impossible_problem_is_refused_with_its_value(M, q, message) -> None:
    with pytest.raises(ParameterError, match=message):
        lemke(M, q)


def test_covering_vector_must_be_positive() -> None:
    with pytest.raises(ParameterError, match="covering = 0"):
        lemke(np.eye(2), [-1, -1], covering=[1, 0])
