"""Lemke's path from basis to basis, and the check of its solution.

Written once: numba compiles it, and with ``NUMBA_DISABLE_JIT=1`` Python runs the same lines. Loops stand where
expressions of arrays would take seconds longer to compile.

The path follows the bases B of w − M z − d z0 = q. Every column that a decision needs is solved anew with B⁻¹, refined,
and comes with a bound of the error that this leaves: what lies within it is zero, and ratios whose bounds overlap are
tied. So whether an entry may serve as a pivot follows from the basis at hand.
"""

from typing import Any

import numba
import numpy as np

BACKWARD_ERROR = 2.0**-48
"""Relative change of each entry of a system that its computed solution may stand for: 16 units of round-off.

A solution x of B x = a is in error by |B⁻¹| (‖a‖∞ + |B| |x|) times this (Skeel 1979).
"""

MOST_CORRECTIONS = 3
"""Most iterative refinements of a solution; one is enough unless the inverse has drifted, and is then computed anew."""

CLOSE = 2.0**-20
"""Ratios farther apart than this, relative to their size or to one, are no tie; of closer ones the errors decide."""

LARGEST_GROWTH = 1e12
"""Largest scaled z over q of a solution that counts: beyond, q is lost in the round-off of M z."""

ROUND_OFF = 2.0**-53
"""Relative error of an operation."""

EXCLUDED_GROWTH = 1e8
"""Scaled z over q up to which a certificate has to exclude solutions: beyond, half the digits of q are lost in M z."""

RESIDUAL_TOLERANCE = 1e-10
"""Largest residual of a solution that counts: what is missing of w = M z + q over the size of the row's terms."""

VARIABLE_ROUND_OFF = 1e-13
"""Largest error of a variable over the largest one, in scaled and given units: round-off in a basis of condition 1,000.

A row made of terms alone that ought to be zero is compared with what they may carry, not with itself.
"""

SOLVED, NO_SOLUTION, RAY, LIMIT, BREAKDOWN, REPEATED = range(6)
"""Status codes, in the order of `LemkeStatus`."""


