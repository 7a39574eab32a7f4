"""Lemke's complementary pivoting method, with lexicographic ratio test.

The linear complementarity problem LCP(q, M): find w, z >= 0 with w = M z + q and wᵀ z = 0.
Lemke (1965); Cottle, Pang, Stone, "The Linear Complementarity Problem" (1992), algorithm 4.4.5 and
section 4.9 (lexicographic degeneracy resolution).
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference_lcp.validation import FloatArray, ParameterError, checked_array, checked_count

PIVOT_TOLERANCE = 1e-11
"""Smallest entry that may serve as a pivot, of a tableau whose rows and columns are scaled to one.

Some 10^4 times the round-off of a well-conditioned tableau of a hundred rows; smaller entries are
taken for zeros that round-off has blurred.
"""

CANCELLATION_TOLERANCE = 1e-13
"""Smallest part of the terms of an entry that their sum may leave for a pivot: some hundred times their round-off.

An entry is the product of a row of the inverse basis and a column of M. In a basis that is nearly singular the
terms are large, and a zero comes out as what cancellation leaves; a pivot on it would "solve" problems that have
no solution, with z some 10^15 long.
"""

LARGEST_GROWTH = 1e12
"""Largest scaled z over q of an answer that counts as solved: beyond, q is lost in the round-off of M z."""

TIE_TOLERANCE = 1e-13
"""Ratios closer than this, relative to their size, count as equal and go to the next lexicographic column."""

RESIDUAL_TOLERANCE = 1e-10
"""Largest natural residual ‖min(z, w)‖∞ of an answer that counts as solved, in scaled variables."""

ROUND_OFF = 1e-13
"""Error that each scaled variable may carry, relative to the largest one: round-off in a basis of condition 1,000.

An open contact has Λ_TR = 2 μ Λ_N = 0, of which the solution of its basis leaves round-off; a row made of such
terms alone is compared with what they may carry, not with itself.
"""

SCALING_SWEEPS = 50
"""Most sweeps of row and column scaling; problems in sensible units take two or three."""


class LemkeStatus(StrEnum):
    """How Lemke's method ended."""

    SOLVED = "solved"
    RAY_TERMINATION = "ray termination: no solution on this path"
    PIVOT_LIMIT = "pivot limit reached"
    NUMERICAL_BREAKDOWN = "numerical breakdown: the final basis fails the independent check"


@dataclass(frozen=True)
class LemkeResult:
    """Answer of `lemke`.

    Parameters
    ----------
    z, w
        The solution, shape (n,); NaN unless solved.
    pivots
        Number of pivots made.
    status
        How the method ended.
    residual
        Natural residual ‖min(z, w)‖∞, with z scaled as in the pivoting and each w_i over the size of the
        terms it is the sum of; NaN unless a basis was reached.
    basic
        Which z the final basis holds, shape (n,); it warm-starts a similar problem.
    """

    z: FloatArray
    w: FloatArray
    pivots: int
    status: LemkeStatus
    residual: float
    basic: NDArray[np.bool_]

    @property
    def solved(self) -> bool:
        """Whether z and w are a checked solution."""
        return self.status is LemkeStatus.SOLVED


def natural_residual(M: ArrayLike, q: ArrayLike, z: ArrayLike) -> float:
    """‖min(z, M z + q)‖∞: zero if and only if z solves LCP(q, M)."""
    z = np.asarray(z, dtype=np.float64)
    w = np.asarray(M, dtype=np.float64) @ z + np.asarray(q, dtype=np.float64)
    return float(np.max(np.abs(np.minimum(z, w)), initial=0.0))


