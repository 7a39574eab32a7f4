"""Lemke's complementary pivoting method, with lexicographic ratio test.

The linear complementarity problem LCP(q, M): find w, z >= 0 with w = M z + q and wᵀ z = 0.
Lemke (1965); Cottle, Pang, Stone, "The Linear Complementarity Problem" (1992), algorithm 4.4.5 and
section 4.9 (lexicographic degeneracy resolution). The method itself is in `reference_lcp.lcp.pivoting`.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference_lcp.errors import ParameterError
from reference_lcp.lcp.pivoting import solve_scaled_lcp
from reference_lcp.lcp.scaling import power_of_two_scaling
from reference_lcp.validation import FloatArray, checked_array, checked_count


class LemkeStatus(StrEnum):
    """How Lemke's method ended."""

    SOLVED = "solved"
    NO_SOLUTION = "no solution: a checked certificate excludes every one"
    RAY_TERMINATION = "ray termination: no solution on this path, others may have one"
    PIVOT_LIMIT = "pivot limit reached"
    NUMERICAL_BREAKDOWN = "numerical breakdown: the final basis fails the independent check"
    BASIS_REPEATED = "a basis came back: round-off has decided a pivot"


STATUSES = tuple(LemkeStatus)
"""In the order of the codes of `reference_lcp.lcp.pivoting`."""


@dataclass(frozen=True)
class LemkeResult:
    """Answer of `lemke`."""

    z: FloatArray
    """Shape (n,), as `w`; NaN unless solved."""
    w: FloatArray
    pivots: int
    """Of both paths together."""
    status: LemkeStatus
    residual: float
    """Largest of |w_i − (M z + q)_i| over the size of the row's terms; NaN unless a basis was reached."""
    basic: NDArray[np.bool_]
    """Which z the final basis holds, shape (n,); it warm-starts a similar problem."""

    @property
    def solved(self) -> bool:
        """Whether z and w are a checked solution."""
        return self.status is LemkeStatus.SOLVED


def lemke(
    M: ArrayLike,
    q: ArrayLike,
    *,
    covering: ArrayLike | None = None,
    max_pivots: int | None = None,
    warm_start: NDArray[np.bool_] | None = None,
) -> LemkeResult:
    """Solve w = M z + q, w >= 0, z >= 0, wᵀ z = 0.

    Rows and columns are scaled by powers of two first. Where that path ends without a solution, one in the given
    units follows: among entries of round-off, which ought to be zero, no scaling of units shows what is small. The
    lexicographic ratio test excludes cycling; ties that involve the artificial variable end the path. The solution is
    computed anew from the final basis with the unscaled data, and checked apart from the pivoting: what fails that
    check is never returned as solved.

    Parameters
    ----------
    M
        Shape (n, n).
    q
        Shape (n,).
    covering
        Column d > 0 of the artificial variable, shape (n,): which path is followed depends on it. Ones
        in the units of the path without it.
    max_pivots
        Pivots after which a path is given up; 50 n + 100 without it.
    warm_start
        `LemkeResult.basic` of a similar problem, of the step before, say. Where that basis still gives
        a checked solution no pivot is made; else the path is followed from the start.

    Returns
    -------
    LemkeResult
        `NO_SOLUTION` is proven by y >= 0 with Mᵀ y <= 0 and qᵀ y < 0, from a ray: no z, at least below 1e8 times q
        in scaled units, has M z + q >= 0. For copositive-plus M, among them the friction matrices of equation (7) with
        a given normal force, a ray is such a y but for round-off. Any other status but `SOLVED` leaves it open
        whether there is a solution; it is that of the first path.

    Raises
    ------
    ParameterError
        If shapes do not fit, a value is not finite, `covering` is not > 0, `max_pivots` is below 1 or `warm_start`
        does not have shape (n,).
    """
    matrix, vector = checked_array("M", M), checked_array("q", q)
    size = vector.size
    if vector.ndim != 1 or size == 0 or matrix.shape != (size, size):
        raise ParameterError(f"M and q have shapes {matrix.shape} and {vector.shape}; allowed: (n, n) and (n,), n >= 1")
    # Far beyond the 2 n pivots that are usual.
    limit = 50 * size + 100 if max_pivots is None else checked_count("max_pivots", max_pivots)
    cover = np.zeros(0) if covering is None else checked_array("covering", covering, "> 0", (size,))
    start = np.asarray(() if warm_start is None else warm_start, dtype=np.bool_)
    if warm_start is not None and start.shape != (size,):
        raise ParameterError(f"warm_start has shape {start.shape}; allowed: ({size},)")
    matrix = np.ascontiguousarray(matrix)
    factors = power_of_two_scaling(matrix)
    z, w, pivots, code, residual, basic = solve_scaled_lcp(matrix, vector, *factors, cover, limit, start)
    return LemkeResult(z, w, pivots, STATUSES[code], residual, basic)