_called = numba.njit(cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
"""Compiled for compiled callers alone."""

_inlined = numba.njit(inline="always", error_model="numpy")
"""Compiled as a part of its callers."""


@numba.njit(cache=True, error_model="numpy")
def solve_scaled_lcp(M: Any, q: Any, rows: Any, columns: Any, covering: Any, limit: int, warm_start: Any) -> Any:
    """Solve one problem: from the warm start, in scaled units, in the given units, until one succeeds.

    Gives z, w, pivots, status code, residual, and which z are basic. `M` is C-contiguous float64, shape
    (n, n); `q` float64, shape (n,); `rows` and `columns` are the factors of `power_of_two_scaling`, which depend on M
    alone; `covering` and `warm_start`, of truth values, have shape (n,) or are empty.
    """
    n, solved = q.size, True
    for i in range(n):
        solved = solved and q[i] >= 0
    if solved:
        return np.zeros(n), q.copy(), 0, SOLVED, 0.0, np.zeros(n, dtype=np.bool_)
    pivots, first = 0, (SOLVED, np.nan, np.zeros(n, dtype=np.bool_))
    units = columns
    for path in range(-1 if warm_start.size > 0 else 0, 2):
        basic, code, made = warm_start, SOLVED, 0
        if path == 1:
            rows, columns = np.ones(n), np.ones(n)
        if path >= 0:
            cover = rows * covering if covering.size > 0 else np.ones(n)
            variables, right = _extended_problem(M, q, rows, columns, cover)
            basic, code, made, ray = _follow_path(variables, right, limit)
            if code == RAY and _excludes_solutions(M, q, rows, columns, columns * ray):
                code = NO_SOLUTION
        pivots, residual = pivots + made, np.nan
        if code == SOLVED:
            z, w, residual = _solution(M, q, basic, rows, columns, units)
            if residual <= RESIDUAL_TOLERANCE:
                return z, w, pivots, SOLVED, residual, basic.copy()
            code = BREAKDOWN
        if path == 0 or code == NO_SOLUTION:
            first = (code, residual, basic)
        if code == NO_SOLUTION:
            break
    nothing = np.empty(n)
    for i in range(n):
        nothing[i] = np.nan
    return nothing, nothing, pivots, first[0], first[1], first[2]


@_called
def _excludes_solutions(M: Any, q: Any, rows: Any, columns: Any, y: Any) -> bool:
    """Whether y >= 0 with Mᵀ y <= 0 and qᵀ y < 0 proves that no w = M z + q, z >= 0 has w >= 0 (Farkas).

    As y w = (Mᵀ y) z + q y >= 0, what round-off leaves of (Mᵀ y) above zero allows for none but large z.
    """
    n, against, largest, allowed = q.size, 0.0, 0.0, 0.0
    for j in range(n):
        largest = max(largest, abs(rows[j] * q[j]))
        against -= q[j] * y[j] + n * ROUND_OFF * abs(q[j] * y[j])
        product = 0.0
        for i in range(n):
            product += M[i, j] * y[i] + n * ROUND_OFF * abs(M[i, j] * y[i])
        allowed += columns[j] * max(product, 0.0)
    return against > EXCLUDED_GROWTH * largest * allowed


@_inlined
def _extended_problem(M: Any, q: Any, rows: Any, columns: Any, cover: Any) -> Any:
    """The scaled system w − M z − d z0 = q: row v of the array is the column of variable v, of w, z, z0 in turn."""
    n, largest = q.size, 0.0
    variables, right = np.zeros((2 * n + 1, n)), np.empty(n)
    for i in range(n):
        right[i] = rows[i] * q[i]
        largest = max(largest, abs(right[i]))
        variables[i, i] = 1.0
        variables[2 * n, i] = -cover[i]
        for j in range(n):
            variables[n + j, i] = -rows[i] * M[i, j] * columns[j]
    for i in range(n):
        right[i] /= largest
    return variables, right


@_called
def _follow_path(variables: Any, q: Any, limit: int) -> Any:
    """Pivot until z0 leaves; gives which z are basic, the status code, the number of pivots and the z of a ray.

    Row k of `columns` is the column of B of the variable `basis[k]`; row j of `inverse` is column j of B⁻¹, and its
    last row B⁻¹ q. A basis is compared with that at the last power of two of pivots (Brent 1980).
    """
    n, z0 = q.size, 2 * q.size
    basis, inside = np.empty(n, dtype=np.int64), np.zeros(z0 + 1, dtype=np.bool_)
    columns, inverse = variables[:n].copy(), np.empty((n + 1, n))
    for k in range(n):
        basis[k], inside[k] = k, True
        _write(inverse, k, variables[k])
    _write(inverse, n, q)
    remembered, differences = inside.copy(), 0
    entering, row, x, code, pivots = z0, _first_row(q, variables[z0]), variables[z0].copy(), SOLVED, 0
    ray = np.zeros(n)
    while True:
        leaving = basis[row]
        basis[row] = entering
        _write(columns, row, variables[entering])
        _exchange(inverse, x, row)
        differences += _swap(inside, remembered, leaving) + _swap(inside, remembered, entering)
        pivots += 1
        if leaving == z0:
            break
        if differences == 0 or pivots >= limit:
            code = REPEATED if differences == 0 else LIMIT
            break
        if pivots & (pivots - 1) == 0:
            remembered, differences = inside.copy(), 0
        entering = leaving + n if leaving < n else leaving - n
        row, x = _leaving_row(columns, inverse, basis, q, variables[entering])
        if row < 0:
            code = RAY
            if entering >= n:
                ray[entering - n] = 1.0
            for k in range(n):
                if n <= basis[k] < z0:
                    ray[basis[k] - n] = max(-x[k], 0.0)
            break
    return inside[n:z0].copy(), code, pivots, ray


@_inlined
def _swap(inside: Any, remembered: Any, variable: int) -> int:
    """Let a variable enter or leave; gives by how much the basis differs more from the one remembered."""
    inside[variable] = not inside[variable]
    return 1 if inside[variable] != remembered[variable] else -1


@_inlined
def _write(rows: Any, row: int, values: Any) -> None:
    for i in range(values.size):
        rows[row, i] = values[i]


@_inlined
def _first_row(q: Any, column: Any) -> int:
    """Row of the lexicographically smallest (q_i, e_i) / d_i: there z0 enters, and all rows become >= 0."""
    first = 0
    for i in range(1, q.size):
        if q[i] / -column[i] <= q[first] / -column[first]:
            first = i
    return first


@numba.njit(cache=True, error_model="numpy")
def _leaving_row(columns: Any, inverse: Any, basis: Any, q: Any, entering: Any) -> Any:
    """Lexicographic ratio test: the row that bounds the entering variable, −1 on a ray, and B⁻¹ of its column."""
    n = q.size
    x, error, drifted = _solved(columns, inverse, entering)
    if drifted and _invert(columns, inverse, q):
        x, error, drifted = _solved(columns, inverse, entering)
    row, close = _smallest_ratio(inverse[n], x, error)
    if close < 2:
        return row, x
    rows, right = x > error, q.copy()
    for column in range(n + 1):
        value, uncertain, drifted = _solved(columns, inverse, right)
        row, close = _keep_smallest(rows, value, uncertain, x, error)
        for i in range(n):
            if column == 0 and rows[i] and basis[i] == 2 * n:
                return i, x
        if close == 1:
            break
        for i in range(n):
            right[i] = 1.0 if i == column else 0.0
    return row, x


@_called
def _smallest_ratio(value: Any, x: Any, error: Any) -> Any:
    """Row of the smallest ratio value / x where x is above its error, −1 without one, and how many are close to it."""
    row, close = -1, 0
    for i in range(x.size):
        if x[i] > error[i] and (row < 0 or value[i] / x[i] < value[row] / x[row]):
            row = i
    if row >= 0:
        smallest = value[row] / x[row]
        for i in range(x.size):
            if x[i] > error[i] and value[i] / x[i] <= smallest + CLOSE * (1.0 + abs(smallest)):
                close += 1
    return row, close


@_called
def _keep_smallest(rows: Any, value: Any, uncertain: Any, x: Any, error: Any) -> Any:
    """Keep the rows whose ratio value / x may be the smallest, errors considered; gives the first, and how many."""
    n, bound = x.size, np.inf
    margin = np.empty(n)
    for i in range(n):
        if rows[i]:
            margin[i] = (uncertain[i] + abs(value[i] / x[i]) * error[i]) / x[i]
            bound = min(bound, value[i] / x[i] + margin[i])
    first, count = -1, 0
    for i in range(n):
        rows[i] = rows[i] and value[i] / x[i] - margin[i] <= bound
        if rows[i]:
            first = i if first < 0 else first
            count += 1
    return first, count


@_called
def _solved(columns: Any, inverse: Any, right: Any) -> Any:
    """Solve B x = right; gives x, a bound of its error, and whether refinement has failed: B⁻¹ has drifted."""
    n = right.size
    x, rest, size, error = np.zeros(n), np.empty(n), np.empty(n), np.zeros(n)
    _add(x, inverse, right)
    drifted = True
    for _ in range(MOST_CORRECTIONS):
        drifted = not _residual_is_round_off(columns, right, x, rest, size)
        if not drifted:
            break
        _add(x, inverse, rest)
    for k in range(n):
        for i in range(n):
            error[i] += BACKWARD_ERROR * size[k] * abs(inverse[k, i])
    return x, error, drifted


@_called
def _add(x: Any, inverse: Any, right: Any) -> None:
    """Add B⁻¹ right to x."""
    for k in range(right.size):
        if right[k] != 0:
            for i in range(right.size):
                x[i] += right[k] * inverse[k, i]


@_called
def _residual_is_round_off(columns: Any, right: Any, x: Any, rest: Any, size: Any) -> bool:
    """Write right − B x and the size of its terms; whether the one is within `BACKWARD_ERROR` of the other."""
    n, largest = right.size, 0.0
    for i in range(n):
        largest = max(largest, abs(right[i]))
    for i in range(n):
        rest[i], size[i] = right[i], largest
    for k in range(n):
        if x[k] != 0:
            for i in range(n):
                term = x[k] * columns[k, i]
                rest[i] -= term
                size[i] += abs(term)
    within = True
    for i in range(n):
        within = within and abs(rest[i]) <= BACKWARD_ERROR * size[i]
    return within


@_inlined
def _exchange(inverse: Any, x: Any, row: int) -> None:
    """Let B⁻¹ and B⁻¹ q follow where a variable with B⁻¹ a = x takes the place of the one in `row`."""
    for k in range(inverse.shape[0]):
        if inverse[k, row] != 0:
            pivot = inverse[k, row] / x[row]
            for i in range(x.size):
                inverse[k, i] -= pivot * x[i]
            inverse[k, row] = pivot


@_called
def _invert(columns: Any, inverse: Any, q: Any) -> bool:
    """Compute B⁻¹ and B⁻¹ q anew by elimination; false, and nothing done, if B is singular."""
    n = q.size
    matrix, right = np.empty((n, n)), np.zeros((n, n + 1))
    for i in range(n):
        right[i, i], right[i, n] = 1.0, q[i]
        for k in range(n):
            matrix[i, k] = columns[k, i]
    if not _eliminate(matrix, right):
        return False
    for k in range(n + 1):
        for i in range(n):
            inverse[k, i] = right[i, k]
    return True


@_called
def _solution(M: Any, q: Any, basic: Any, rows: Any, columns: Any, units: Any) -> Any:
    """Solve a basis with the unscaled data, refined once, negative z set to zero; gives z, w and the residual."""
    n, inside = q.size, np.nonzero(basic)[0]
    z, w, size = np.zeros(n), q.copy(), 0.0
    for k in range(n):
        size = max(size, abs(rows[k] * q[k]))
    block, inverse = np.empty((inside.size, inside.size)), np.eye(inside.size)
    for a, i in enumerate(inside):
        for b, j in enumerate(inside):
            block[a, b] = M[i, j] * rows[i] * columns[j]
    if not _eliminate(block, inverse):
        return z, w, np.nan
    for _ in range(2):
        for a, i in enumerate(inside):
            for b, j in enumerate(inside):
                z[i] -= columns[i] * inverse[a, b] * rows[j] * w[j]
        _write_product(M, q, z, w)
    for i in inside:
        if not z[i] / columns[i] <= LARGEST_GROWTH * size:  # NaN of a singular basis too
            return z, w, np.inf
        z[i] = max(z[i], 0.0)
    return z, w, _residual(M, q, z, w, basic, units)


@_inlined
def _write_product(M: Any, q: Any, z: Any, w: Any) -> None:
    """Write M z + q into w."""
    for i in range(q.size):
        w[i] = q[i]
        for j in range(q.size):
            w[i] += M[i, j] * z[j]


@_called
def _residual(M: Any, q: Any, z: Any, w: Any, basic: Any, units: Any) -> float:
    """Write w >= 0; gives the largest part of M z + q that it leaves out, over the size of the row's terms."""
    n, residual, largest, largest_scaled = q.size, 0.0, 0.0, 0.0
    _write_product(M, q, z, w)
    for j in range(n):
        largest, largest_scaled = max(largest, z[j]), max(largest_scaled, z[j] / units[j])
    for i in range(n):
        terms = abs(q[i])
        for j in range(n):
            unsure = min(largest, units[j] * largest_scaled) * (VARIABLE_ROUND_OFF / RESIDUAL_TOLERANCE)
            terms += abs(M[i, j]) * max(z[j], unsure)
        missing = abs(w[i]) if basic[i] else max(-w[i], 0.0)
        if missing > 0:
            residual = max(residual, missing / terms)
        w[i] = 0.0 if basic[i] else max(w[i], 0.0)
    return residual


@_called
def _eliminate(A: Any, b: Any) -> bool:
    """Solve A x = b, b of shape (n, m), by elimination with row pivoting, x into b; false if A is singular."""
    n = A.shape[0]
    for k in range(n):
        largest = k
        for i in range(k + 1, n):
            if abs(A[i, k]) > abs(A[largest, k]):
                largest = i
        if A[largest, k] == 0:
            return False
        if largest != k:
            _swap_rows(A, k, largest)
            _swap_rows(b, k, largest)
        for i in range(k + 1, n):
            factor = A[i, k] / A[k, k]
            if factor != 0:
                _subtract(A, i, factor, k)
                _subtract(b, i, factor, k)
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            _subtract(b, k, A[k, j], j)
        for j in range(b.shape[1]):
            b[k, j] /= A[k, k]
    return True


@_called
def _swap_rows(A: Any, first: int, second: int) -> None:
    for j in range(A.shape[1]):
        A[first, j], A[second, j] = A[second, j], A[first, j]


@_called
def _subtract(A: Any, row: int, factor: float, other: int) -> None:
    for j in range(A.shape[1]):
        A[row, j] -= factor * A[other, j]