def lemke(
    M: ArrayLike,
    q: ArrayLike,
    *,
    covering: ArrayLike | None = None,
    max_pivots: int | None = None,
    warm_start: NDArray[np.bool_] | None = None,
) -> LemkeResult:
    """Solve w = M z + q, w >= 0, z >= 0, wᵀ z = 0.

    Rows and columns are scaled by powers of two first. The lexicographic ratio test excludes cycling;
    ties that involve the artificial variable end the path. The answer is computed anew from the final
    basis with the unscaled data, and checked apart from the pivoting: what fails that check is never
    returned as solved.

    Parameters
    ----------
    M
        Shape (n, n).
    q
        Shape (n,).
    covering
        Column d > 0 of the artificial variable, shape (n,): which path is followed depends on it. One
        in every row of the scaled problem without it.
    max_pivots
        Pivots after which the method gives up; 50 n + 100 without it.
    warm_start
        `LemkeResult.basic` of a similar problem, of the step before, say. Where that basis still gives
        a checked solution no pivot is made; else the path is followed from the start.

    Returns
    -------
    LemkeResult
        For copositive-plus M, among them the friction matrices of equation (7) with a given normal
        force, ray termination proves that there is no solution; for others that this path has none.

    Raises
    ------
    ParameterError
        If shapes do not fit, a value is not finite, `covering` is not > 0, `max_pivots` is below 1 or
        `warm_start` does not have shape (n,).
    """
    matrix, vector = checked_problem(M, q)
    size = vector.size
    limit = default_pivot_limit(size) if max_pivots is None else checked_count("max_pivots", max_pivots)
    none = np.zeros(size, dtype=np.bool_)
    if np.all(vector >= 0):
        return LemkeResult(np.zeros(size), vector.copy(), 0, LemkeStatus.SOLVED, 0.0, none)
    rows, columns = _scaling(matrix)
    if warm_start is not None:
        result = _answer(matrix, vector, rows, columns, checked_basis(warm_start, size), 0)
        if result.solved:
            return result
    scaled_vector = rows * vector
    cover = np.ones(size) if covering is None else rows * _checked_covering(covering, size)
    tableau = _Tableau(rows[:, None] * matrix * columns, scaled_vector / np.max(np.abs(scaled_vector)), cover)
    status = tableau.pivot_to_solution(limit)
    if status is not LemkeStatus.SOLVED:
        return _unsolved(none, tableau.pivots, status, float("nan"))
    return _answer(matrix, vector, rows, columns, tableau.basic(), tableau.pivots)


def default_pivot_limit(size: int) -> int:
    """Pivots after which a problem of this size is given up: far beyond the 2 n that are usual."""
    return 50 * size + 100


class _Tableau:
    """The dictionary of the extended problem w = M z + q + d z0, with columns w | z | z0 | right-hand side.

    The columns of w start as the identity and stay the inverse of the basis: they serve the
    lexicographic ratio test.
    """

    def __init__(self, M: FloatArray, q: FloatArray, covering: FloatArray):
        size = q.size
        self.size = size
        self.z0 = 2 * size
        self.table = np.hstack([np.eye(size), -M, -covering[:, None], q[:, None]])
        self.sizes = np.hstack([np.eye(size), np.abs(M)])
        self.basis = np.arange(size)
        self.pivots = 0

    def pivot_to_solution(self, limit: int) -> LemkeStatus:
        """Follow Lemke's path until the artificial variable z0 leaves the basis."""
        leaving = self._exchange(self._first_row(), self.z0)
        while leaving != self.z0:
            if self.pivots >= limit:
                return LemkeStatus.PIVOT_LIMIT
            entering = leaving + self.size if leaving < self.size else leaving - self.size
            row = self._leaving_row(entering)
            if row is None:
                return LemkeStatus.RAY_TERMINATION
            leaving = self._exchange(row, entering)
        return LemkeStatus.SOLVED

    def basic(self) -> NDArray[np.bool_]:
        """Which variables z the basis holds."""
        return np.isin(np.arange(self.size, 2 * self.size), self.basis)

    def _first_row(self) -> int:
        """Row of the lexicographically smallest (q_i, e_i) / d_i: there z0 enters, and all rows become >= 0."""
        ratios = self.table[:, -1] / -self.table[:, self.z0]
        tied = np.flatnonzero(ratios == ratios.min())
        return int(tied[-1])

    def _leaving_row(self, entering: int) -> int | None:
        """Lexicographic ratio test: the row that bounds the entering variable, or None on a ray."""
        column = self.table[:, entering]
        terms = np.abs(self.table[:, : self.size]) @ self.sizes[:, entering]
        candidates = np.flatnonzero(column > np.maximum(PIVOT_TOLERANCE, CANCELLATION_TOLERANCE * terms))
        if candidates.size == 0:
            return None
        candidates = self._smallest(candidates, self.table[candidates, -1] / column[candidates])
        artificial = candidates[self.basis[candidates] == self.z0]
        if artificial.size:
            return int(artificial[0])
        for j in range(self.size):
            if candidates.size == 1:
                break
            candidates = self._smallest(candidates, self.table[candidates, j] / column[candidates])
        return int(candidates[0])

    @staticmethod
    def _smallest(candidates: NDArray[np.intp], ratios: FloatArray) -> NDArray[np.intp]:
        smallest = ratios.min()
        return candidates[ratios <= smallest + TIE_TOLERANCE * max(1.0, abs(smallest))]

    def _exchange(self, row: int, entering: int) -> int:
        """Pivot; gives the variable that leaves."""
        leaving = int(self.basis[row])
        self.table[row] /= self.table[row, entering]
        column = self.table[:, entering].copy()
        column[row] = 0.0
        self.table -= np.outer(column, self.table[row])
        self.basis[row] = entering
        self.pivots += 1
        return leaving


