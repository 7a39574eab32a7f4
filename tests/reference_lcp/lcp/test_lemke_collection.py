"""Each problem of the collection is solved, or shown to have no solution by going through all complementary cones."""

import itertools

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog, nnls

from reference_lcp.lcp.lemke import LemkeStatus, lemke
from reference_lcp.lcp.scaling import power_of_two_scaling
from tests.reference_lcp.lcp.collection import ALWAYS_SOLVABLE, CASES, FAMILIES, frictional_step

RESIDUAL = 1e-10
"""Largest natural residual of a solution, each of its terms over the size of what it is made of."""

ORACLE = 1e-9
"""Distance at which a right-hand side counts as inside a cone; far below the distances of integer problems."""

LARGEST_PART = 1e6
"""Longest solution over its right-hand side that the oracle takes for one; those with a solution have it below 1e4."""

LARGEST_ENUMERATED = 10


def natural_residual_by_rows(M, q, z) -> float:
    """‖min(z, w)‖∞, z over its largest entry and each row of w over the sum of its terms' sizes.

    A term counts for at least a thousandth of the largest z, in units that make its column one: what is
    zero comes out with an error of 1e-13 of it where the basis has a condition of a thousand.
    """
    column = np.where(np.max(np.abs(M), axis=0) > 0, np.max(np.abs(M), axis=0), 1.0)
    largest = max(np.max(z * column), np.finfo(float).tiny)
    terms = np.abs(M) @ np.maximum(z, 1e-3 * largest / column) + np.abs(q)
    w = (M @ z + q) / np.where(terms > 0, terms, 1.0)
    return float(np.max(np.abs(np.minimum(z * column / largest, w))))


def solvable_by_enumeration(M, q) -> bool:
    """Whether q lies in any complementary cone, all 2^n tried by non-negative least squares.

    Singular bases are no exception to it: a cone is searched, not a basis inverted. What least squares finds
    is checked: along a null space it can come back with numbers of 1e15 and no residual.
    """
    rows = np.max(np.abs(M), axis=1)
    M = M / np.where(rows > 0, rows, 1.0)[:, None]
    q = q / np.where(rows > 0, rows, 1.0)
    identity, size = np.eye(q.size), np.linalg.norm(q)
    for basis in itertools.product((False, True), repeat=q.size):
        cone = np.where(basis, -M, identity)
        parts, _ = nnls(cone, q)
        if np.linalg.norm(cone @ parts - q) <= ORACLE * size and np.max(parts) <= LARGEST_PART * size:
            return True
    return False


def feasible(M, q) -> bool:
    """Whether w >= 0 and z >= 0 can hold without complementarity: linear programming decides."""
    return linprog(np.zeros(q.size), A_ub=-M, b_ub=q, method="highs").status == 0


def checked(M, q):
    """Solve, check what counts as solved; gives the result."""
    result = lemke(M, q)
    if not result.solved:
        assert np.all(np.isnan(result.z))
        assert np.all(np.isnan(result.w))
        return result
    assert np.min(result.z) >= 0
    assert np.min(result.w) >= 0
    assert natural_residual_by_rows(M, q, result.z) <= RESIDUAL
    return result


def assert_unsolvable(M, q, result) -> None:
    """A ray or a certificate, and rightly so."""
    assert result.status in (LemkeStatus.RAY_TERMINATION, LemkeStatus.NO_SOLUTION)
    if result.status is LemkeStatus.RAY_TERMINATION and q.size <= LARGEST_ENUMERATED:
        assert not solvable_by_enumeration(M, q)
    else:
        assert not feasible(M, q)


def test_collection_has_at_least_two_hundred_cases() -> None:
    assert len(CASES) >= 200


@pytest.mark.parametrize("name", CASES)
def test_case_is_solved_or_has_no_solution(name) -> None:
    M, q = CASES[name]
    result = checked(M, q)
    if not result.solved:
        assert_unsolvable(M, q, result)


@pytest.mark.parametrize("name", [name for name in CASES if not name.startswith(("Murty", "Kostreva"))])
def test_warm_start_from_the_solution_or_from_anywhere_gives_a_solution_of_the_same_problem(name) -> None:
    M, q = CASES[name]
    cold = lemke(M, q)
    rng = np.random.default_rng(q.size)
    for basis in (cold.basic, rng.uniform(size=q.size) < 0.5, np.ones(q.size, dtype=bool)):
        warm = lemke(M, q, warm_start=basis)
        assert warm.status is cold.status
        if warm.solved:
            assert natural_residual_by_rows(M, q, warm.z) <= RESIDUAL
    if cold.solved and np.any(q < 0):
        assert lemke(M, q, warm_start=cold.basic).pivots == 0


def jams(M) -> bool:
    """Whether pressing a sliding contact lets it approach all the more (Painlevé 1895).

    Then M is of no class for which Lemke's method is complete: 2 of 30,000 problems end on a ray beside a solution.
    """
    return np.min(np.diagonal(M)[: len(M) // 3]) < 0


@pytest.mark.parametrize("examples", [300, pytest.param(10_000, marks=pytest.mark.slow)])
def test_random_problems_are_solved_or_have_no_solution(examples) -> None:
    @settings(max_examples=examples, deadline=None, suppress_health_check=[HealthCheck.too_slow])
    @given(st.sampled_from(sorted(FAMILIES)), st.integers(0, 2**32 - 1), st.integers(1, 12))
    def solved_or_rightly_refused(family, seed, n) -> None:
        M, q = FAMILIES[family](np.random.default_rng([10, seed]), n)
        result = checked(M, q)
        if family in ALWAYS_SOLVABLE:
            assert result.solved
        elif not result.solved and not (family == "equation 7" and jams(M)):
            assert_unsolvable(M, q, result)

    solved_or_rightly_refused()


def test_painleve_configuration_is_solved_in_its_own_units_where_the_scaled_path_ends_on_a_ray() -> None:
    M, q = frictional_step(np.random.default_rng([10, 100748]), 1)
    assert jams(M)
    assert solvable_by_enumeration(M, q)
    rows, _ = power_of_two_scaling(M)
    assert lemke(M, q, covering=1 / rows).status is LemkeStatus.RAY_TERMINATION
    assert checked(M, q).solved


@settings(max_examples=500, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), n=st.integers(1, 10))
def test_matrix_of_no_class_never_gets_a_wrong_solution(seed, n) -> None:
    """Small integers: a path may end on a ray beside a solution, but what it gives is one, or a proof of none."""
    rng = np.random.default_rng(seed)
    M, q = rng.integers(-4, 5, size=(n, n)).astype(float), rng.integers(-4, 5, size=n).astype(float)
    result = checked(M, q)
    if result.status is LemkeStatus.NO_SOLUTION:
        assert not feasible(M, q)
    else:
        assert n > 5 or result.status in (LemkeStatus.SOLVED, LemkeStatus.RAY_TERMINATION)
