"""A collection of complementarity problems: each solved, or shown to have no solution by going through all cones.

Solvable are all problems with a P-matrix, and those with a copositive-plus matrix (positive semidefinite
ones among them) wherever w = M z + q >= 0, z >= 0 has any solution at all (Cottle, Pang, Stone 1992,
theorems 3.3.7 and 3.8.6). For the rest the oracle decides.
"""

import itertools

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog, nnls

from reference_lcp.lcp.lemke import LemkeStatus, lemke
from reference_lcp.lcp.scaling import power_of_two_scaling

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


def friction_matrix(delassus):
    """[[G, I], [−I, 0]]: copositive-plus for positive semidefinite G."""
    one, zero = np.eye(len(delassus)), np.zeros_like(delassus)
    return np.block([[delassus, one], [-one, zero]])


def rotated(rng, eigenvalues):
    """Symmetric matrix of these eigenvalues in random directions."""
    directions, _ = np.linalg.qr(rng.normal(size=(len(eigenvalues), len(eigenvalues))))
    return directions * eigenvalues @ directions.T


def murty_worst_case(n):
    return np.eye(n) + 2 * np.tril(np.ones((n, n)), -1), -np.cumsum(2.0 ** np.arange(n - 1, -1, -1))


def fathi_worst_case(n):
    """Positive definite and symmetric: L Lᵀ of Murty's triangle (Fathi 1979)."""
    M, _ = murty_worst_case(n)
    return M @ M.T, -np.ones(n)


def obstacle_problem(n):
    """A string over an obstacle: tridiagonal Z-matrix, the smallest of free boundary problems."""
    M = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    return M, M @ np.sin(np.linspace(0, 7, n)) + 0.01


def quadratic_programme(n):
    """Optimality conditions of min ½ xᵀ x − cᵀ x, A x <= b, x >= 0: bisymmetric, copositive-plus."""
    A = np.add.outer(np.arange(1, n + 1), np.arange(n)) % 4 - 1.0
    c = np.arange(n) - n / 3
    return np.block([[np.eye(n), A.T], [-A, np.zeros((n, n))]]), np.concatenate([-c, np.ones(n)])


def linear_programme(n):
    """Conditions of min cᵀ x, A x >= b, x >= 0 with c >= 0: skew-symmetric."""
    A = np.add.outer(np.arange(n), 2 * np.arange(n)) % 5 * 1.0
    zero = np.zeros((n, n))
    return np.block([[zero, -A.T], [A, zero]]), np.concatenate([np.arange(1.0, n + 1), -np.ones(n)])


def named():
    yield "Murty 2.8", [[1, -1, -1, -1], [-1, 1, -1, -1], [1, 1, 2, 0], [1, 1, 0, 2]], [3, 5, -9, -5]
    yield "Murty 2.9", [[-1, 0, -3], [1, -2, -5], [-2, -1, -2]], [-3, -2, -1]
    yield "Murty 2.11", [[-1.5, 2], [-4, 4]], [-5, 17]
    yield "Kostreva 1", [[1, 2, 0], [0, 1, 2], [2, 0, 1]], [-1, -1, -1]
    yield "Kostreva 2", [[1, -1, 3], [2, -1, 3], [-1, -2, 0]], [-1, -1, -1]
    yield "Murty 1.1", [[2, 1], [1, 2]], [-5, -6]
    yield "Cottle, Pang, Stone 4.3.3", [[0, -1, 2], [2, 0, -2], [-1, 1, 0]], [-3, 6, -1]
    yield "q >= 0", [[-1, 0], [0, -1]], [1, 0]
    yield "solution of zeros", [[1, 0], [0, 1]], [-1, 0]
    yield "a single variable", [[2]], [-4]
    yield "w = -1", [[0]], [-1]
    yield "zero matrix, zero vector", np.zeros((3, 3)), np.zeros(3)
    yield "zero matrix, no solution", np.zeros((3, 3)), [1, 0, -1]
    yield "rank one, no solution", np.ones((2, 2)) - [[0, 2], [2, 0]], [-1, -1]
    yield "rank one, degenerate", np.ones((4, 4)), [-1, -1, -1, -1]
    yield "open contact beside a sliding one", [[1.14, -0.19, 0], [-1.17, 1.96, 1], [1, -1, 0]], [1e-3, -3e-5, 0]
    for n in (2, 4, 6, 8):
        yield f"Murty's worst case {n}", *murty_worst_case(n)
        yield f"Fathi's worst case {n}", *fathi_worst_case(n)
    for n in (3, 6, 10, 25):
        yield f"obstacle {n}", *obstacle_problem(n)
    for n in (1, 2, 3, 4, 5):
        yield f"quadratic programme {n}", *quadratic_programme(n)
        yield f"linear programme {n}", *linear_programme(n)
    for n in (2, 4, 6, 8):
        yield f"Hilbert {n}", 1 / (1 + np.add.outer(np.arange(n), np.arange(n))), -np.ones(n)


