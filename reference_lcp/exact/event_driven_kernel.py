"""Compiled loops from event to event: consistent modes, the series from there, and where it ends.

At every start of a stretch each contact at rest (ġ_T = 0) is given the mode that Coulomb's law allows. With λ* the
force that would keep the contact at rest, it sticks if |λ*| < μ λ_N, and if not it slips against λ*. Where |λ*| = μ λ_N
the first derivative of λ* that differs from zero decides: outwards it slips, inwards it sticks. A derivative of order k
depends on the modes of other contacts only through orders below k; deciding the lowest order first is therefore
consistent (cf. Pfeiffer and Glocker, "Multibody dynamics with unilateral contacts", 1996).
"""

import math
from typing import Any, NamedTuple, Self

import numba
import numpy as np
from numpy.typing import NDArray

from reference_lcp.exact.mode_dynamics import (
    BOUND,
    CHAIN_DAMPING,
    CHAIN_STIFFNESS,
    INNER_DAMPING,
    INNER_SHARE,
    INNER_STIFFNESS,
    SERIES_ORDER,
    continue_series,
    evaluate,
)
from reference_lcp.exact.polynomial_roots import first_root
from reference_lcp.validation import FloatArray

REST_TOLERANCE = 1e-13
"""Relative velocity, over the largest velocity of the motion, at which a contact counts as at rest."""

FORCE_TOLERANCE = 1e-12
"""Distance of a sticking force from its bound, over the forces it is made up of, that counts as none."""

TIME, EVENTS, COUNTED_FROM = range(3)
"""Where a clock has the time [s], and the changes of mode since another time, at most one span ago."""


class Record(NamedTuple):
    """Rows of consecutive segments, see `mode_dynamics.Segment`."""

    start: FloatArray
    duration: FloatArray
    coefficients: FloatArray
    """Shape (rows, SERIES_ORDER + 1, 4n + 2)."""
    friction: FloatArray
    """Shape (rows, SERIES_ORDER + 1, n)."""
    modes: NDArray[np.int8]

    @classmethod
    def empty(cls, rows: int, cells: int) -> Self:
        """Give room for so many segments."""
        series = rows, SERIES_ORDER + 1
        room = np.empty(rows), np.empty(rows), np.empty((*series, 4 * cells + 2)), np.empty((*series, cells))
        return cls(*room, np.empty((rows, cells), dtype=np.int8))


_called = numba.njit(cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)


@numba.njit(cache=True, error_model="numpy")
def follow(chain: Any, clock: Any, end: float, nearly: float, most_events: int, z: Any, modes: Any, record: Any) -> int:
    """Go from event to event until the record is full, `end` [s] is reached or events accumulate; gives the rows.

    `clock`, `z` (4n + 2,) and `modes` (n,) are where the motion is, and follow it. A segment that ends at `nearly`
    or later ends at `end`.
    """
    n, span = modes.size, 1 / chain.rate
    orders, work = np.empty((3, n), np.int64), np.empty(n)
    for row in range(record.start.size):
        time = clock[TIME]
        if time >= end or clock[EVENTS] > most_events:
            return row
        z[4 * n], z[4 * n + 1] = math.sin(chain.angular_frequency * time), math.cos(chain.angular_frequency * time)
        coefficients, friction = record.coefficients[row], record.friction[row]
        _begin(chain, z, modes, coefficients, friction, orders, work)
        for i in range(n):
            record.modes[row, i] = modes[i]
        reach = min(1.0, (end - time) * chain.rate)
        duration = reach * span * _first_event(chain.cells, reach, coefficients, friction, orders, modes, work)
        record.start[row], record.duration[row] = time, duration
        evaluate(coefficients, duration * chain.rate, z)
        clock[TIME] = end if time + duration >= nearly else time + duration
        clock[EVENTS] += 1
        if clock[TIME] - clock[COUNTED_FROM] > span:
            clock[EVENTS], clock[COUNTED_FROM] = 0, clock[TIME]
    return record.start.size


@_called
def _begin(chain: Any, z: Any, modes: Any, coefficients: Any, friction: Any, orders: Any, sizes: Any) -> None:
    """Give every contact the mode that Coulomb's law allows, and the series; those at rest are decided anew.

    `orders` (3, n) becomes the number of leading coefficients that vanish: of the distance of a sticking force from its
    upper and lower bound, or, in the first row, of a relative velocity. The third row is the order of the coefficient
    with which a contact leaves its rest.
    """
    n, cells = modes.size, chain.cells
    _bring_to_rest(chain, z, modes)
    for row in range(z.size):
        coefficients[0, row] = z[row]
    for i in range(n):
        orders[0, i] = 0
    while True:
        for i in range(n):
            friction[0, i] = -modes[i] * cells[i, BOUND]
        continue_series(chain, modes, coefficients, friction)
        _force_sizes(chain, coefficients, sizes)
        lowest = SERIES_ORDER + 1
        for i in range(n):
            orders[2, i] = SERIES_ORDER + 1
            if modes[i] == 0:
                _decide(friction, i, cells[i, BOUND], FORCE_TOLERANCE * (cells[i, BOUND] + sizes[i]), orders)
                lowest = min(lowest, orders[2, i])
        if lowest > SERIES_ORDER:
            return
        for i in range(n):
            if orders[2, i] == lowest:
                modes[i] = -1 if friction[0, i] > 0 else 1
                orders[0, i] = lowest + 1


