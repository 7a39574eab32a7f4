"""Problems on which round-off leads a path astray."""

from pathlib import Path

import numpy as np
import pytest

from reference_lcp.lcp import pivoting
from reference_lcp.lcp.lemke import LemkeStatus, lemke
from tests.reference_lcp.cases import natural_residual

DATA = Path(__file__).parent / "data"
RESIDUAL = 1e-10


def literature_case(name):
    """M, stored column by column, and q of a file of Siconos."""
    numbers = (DATA / name).read_text().split()
    n, values = int(numbers[0]), numbers[6:]
    return np.array(values[: n * n], dtype=float).reshape(n, n).T, np.array(values[n * n : n * n + n], dtype=float)


def test_ties_of_integers_are_broken_as_exact_arithmetic_breaks_them() -> None:
    """Rational numbers take 127 pivots; a tie broken at 1e-13 leads into a circle of four bases from pivot 94."""
    M, q = literature_case("lcp_tobenna.dat")
    result = lemke(M, q)
    assert result.solved
    assert result.pivots == 127
    assert natural_residual(M, q, result.z) <= RESIDUAL


@pytest.mark.parametrize("n", [2, 3, 5])
def test_a_tie_of_all_rows_is_broken_by_the_last_column_that_tells_them_apart(n) -> None:
    """From B = I with q = a_s = 1 the columns e_1, e_2, … each leave one row less, until the last one is left."""
    identity, ones = np.eye(n), np.ones(n)
    row, x = pivoting._leaving_row(identity, np.vstack([identity, ones]), np.arange(n), ones, ones)
    assert row == n - 1
    assert x.tolist() == ones.tolist()


def test_bimatrix_game_has_solutions_that_no_path_finds_and_none_is_made_up() -> None:
    """Its M >= 0 has zero blocks: Lemke's paths all end on rays, which for such M prove nothing."""
    M, q = literature_case("lcp_CPS_3.dat")
    for z in ([1 / 10, 0, 1 / 10, 0], [0, 1 / 15, 0, 1 / 15], [1 / 90, 2 / 45, 1 / 90, 2 / 45]):
        assert natural_residual(M, q, z) <= RESIDUAL
    result = lemke(M, q)
    assert result.status is LemkeStatus.RAY_TERMINATION
    assert np.all(np.isnan(result.z))


def test_a_ray_is_recognised_where_the_last_pivot_left_only_round_off() -> None:
    """Rank 15 of 30: after a pivot of 0.0025 a zero comes out as 1.4e-11, with an error of 1e-10."""
    rng = np.random.default_rng([1, 19])
    root = rng.normal(size=(30, 15))
    assert lemke(root @ root.T, rng.normal(size=30)).status is LemkeStatus.NO_SOLUTION


def test_an_entry_of_round_off_does_not_set_the_scale_of_its_row() -> None:
    """A sliding bead whose G_NT is 1.5e-18 where it ought to be zero: the motion is the same."""
    M = np.array([[1.0, 1.5e-18, 0.0], [-0.4, 1.0, 1.0], [0.8, -1.0, 0.0]])
    q = np.array([-2e-6, 4e-7, 0.0])
    exact = M.copy()
    exact[0, 1] = 0.0
    blurred, clean = lemke(M, q), lemke(exact, q)
    assert blurred.solved
    assert np.allclose(blurred.z, clean.z, rtol=1e-12, atol=1e-18)


def first_of_the_smallest(columns, inverse, basis, q, entering):
    """The ratio test without tie-breaking."""
    x = entering @ inverse[: q.size]
    ratios = np.where(x > 0, inverse[q.size] / np.where(x > 0, x, 1.0), np.inf)
    return int(np.argmin(ratios)), x


def test_a_path_that_comes_back_to_a_basis_is_ended(monkeypatch) -> None:
    """Kostreva (1979), example 1, cycles where ties are not broken."""
    M, q = np.array([[1.0, 2, 0], [0, 1, 2], [2, 0, 1]]), -np.ones(3)
    monkeypatch.setattr(pivoting, "_leaving_row", first_of_the_smallest)
    problem = pivoting._extended_problem(M, q, np.ones(3), np.ones(3), np.ones(3))
    _, code, pivots, _ = pivoting._follow_path.py_func(*problem, 1000)
    assert code == pivoting.REPEATED
    assert pivots < 30
