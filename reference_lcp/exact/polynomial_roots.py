"""The first root of a polynomial on [0, 1], none ever missed: Bernstein coefficients and Descartes' rule.

A polynomial on [0, 1] has at most as many roots there as its Bernstein coefficients have changes of sign, and exactly
one where they have one (Farouki, "The Bernstein polynomial basis: a centennial retrospective", 2012). An interval
without a root is thus proven to have none; every other one is halved, left half first, until one change is left.
"""

from functools import cache
from math import comb

import numpy as np
from scipy.optimize import brentq

from reference_lcp.validation import FloatArray

SMALLEST_INTERVAL = 2.0**-48
"""Width at which an interval that still cannot be proven free of roots counts as one: the polynomial nearly touches."""

ROOT_TOLERANCE = 1e-15
"""Accuracy of a root, a few units of round-off of the interval's length one."""


@cache
def _matrices(degree: int) -> tuple[FloatArray, FloatArray]:
    """Matrices from coefficients of 1, s, … s^N to Bernstein coefficients, and from these to those on [0, 1/2]."""
    orders = range(degree + 1)
    bernstein = [[comb(j, k) / comb(degree, k) for k in orders] for j in orders]
    left_half = [[comb(j, k) / 2.0**j for k in orders] for j in orders]
    return np.array(bernstein), np.array(left_half)


def first_roots(coefficients: FloatArray) -> FloatArray:
    """First root on (0, 1] of every column of coefficients of 1, s, … s^N, shape (N + 1, m); inf without one.

    Each polynomial is positive just behind s = 0, where it may itself be zero only after the caller has divided the
    factor s out.
    """
    bernstein = _matrices(coefficients.shape[0] - 1)[0] @ coefficients
    roots = np.full(coefficients.shape[1], np.inf)
    for column in np.flatnonzero(np.min(bernstein, axis=0) <= 0):
        roots[column] = _first_root(coefficients[:, column], bernstein[:, column])
    return roots


def _first_root(coefficients: FloatArray, bernstein: FloatArray) -> float:
    """First root of one polynomial; the stack holds intervals, the leftmost on top."""
    half = _matrices(bernstein.size - 1)[1]
    stack = [(0.0, 1.0, bernstein)]
    while stack:
        start, width, values = stack.pop()
        if np.min(values) > 0:
            continue
        if values[0] <= 0 or width <= SMALLEST_INTERVAL:
            return start
        negative = values[values != 0] < 0
        if values[-1] < 0 and np.count_nonzero(negative[1:] != negative[:-1]) == 1:
            root = _single_root(coefficients, start, start + width)
            if root is not None:
                return root
        stack.append((start + width / 2, width / 2, (half @ values[::-1])[::-1]))
        stack.append((start, width / 2, half @ values))
    return np.inf


def _single_root(coefficients: FloatArray, start: float, end: float) -> float | None:
    """Root in an interval that holds exactly one, or nothing where round-off at its end makes that doubtful."""
    highest_first = coefficients[::-1].tolist()

    def value(s: float) -> float:
        result = 0.0
        for coefficient in highest_first:
            result = result * s + coefficient
        return result

    # Horner's rule and the Bernstein form round differently. A zero at the start is the first root; one at
    # the end may be the second of a pair, and only smaller intervals separate them.
    if value(start) <= 0:
        return start
    if value(end) >= 0:
        return None
    return float(brentq(value, start, end, xtol=ROOT_TOLERANCE, rtol=4 * np.finfo(float).eps))