@_called
def _bring_to_rest(chain: Any, z: Any, modes: Any) -> None:
    """Find which contacts are at rest; both masses of their cells get the common velocity, and momentum is kept."""
    n, fastest = modes.size, chain.drive_velocity
    for row in range(2 * n):
        fastest = max(fastest, chain.rate * abs(z[row]), abs(z[2 * n + row]))
    for i in range(n):
        outer, inner = 2 * n + i, 3 * n + i
        slow = abs(z[inner] - z[outer]) <= REST_TOLERANCE * fastest
        if chain.cells[i, BOUND] > 0 and (modes[i] == 0 or slow):
            z[outer] += chain.cells[i, INNER_SHARE] * (z[inner] - z[outer])
            z[inner] = z[outer]
            modes[i] = 0


@_called
def _force_sizes(chain: Any, coefficients: Any, sizes: Any) -> None:
    """Sum of the sizes of all forces on the two masses of each cell [N], (n,): what round-off scales with."""
    n, cells = sizes.size, chain.cells
    for i in range(n):
        sizes[i] = 0.0
    # Two terms of the series count, since forces may all pass zero at one instant.
    for k in range(2):
        load = abs(chain.load[0] * coefficients[k, 4 * n]) + abs(chain.load[1] * coefficients[k, 4 * n + 1])
        sizes[0] += load
        for i in range(n):
            u, v = abs(coefficients[k, i]), abs(coefficients[k, n + i])
            du, dv = abs(coefficients[k, 2 * n + i]), abs(coefficients[k, 3 * n + i])
            sizes[i] += 2 * (cells[i, INNER_STIFFNESS] * (u + v) + cells[i, INNER_DAMPING] * (du + dv))
            if i > 0:
                u += abs(coefficients[k, i - 1])
                du += abs(coefficients[k, 2 * n + i - 1])
            left = cells[i, CHAIN_STIFFNESS] * u + cells[i, CHAIN_DAMPING] * du
            sizes[i] += left
            if i > 0:
                sizes[i - 1] += left


@_called
def _decide(friction: Any, i: int, bound: float, tolerance: float, orders: Any) -> None:
    """Set how many coefficients of μ λ_N ∓ λ_T of a contact at rest vanish, and with which one it leaves."""
    orders[0, i] = orders[1, i] = 0
    if abs(friction[0, i]) < bound - tolerance:
        return
    side = 1 if friction[0, i] > 0 else -1
    order, outwards = 0, side * friction[0, i] - bound
    while abs(outwards) <= tolerance and order <= SERIES_ORDER:
        order += 1
        outwards = side * friction[order, i] if order <= SERIES_ORDER else 0.0
    orders[0 if side > 0 else 1, i] = order
    if outwards > 0:
        orders[2, i] = order


@_called
def _first_event(
    cells: Any, reach: float, coefficients: Any, friction: Any, orders: Any, modes: Any, ends: Any
) -> float:
    """First event over `reach`, a part of the span, one at most; slipping contacts that come to rest get mode 0.

    It is the first root of |ġ_T| of a slipping contact, and of μ λ_N − λ_T and μ λ_N + λ_T of a sticking one.
    """
    n, first, function = modes.size, np.inf, np.empty(SERIES_ORDER + 1)
    for i in range(n):
        ends[i], sticks, bound = np.inf, modes[i] == 0, cells[i, BOUND]
        for side in (1, -1):
            if bound > 0 and (sticks or side == modes[i]):
                for k in range(SERIES_ORDER + 1):
                    slip = coefficients[k, 3 * n + i] - coefficients[k, 2 * n + i]
                    function[k] = -side * friction[k, i] if sticks else side * slip
                if sticks:
                    function[0] += bound
                order = orders[1 if sticks and side < 0 else 0, i]
                ends[i] = min(ends[i], _first_passage(function, order, reach))
        first = min(first, ends[i])
    for i in range(n):
        if ends[i] == first and first < np.inf:
            modes[i] = 0
    return min(first, 1.0)


@_called
def _first_passage(function: Any, order: int, reach: float) -> float:
    """First root on (0, 1] of a polynomial of s / reach, after `order` leading coefficients are divided out.

    Without one, inf; so it is where nothing is left.
    """
    power, size = 1.0, 0.0
    for k in range(SERIES_ORDER + 1 - order):
        function[k] = function[k + order] * power
        size += abs(function[k])
        power *= reach
    for k in range(SERIES_ORDER + 1 - order, SERIES_ORDER + 1):
        function[k] = 0.0
    return first_root(function) if 0 < size < np.inf else np.inf
