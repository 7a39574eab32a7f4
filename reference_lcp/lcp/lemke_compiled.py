"""Lemke's method of `reference_lcp.lcp.lemke`, compiled: the same scaling, path, ties and check.

`lemke` is the one to read; this one is for problems that come by the million. Both follow the same
path and give the same basis, which the tests show on every class of problem.
"""

from typing import Any

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference_lcp.lcp.lemke import (
    CANCELLATION_TOLERANCE,
    LARGEST_GROWTH,
    PIVOT_TOLERANCE,
    RESIDUAL_TOLERANCE,
    ROUND_OFF,
    SCALING_SWEEPS,
    TIE_TOLERANCE,
    LemkeResult,
    LemkeStatus,
    checked_basis,
    checked_problem,
    default_pivot_limit,
)
from reference_lcp.validation import checked_count

_STATUS = (
    LemkeStatus.SOLVED,
    LemkeStatus.RAY_TERMINATION,
    LemkeStatus.PIVOT_LIMIT,
    LemkeStatus.NUMERICAL_BREAKDOWN,
)
_SOLVED, _RAY, _LIMIT, _BREAKDOWN = range(4)


def lemke_compiled(
    M: ArrayLike, q: ArrayLike, *, max_pivots: int | None = None, warm_start: NDArray[np.bool_] | None = None
) -> LemkeResult:
    """Solve LCP(q, M) as `reference_lcp.lcp.lemke.lemke` does, compiled.

    Parameters and results are those of `lemke`, with the covering vector of ones.

    Raises
    ------
    ParameterError
        As `lemke`.
    """
    matrix, vector = checked_problem(M, q)
    limit = default_pivot_limit(vector.size) if max_pivots is None else checked_count("max_pivots", max_pivots)
    start = np.zeros(0, dtype=np.bool_) if warm_start is None else checked_basis(warm_start, vector.size)
    z, w, pivots, code, residual, basic = solve_lcp(np.ascontiguousarray(matrix), vector, limit, start)
    return LemkeResult(z, w, pivots, _STATUS[code], residual, basic)


@numba.njit(cache=True, error_model="numpy")
def solve_lcp(M: Any, q: Any, limit: int, warm_start: Any) -> Any:
    """Solve one problem; for compiled callers.

    Gives z, w, pivots, status code (0 solved, 1 ray, 2 pivot limit, 3 breakdown), residual, and which
    z are basic. `M` is C-contiguous float64, shape (n, n); `q` float64, shape (n,); `warm_start` has
    truth values, shape (n,), or is empty.
    """
    n = q.size
    nothing = np.full(n, np.nan)
    if np.all(q >= 0):
        return np.zeros(n), q.copy(), 0, _SOLVED, 0.0, np.zeros(n, dtype=np.bool_)
    rows, columns = _scaling(M)
    if warm_start.size > 0:
        z, w, residual = _answer(M, q, warm_start, rows, columns)
        if residual <= RESIDUAL_TOLERANCE:
            return z, w, 0, _SOLVED, residual, warm_start.copy()
    table = _tableau(M, q, rows, columns)
    basis = np.arange(n)
    code, pivots = _follow_path(table, basis, limit)
    basic = np.zeros(n, dtype=np.bool_)
    if code != _SOLVED:
        return nothing, nothing, pivots, code, np.nan, basic
    for row in range(n):
        if basis[row] >= n:
            basic[basis[row] - n] = True
    z, w, residual = _answer(M, q, basic, rows, columns)
    if not residual <= RESIDUAL_TOLERANCE:
        return nothing, nothing, pivots, _BREAKDOWN, residual, basic
    return z, w, pivots, _SOLVED, residual, basic


@numba.njit(cache=True, error_model="numpy")
def _scaling(M: Any) -> Any:
    """Row and column factors by geometric means; as in `reference_lcp.lcp.lemke`."""
    n = M.shape[0]
    exponents = np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            if M[i, j] != 0:
                exponents[i, j] = np.log2(abs(M[i, j]))
    rows, columns = np.zeros(n), np.zeros(n)
    for _ in range(SCALING_SWEEPS):
        change = 0.0
        for i in range(n):
            rows[i] = -_mean(M[i], exponents[i], columns)
        for j in range(n):
            following = -_mean(M[:, j], exponents[:, j], rows)
            change = max(change, abs(following - columns[j]))
            columns[j] = following
        if change < 1 / 4:
            break
    return np.exp2(np.round(rows)), np.exp2(np.round(columns))


@numba.njit(cache=True, error_model="numpy")
def _mean(entries: Any, exponents: Any, others: Any) -> float:
    """Mean of exponent plus other factor over the entries that are not zero."""
    total, count = 0.0, 0
    for k in range(entries.size):
        if entries[k] != 0:
            total += exponents[k] + others[k]
            count += 1
    return total / max(count, 1)


@numba.njit(cache=True, error_model="numpy")
def _tableau(M: Any, q: Any, rows: Any, columns: Any) -> Any:
    """Columns w | z | z0 | right-hand side of the scaled problem."""
    n = q.size
    table = np.zeros((n, 2 * n + 2))
    size = np.max(np.abs(rows * q))
    for i in range(n):
        table[i, i] = 1.0
        for j in range(n):
            table[i, n + j] = -rows[i] * M[i, j] * columns[j]
        table[i, 2 * n] = -1.0
        table[i, 2 * n + 1] = rows[i] * q[i] / size
    return table


