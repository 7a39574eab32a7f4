"""Scaling of a matrix whose rows and columns are in units of their own."""

from typing import Any

import numba
import numpy as np

SCALING_SWEEPS = 50
"""Most sweeps of row and column scaling; problems in sensible units take two or three."""

SMALLEST_SCALED = 2.0**-26
"""Part of the largest entry of its row and of its column below which a scaled entry, which ought to be zero, does not
count for the scaling: the root of round-off."""


@numba.njit(cache=True, error_model="numpy")
def power_of_two_scaling(M: Any) -> Any:
    """Positive row and column factors, powers of two, that bring the entries of M near one."""
    n = M.shape[0]
    counts, exponents = M != 0, np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            if counts[i, j]:
                exponents[i, j] = np.log2(abs(M[i, j]))
    while True:
        rows, columns = _geometric_means(counts, exponents)
        if not _leave_out_small(counts, exponents, rows, columns):
            return np.exp2(np.round(rows)), np.exp2(np.round(columns))


@numba.njit(cache=True, error_model="numpy")
def _geometric_means(counts: Any, exponents: Any) -> Any:
    """Exponents of the row and column factors that bring the mean exponent of each row and column to zero."""
    n = counts.shape[0]
    rows, columns = np.zeros(n), np.zeros(n)
    for _ in range(SCALING_SWEEPS):
        change = 0.0
        for i in range(n):
            rows[i] = -_mean(counts[i], exponents[i], columns)
        for j in range(n):
            following = -_mean(counts[:, j], exponents[:, j], rows)
            change = max(change, abs(following - columns[j]))
            columns[j] = following
        if change < 1 / 4:
            break
    return rows, columns


@numba.njit(cache=True, error_model="numpy")
def _mean(counts: Any, exponents: Any, others: Any) -> float:
    """Mean of exponent plus other factor over the entries that count."""
    total, count = 0.0, 0
    for k in range(counts.size):
        if counts[k]:
            total += exponents[k] + others[k]
            count += 1
    return total / max(count, 1)


@numba.njit(cache=True, error_model="numpy")
def _leave_out_small(counts: Any, exponents: Any, rows: Any, columns: Any) -> bool:
    """Let entries below `SMALLEST_SCALED` of their row and column count no more; whether there are any."""
    n = counts.shape[0]
    in_row, in_column = np.full(n, -np.inf), np.full(n, -np.inf)
    for i in range(n):
        for j in range(n):
            if counts[i, j]:
                scaled = exponents[i, j] + rows[i] + columns[j]
                in_row[i], in_column[j] = max(in_row[i], scaled), max(in_column[j], scaled)
    changed, small = False, np.log2(SMALLEST_SCALED)
    for i in range(n):
        for j in range(n):
            if counts[i, j] and exponents[i, j] + rows[i] + columns[j] < small + min(in_row[i], in_column[j]):
                counts[i, j], changed = False, True
    return changed