def checked_problem(M: ArrayLike, q: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Give M and q as arrays whose shapes fit."""
    matrix, vector = checked_array("M", M), checked_array("q", q)
    if vector.ndim != 1 or vector.size == 0 or matrix.shape != (vector.size, vector.size):
        raise ParameterError(f"M and q have shapes {matrix.shape} and {vector.shape}; allowed: (n, n) and (n,), n >= 1")
    return matrix, vector


def _checked_covering(covering: ArrayLike, size: int) -> FloatArray:
    """Give the covering vector as an array."""
    cover = checked_array("covering", covering, "> 0")
    if cover.shape != (size,):
        raise ParameterError(f"covering has shape {cover.shape}; allowed: ({size},)")
    return cover


def checked_basis(basic: NDArray[np.bool_], size: int) -> NDArray[np.bool_]:
    """Give a warm start's basis as an array of truth values."""
    basis = np.asarray(basic, dtype=np.bool_)
    if basis.shape != (size,):
        raise ParameterError(f"warm_start has shape {basis.shape}; allowed: ({size},)")
    return basis


def _scaling(M: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positive row and column factors, powers of two, that bring all nonzero entries of M near one.

    Geometric means of rows and columns in turn (Curtis and Reid 1972): largest entries alone would
    leave a small pivot beside a large one. Scaling by positive diagonals leaves complementarity as
    it is; powers of two leave no round-off.
    """
    present = M != 0
    exponents = np.log2(np.abs(M), where=present, out=np.zeros_like(M))
    in_row, in_column = np.maximum(present.sum(axis=1), 1), np.maximum(present.sum(axis=0), 1)
    rows, columns = np.zeros(in_row.size), np.zeros(in_column.size)
    for _ in range(SCALING_SWEEPS):
        rows = -(exponents + present * columns).sum(axis=1) / in_row
        following = -(exponents + present * rows[:, None]).sum(axis=0) / in_column
        change, columns = np.max(np.abs(following - columns)), following
        if change < 1 / 4:
            break
    return np.exp2(np.round(rows)), np.exp2(np.round(columns))


def _scaled_residual(M: FloatArray, q: FloatArray, z: FloatArray, rows: FloatArray, columns: FloatArray) -> float:
    """Natural residual with each row of M z + q over the size of its terms: no row can hide behind a larger one.

    `RESIDUAL_TOLERANCE` of what each term counts for at least is its round-off. Infinite where q is lost in M z.
    """
    scaled_z = z / columns / np.max(np.abs(rows * q))
    if np.max(np.abs(scaled_z)) > LARGEST_GROWTH:
        return float("inf")
    least = columns * np.max(np.abs(z / columns)) * (ROUND_OFF / RESIDUAL_TOLERANCE)
    terms = np.abs(M) @ np.maximum(np.abs(z), least) + np.abs(q)
    scaled_w = (M @ z + q) / np.where(terms > 0, terms, 1.0)
    return float(np.max(np.abs(np.minimum(scaled_z, scaled_w))))


def _answer(
    M: FloatArray, q: FloatArray, rows: FloatArray, columns: FloatArray, basic: NDArray[np.bool_], pivots: int
) -> LemkeResult:
    """Solve a basis with the unscaled data, and check the answer in scaled variables."""
    z, w = np.zeros(q.size), np.zeros(q.size)
    residual = float("nan")
    try:
        z[basic] = np.linalg.solve(M[np.ix_(basic, basic)], -q[basic])
        w[~basic] = M[np.ix_(~basic, basic)] @ z[basic] + q[~basic]
        residual = _scaled_residual(M, q, z, rows, columns)
    except np.linalg.LinAlgError:
        pass
    if not residual <= RESIDUAL_TOLERANCE:
        return _unsolved(basic, pivots, LemkeStatus.NUMERICAL_BREAKDOWN, residual)
    return LemkeResult(np.maximum(z, 0.0), np.maximum(w, 0.0), pivots, LemkeStatus.SOLVED, residual, basic)


def _unsolved(basic: NDArray[np.bool_], pivots: int, status: LemkeStatus, residual: float) -> LemkeResult:
    """Give a result without numbers."""
    nothing = np.full(basic.size, np.nan)
    return LemkeResult(nothing, nothing, pivots, status, residual, basic)