@numba.njit(cache=True, error_model="numpy")
def _follow_path(table: Any, basis: Any, limit: int) -> Any:
    """Pivot until z0 leaves; gives the status code and the number of pivots."""
    n = basis.size
    sizes = np.abs(table[:, : 2 * n])
    first = 0
    for i in range(1, n):
        if table[i, 2 * n + 1] <= table[first, 2 * n + 1]:
            first = i
    leaving, pivots = _exchange(table, basis, first, 2 * n), 1
    while leaving != 2 * n:
        if pivots >= limit:
            return _LIMIT, pivots
        entering = leaving + n if leaving < n else leaving - n
        row = _leaving_row(table, basis, entering, sizes[:, entering])
        if row < 0:
            return _RAY, pivots
        leaving = _exchange(table, basis, row, entering)
        pivots += 1
    return _SOLVED, pivots


@numba.njit(cache=True, error_model="numpy")
def _leaving_row(table: Any, basis: Any, entering: int, sizes: Any) -> int:
    """Lexicographic ratio test; −1 on a ray. `sizes` are those of the entering column as it was at first."""
    n = basis.size
    candidates = np.empty(n, dtype=np.int64)
    count = 0
    for i in range(n):
        terms = 0.0
        for j in range(n):
            terms += abs(table[i, j]) * sizes[j]
        if table[i, entering] > max(PIVOT_TOLERANCE, CANCELLATION_TOLERANCE * terms):
            candidates[count] = i
            count += 1
    if count == 0:
        return -1
    count = _keep_smallest(table, candidates, count, entering, 2 * n + 1)
    for k in range(count):
        if basis[candidates[k]] == 2 * n:
            return candidates[k]
    for column in range(n):
        if count == 1:
            break
        count = _keep_smallest(table, candidates, count, entering, column)
    return candidates[0]


@numba.njit(cache=True, error_model="numpy")
def _keep_smallest(table: Any, candidates: Any, count: int, entering: int, column: int) -> int:
    """Keep the candidates of smallest ratio at the front; gives how many there are."""
    smallest = np.inf
    for k in range(count):
        smallest = min(smallest, table[candidates[k], column] / table[candidates[k], entering])
    kept = 0
    for k in range(count):
        ratio = table[candidates[k], column] / table[candidates[k], entering]
        if ratio <= smallest + TIE_TOLERANCE * max(1.0, abs(smallest)):
            candidates[kept] = candidates[k]
            kept += 1
    return kept


@numba.njit(cache=True, error_model="numpy")
def _exchange(table: Any, basis: Any, row: int, entering: int) -> int:
    """Pivot; gives the variable that leaves."""
    leaving = basis[row]
    pivot = table[row, entering]
    for j in range(table.shape[1]):
        table[row, j] /= pivot
    for i in range(basis.size):
        factor = table[i, entering]
        if i != row and factor != 0:
            for j in range(table.shape[1]):
                table[i, j] -= factor * table[row, j]
    basis[row] = entering
    return leaving


@numba.njit(cache=True, error_model="numpy")
def _answer(M: Any, q: Any, basic: Any, rows: Any, columns: Any) -> Any:
    """Solve the final basis with the unscaled data; gives z, w and the scaled residual."""
    n = q.size
    inside = np.flatnonzero(basic)
    z = np.zeros(n)
    block, right = np.empty((inside.size, inside.size)), np.empty(inside.size)
    for a in range(inside.size):
        right[a] = -q[inside[a]]
        for b in range(inside.size):
            block[a, b] = M[inside[a], inside[b]]
    if not _eliminate(block, right, rows[inside], columns[inside]):
        return z, q, np.nan
    z[inside] = right
    w = M @ z + q
    size, residual = np.max(np.abs(rows * q)), 0.0
    if np.max(np.abs(z / columns)) > LARGEST_GROWTH * size:
        return z, w, np.inf
    least = np.max(np.abs(z / columns)) * (ROUND_OFF / RESIDUAL_TOLERANCE)
    for i in range(n):
        terms = abs(q[i])
        for j in range(n):
            terms += abs(M[i, j]) * max(abs(z[j]), columns[j] * least)
        scaled_w = w[i] / terms if terms > 0 else 0.0
        residual = max(residual, abs(min(z[i] / columns[i] / size, scaled_w)))
        w[i] = 0.0 if basic[i] else max(w[i], 0.0)
        z[i] = max(z[i], 0.0)
    return z, w, residual


@numba.njit(cache=True, error_model="numpy")
def _eliminate(A: Any, b: Any, rows: Any, columns: Any) -> bool:
    """Solve A x = b by elimination with row pivoting, on scaled data, x into b; false if singular."""
    n = b.size
    for i in range(n):
        b[i] *= rows[i]
        for j in range(n):
            A[i, j] *= rows[i] * columns[j]
    for k in range(n):
        largest = k
        for i in range(k + 1, n):
            if abs(A[i, k]) > abs(A[largest, k]):
                largest = i
        if A[largest, k] == 0:
            return False
        if largest != k:
            for j in range(n):
                A[k, j], A[largest, j] = A[largest, j], A[k, j]
            b[k], b[largest] = b[largest], b[k]
        for i in range(k + 1, n):
            factor = A[i, k] / A[k, k]
            b[i] -= factor * b[k]
            for j in range(k, n):
                A[i, j] -= factor * A[k, j]
    _substitute_back(A, b)
    for k in range(n):
        b[k] *= columns[k]
    return True


@numba.njit(cache=True, error_model="numpy")
def _substitute_back(A: Any, b: Any) -> None:
    """Solve A x = b for an upper triangle A, x into b."""
    n = b.size
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            b[k] -= A[k, j] * b[j]
        b[k] /= A[k, k]
