"""Scaling of a matrix whose rows and columns are in units of their own."""

from typing import Any

import numba
import numpy as np

SCALING_SWEEPS = 50
"""Most sweeps of row and column scaling; problems in sensible units take two or three."""


_called = numba.njit(cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
"""Compiled for compiled callers alone."""


@numba.njit(cache=True, error_model="numpy")
def power_of_two_scaling(M: Any) -> Any:
    """Positive row and column factors, powers of two, that bring the entries of M near one."""
    n = M.shape[0]
    counts, exponents = np.empty((n, n), dtype=np.bool_), np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            counts[i, j] = M[i, j] != 0
            if counts[i, j]:
                exponents[i, j] = np.log2(abs(M[i, j]))
    rows, columns = np.empty(n), np.empty(n)
    _geometric_means(counts, exponents, rows, columns)
    for i in range(n):
        rows[i], columns[i] = np.exp2(np.rint(rows[i])), np.exp2(np.rint(columns[i]))
    return rows, columns


@_called
def _geometric_means(counts: Any, exponents: Any, rows: Any, columns: Any) -> None:
    """Write exponents of the row and column factors that bring the mean exponent of each row and column to zero."""
    n = counts.shape[0]
    for j in range(n):
        columns[j] = 0.0
    for _ in range(SCALING_SWEEPS):
        change = 0.0
        for i in range(n):
            total, count = 0.0, 0
            for j in range(n):
                if counts[i, j]:
                    total += exponents[i, j] + columns[j]
                    count += 1
            rows[i] = -total / max(count, 1)
        for j in range(n):
            total, count = 0.0, 0
            for i in range(n):
                if counts[i, j]:
                    total += exponents[i, j] + rows[i]
                    count += 1
            following = -total / max(count, 1)
            change = max(change, abs(following - columns[j]))
            columns[j] = following
        if change < 1 / 4:
            break
