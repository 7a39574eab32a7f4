"""The first root of a polynomial on [0, 1], none ever missed: Bernstein coefficients and Descartes' rule.

A polynomial on [0, 1] has at most as many roots there as its Bernstein coefficients have changes of sign, and exactly
one where they have one (Farouki, "The Bernstein polynomial basis: a centennial retrospective", 2012). An interval
without a root is thus proven to have none; every other one is halved, left half first, until one change is left.
"""

from typing import Any

import numba
import numpy as np

HALVINGS = 48
"""Halvings after which an interval that still cannot be proven free of roots counts as one: the polynomial nearly
touches zero."""

ROOT_TOLERANCE = 1e-15
"""Accuracy of a root, a few units of round-off of the interval's length one."""

_called = numba.njit(cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)


@numba.njit(cache=True, error_model="numpy")
def first_roots(coefficients: Any) -> Any:
    """First root on (0, 1] of every column of coefficients of 1, s, … s^N, shape (N + 1, m); inf without one.

    Each polynomial is positive just behind s = 0, where it may itself be zero only after the caller has divided the
    factor s out.
    """
    roots = np.empty(coefficients.shape[1])
    for column in range(roots.size):
        roots[column] = first_root(coefficients[:, column].copy())
    return roots


@_called
def first_root(coefficients: Any) -> float:
    """First root of one polynomial, of coefficients (N + 1,); the stack holds intervals, the leftmost on top."""
    least = coefficients[0]
    for k in range(1, coefficients.size):
        least += min(coefficients[k], 0.0)
    if least > 0:
        return np.inf  # no Bernstein coefficient is below that sum
    stack = np.empty((HALVINGS + 2, coefficients.size))
    starts, widths = np.empty(HALVINGS + 2), np.empty(HALVINGS + 2)
    starts[0], widths[0] = 0.0, 1.0
    _to_bernstein(coefficients, stack[0])
    top = 0
    while top >= 0:
        values, start, width = stack[top], starts[top], widths[top]
        if _least(values) > 0:
            top -= 1
            continue
        if values[0] <= 0 or width <= 2.0**-HALVINGS:
            return start
        if values[-1] < 0 and _sign_changes(values) == 1:
            root = _single_root(coefficients, start, start + width)
            if root >= 0:
                return root
        _halve(values, stack[top + 1])
        starts[top], starts[top + 1] = start + width / 2, start
        widths[top] = widths[top + 1] = width / 2
        top += 1
    return np.inf


@_called
def _to_bernstein(coefficients: Any, values: Any) -> None:
    """Σ_k C(j, k) / C(N, k) a_k for every j, with sums as in Pascal's triangle."""
    degree = coefficients.size - 1
    binomial = 1.0
    for k in range(degree + 1):
        values[k] = coefficients[k] / binomial
        binomial = binomial * (degree - k) / (k + 1)
    for level in range(degree):
        for j in range(degree, level, -1):
            values[j] += values[j - 1]


@_called
def _halve(values: Any, left: Any) -> None:
    """De Casteljau's means: the Bernstein coefficients of the left half, and those of the right one in place."""
    for level in range(values.size):
        left[level] = values[0]
        for j in range(values.size - 1 - level):
            values[j] = (values[j] + values[j + 1]) / 2


@_called
def _least(values: Any) -> float:
    least = np.inf
    for value in values:
        least = min(least, value)
    return least


@_called
def _sign_changes(values: Any) -> int:
    """Changes of sign from one value to the next, but for zeros; the first is positive."""
    changes, negative = 0, False
    for value in values:
        if value != 0 and (value < 0) != negative:
            changes += 1
            negative = not negative
    return changes


@_called
def _single_root(coefficients: Any, start: float, end: float) -> float:
    """Root in an interval that holds exactly one, or −1 where round-off at its end makes that doubtful."""
    # Horner's rule and the Bernstein form round differently. A zero at the start is the first root; one at
    # the end may be the second of a pair, and only smaller intervals separate them.
    if _value_and_slope(coefficients, start)[0] <= 0:
        return start
    if _value_and_slope(coefficients, end)[0] >= 0:
        return -1.0
    low, high, root = start, end, (start + end) / 2
    step = before = end - start
    while abs(step) > ROOT_TOLERANCE:
        value, slope = _value_and_slope(coefficients, root)
        if value > 0:
            low = root
        else:
            high = root
        # Newton's step, where it stays inside and at least halves the step before the last one
        before, step = step, -value / slope if slope < 0 else np.inf
        if not (low <= root + step <= high and abs(step) <= abs(before) / 2):
            step = (low + high) / 2 - root
        root += step
    return root


@_called
def _value_and_slope(coefficients: Any, s: float) -> Any:
    """Horner's rule."""
    value = slope = 0.0
    for k in range(coefficients.size - 1, -1, -1):
        slope = slope * s + value
        value = value * s + coefficients[k]
    return value, slope