def random_p(rng, n):
    """Nonsymmetric P-matrix: positive definite plus skew, rows and columns scaled by positive numbers."""
    root, skew = rng.normal(size=(2, n, n))
    M = root @ root.T / n + 0.1 * np.eye(n) + skew - skew.T
    return rng.uniform(0.5, 2, (n, 1)) * M * rng.uniform(0.5, 2, n), 5 * rng.normal(size=n)


def random_psd(rng, n):
    """Positive semidefinite of half rank."""
    root = rng.normal(size=(n, (n + 1) // 2))
    return root @ root.T, rng.normal(size=n)


def random_solvable_psd(rng, n):
    """Positive semidefinite with a solution built in."""
    M, _ = random_psd(rng, n)
    split = rng.uniform(size=n) < 0.5
    z, w = rng.uniform(0, 2, size=(2, n))
    return M, np.where(split, w, 0) - M @ np.where(split, 0, z)


def random_friction(rng, n):
    """Friction of coupled contacts, rigid ones with singular G among them."""
    contacts = max(1, n // 2)
    root = rng.normal(size=(contacts, rng.integers(1, contacts + 2)))
    bounds = rng.uniform(0, 2, contacts) * (rng.uniform(size=contacts) < 0.8)
    return friction_matrix(root @ root.T), np.concatenate([3 * rng.normal(size=contacts), bounds])


def degenerate_integer(rng, n):
    """Positive semidefinite of small integers with ties everywhere."""
    root = rng.integers(-1, 2, size=(n, n)).astype(float)
    return root @ root.T, rng.integers(-2, 3, size=n).astype(float)


def frictional_step(rng, n):
    """Equation (7) for contacts that share a body, some open, friction that follows the normal force."""
    contacts = max(1, n // 3)
    w_n, w_t = rng.normal(size=(2, 3 * contacts, contacts))
    normal, coupled, tangential = w_n.T @ w_n, w_n.T @ w_t, w_t.T @ w_t
    mu, one, zero = 0.2 * np.eye(contacts), np.eye(contacts), np.zeros((contacts, contacts))
    M = np.block(
        [[normal - coupled @ mu, coupled, zero], [coupled.T - tangential @ mu, tangential, one], [2 * mu, -one, zero]]
    )
    gaps = np.where(rng.uniform(size=contacts) < 0.5, 1e-3 * rng.uniform(size=contacts), -1e-6)
    return M, np.concatenate([gaps, 1e-5 * rng.normal(size=contacts), np.zeros(contacts)])


def jams(M):
    """Whether pressing a sliding contact lets it approach all the more (Painlevé 1895).

    Then M is of no class for which Lemke's method is complete: a path may end on a ray beside a solution.
    """
    contacts = len(M) // 3
    return np.min(np.diagonal(M)[:contacts]) < 0


def ill_conditioned(rng, n):
    """Positive definite, condition numbers from 1e8 to 1e10."""
    M = rotated(rng, np.logspace(0, -rng.uniform(8, 10), n))
    return M, M @ rng.normal(size=n)


def badly_scaled(rng, n):
    """A P-matrix in units up to 1e8 apart, row by row and column by column."""
    M, q = random_p(rng, n)
    rows, columns = 10 ** rng.uniform(-8, 8, size=(2, n))
    return rows[:, None] * M * columns, rows * q


FAMILIES = {
    "P": random_p,
    "PSD": random_psd,
    "PSD with a solution": random_solvable_psd,
    "friction": random_friction,
    "degenerate integers": degenerate_integer,
    "equation 7": frictional_step,
    "ill-conditioned": ill_conditioned,
    "badly scaled": badly_scaled,
}
SIZES = (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 10, 9, 8, 7, 6, 5, 4, 14, 20, 30, 3, 2, 6, 8, 50)
ALWAYS_SOLVABLE = {"P", "PSD with a solution", "ill-conditioned", "badly scaled"}


def collection():
    """Every case: name, matrix, vector."""
    for name, M, q in named():
        yield name, np.array(M, dtype=float), np.array(q, dtype=float)
    for number, (family, make) in enumerate(FAMILIES.items()):
        for index, n in enumerate(SIZES):
            yield f"{family} {index}: n = {n}", *make(np.random.default_rng([number, index]), n)


CASES = {name: (M, q) for name, M, q in collection()}


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


def difference_to_expect(M, basic) -> float:
    """Relative difference of two eliminations of one basis: round-off times its condition number, scaled."""
    block = M[np.ix_(basic, basic)]
    if block.size == 0:
        return 0.0
    block = block / np.max(np.abs(block), axis=1)[:, None]
    block = block / np.max(np.abs(block), axis=0)
    return 1e-14 * float(np.linalg.cond(block))


def test_collection_has_at_least_two_hundred_cases() -> None:
    assert len(CASES) >= 200


@pytest.mark.parametrize("name", CASES)
def test_case_is_solved_or_has_no_solution(name) -> None:
    M, q = CASES[name]
    result = checked(M, q)
    if result.solved:
        column = np.max(np.abs(M), axis=0)
        basic, z = result.basic, np.zeros(q.size)
        z[basic] = np.linalg.solve(M[np.ix_(basic, basic)], -q[basic])
        difference = np.abs(z - result.z) * column
        assert np.max(difference) <= difference_to_expect(M, result.basic) * np.max(result.z * column)
    else:
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


@pytest.mark.slow
@pytest.mark.parametrize("n", [1, 2, 3, 5, 8, 12, 16, 21, 25, 50])
@pytest.mark.parametrize("family", ["P", "PSD with a solution"])
def test_problem_has_the_one_w_that_quantecon_finds(family, n) -> None:
    """Of a positive semidefinite symmetric matrix, too, all solutions share their w."""
    from quantecon.optimize import lcp_lemke  # compiles for seconds when it is imported

    for seed in range(10):
        M, q = FAMILIES[family](np.random.default_rng([9, seed]), n)
        result, other = checked(M, q), lcp_lemke(M, q)
        assert result.solved
        assert other.success
        assert M @ other.z + q == pytest.approx(result.w, abs=1e-7 * np.max(np.abs(q)))


def assert_solved_or_rightly_refused(family, seed, n) -> None:
    M, q = FAMILIES[family](np.random.default_rng([10, seed]), n)
    result = checked(M, q)
    if family in ALWAYS_SOLVABLE:
        assert result.solved
    elif not result.solved and not (family == "equation 7" and jams(M)):
        assert_unsolvable(M, q, result)


problems = {"family": st.sampled_from(sorted(FAMILIES)), "seed": st.integers(0, 2**32 - 1), "n": st.integers(1, 12)}


@settings(max_examples=300, deadline=None)
@given(**problems)
def test_random_problem_is_solved_or_has_no_solution(family, seed, n) -> None:
    assert_solved_or_rightly_refused(family, seed, n)


@pytest.mark.slow
@settings(max_examples=10_000, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(**problems)
def test_ten_thousand_random_problems_are_solved_or_have_no_solution(family, seed, n) -> None:
    assert_solved_or_rightly_refused(family, seed, n)


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
