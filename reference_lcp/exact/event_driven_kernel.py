"""Compiled loops from event to event: consistent modes, the series from there, and where it ends.

At every start of a stretch each contact at rest (ġ_T = 0) is given the mode that Coulomb's law allows. With λ* the
force that would keep the contact at rest, it sticks if |λ*| < μ λ_N, and if not it slips against λ*. Where |λ*| = μ λ_N
the first derivative of λ* that differs from zero decides: outwards it slips, inwards it sticks. A derivative of order k
depends on the modes of other contacts only through orders below k; deciding the lowest order first is therefore
consistent (cf. Pfeiffer and Glocker, "Multibody dynamics with unilateral contacts", 1996).
"""

from typing import Any, NamedTuple, Self

import numba
import numpy as np
from numpy.typing import NDArray

from reference_lcp.exact.mode_dynamics import SERIES_ORDER, continue_series
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

    `clock`, `z` (4n + 2) and `modes` (n,) are where the motion is, and follow it. A segment that ends at `nearly`
    or later ends at `end`.
    """
    span, orders = 1 / chain.rate, np.empty((2, modes.size), dtype=np.int64)
    for row in range(record.start.size):
        time = clock[TIME]
        if time >= end or clock[EVENTS] > most_events:
            return row
        z[-2] = np.sin(chain.angular_frequency * time)
        z[-1] = np.cos(chain.angular_frequency * time)
        coefficients, friction = record.coefficients[row], record.friction[row]
        _begin(chain, z, modes, coefficients, friction, orders)
        record.modes[row] = modes
        reach = min(1.0, (end - time) * chain.rate)
        part = _first_event(chain, reach, coefficients, friction, orders, modes)
        record.start[row], record.duration[row] = time, part * reach * span
        _evaluate(coefficients, record.duration[row] * chain.rate, z)
        time += record.duration[row]
        clock[TIME] = end if time >= nearly else time
        clock[EVENTS] += 1
        if clock[TIME] - clock[COUNTED_FROM] > span:
            clock[EVENTS], clock[COUNTED_FROM] = 0, clock[TIME]
    return record.start.size


@_called
def _evaluate(coefficients: Any, s: float, z: Any) -> None:
    """Horner's rule."""
    for row in range(z.size):
        value = 0.0
        for k in range(SERIES_ORDER, -1, -1):
            value = value * s + coefficients[k, row]
        z[row] = value


@_called
def _begin(chain: Any, z: Any, modes: Any, coefficients: Any, friction: Any, orders: Any) -> None:
    """Give every contact the mode that Coulomb's law allows, and the series; those at rest are decided anew.

    `orders` (2, n) becomes the number of leading coefficients that vanish: of the distance of a sticking force from its
    upper and lower bound, or, in the first row, of a relative velocity.
    """
    n, bound = modes.size, chain.friction_bound
    stuck, leaves = np.zeros(n, np.bool_), np.zeros(n, np.bool_)
    slip_order, sizes = np.zeros(n, np.int64), np.empty(n)
    _bring_to_rest(chain, z, modes, stuck)
    coefficients[0] = z
    while True:
        for i in range(n):
            friction[0, i] = -modes[i] * bound[i]
        continue_series(chain, stuck, coefficients, friction)
        _force_sizes(chain, coefficients, sizes)
        lowest = SERIES_ORDER + 1
        for i in range(n):
            orders[0, i], orders[1, i], leaves[i] = slip_order[i], 0, False
            if stuck[i]:
                tolerance = FORCE_TOLERANCE * (bound[i] + sizes[i])
                leaves[i] = _decide(friction[:, i], bound[i], tolerance, orders[:, i])
                if leaves[i]:
                    lowest = min(lowest, max(orders[0, i], orders[1, i]))
        if lowest > SERIES_ORDER:
            return
        for i in range(n):
            if leaves[i] and max(orders[0, i], orders[1, i]) == lowest:
                modes[i] = -1 if friction[0, i] > 0 else 1
                slip_order[i], stuck[i] = lowest + 1, False


@_called
def _bring_to_rest(chain: Any, z: Any, modes: Any, stuck: Any) -> None:
    """Find which contacts are at rest; both masses of their cells get the common velocity, and momentum is kept."""
    n = modes.size
    fastest = chain.drive_velocity
    for row in range(2 * n):
        fastest = max(fastest, chain.rate * abs(z[row]), abs(z[2 * n + row]))
    for i in range(n):
        outer, inner = 2 * n + i, 3 * n + i
        if chain.friction_bound[i] > 0 and (modes[i] == 0 or abs(z[inner] - z[outer]) <= REST_TOLERANCE * fastest):
            z[outer] = z[inner] = z[outer] + chain.inner_share[i] * (z[inner] - z[outer])
            stuck[i], modes[i] = True, 0


@_called
def _force_sizes(chain: Any, coefficients: Any, sizes: Any) -> None:
    """Sum of the sizes of all forces on the two masses of each cell [N], (n,): what round-off scales with."""
    n = sizes.size
    sizes[:] = 0.0
    # Two terms of the series count, since forces may all pass zero at one instant.
    for k in range(2):
        z = np.abs(coefficients[k])
        sizes[0] += abs(chain.load[0]) * z[4 * n] + abs(chain.load[1]) * z[4 * n + 1]
        for i in range(n):
            inner = chain.inner_stiffness[i] * (z[i] + z[n + i])
            inner += chain.inner_damping[i] * (z[2 * n + i] + z[3 * n + i])
            left = chain.chain_stiffness[i] * z[i] + chain.chain_damping[i] * z[2 * n + i]
            if i > 0:
                left += chain.chain_stiffness[i] * z[i - 1] + chain.chain_damping[i] * z[2 * n + i - 1]
                sizes[i - 1] += left
            sizes[i] += left + 2 * inner


@_called
def _decide(friction: Any, bound: float, tolerance: float, orders: Any) -> bool:
    """Say whether a contact at rest has to slip; sets how many coefficients of μ λ_N ∓ λ_T vanish, (2,)."""
    if abs(friction[0]) < bound - tolerance:
        return False
    side = 1 if friction[0] > 0 else -1
    order, outwards = 0, side * friction[0] - bound
    while abs(outwards) <= tolerance and order < SERIES_ORDER + 1:
        order += 1
        outwards = side * friction[order] if order <= SERIES_ORDER else 0.0
    orders[0 if side > 0 else 1] = order
    return outwards > 0


@_called
def _first_event(chain: Any, reach: float, coefficients: Any, friction: Any, orders: Any, modes: Any) -> float:
    """First event over `reach`, a part of the span, one at most; slipping contacts that come to rest get mode 0.

    It is the first root of |ġ_T| of a slipping contact, and of μ λ_N − λ_T and μ λ_N + λ_T of a sticking one.
    """
    n = modes.size
    ends, function = np.full(n, np.inf), np.empty(SERIES_ORDER + 1)
    for i in range(n):
        if chain.friction_bound[i] == 0:
            continue
        if modes[i] != 0:
            for k in range(SERIES_ORDER + 1):
                function[k] = modes[i] * (coefficients[k, 3 * n + i] - coefficients[k, 2 * n + i])
            ends[i] = _first_passage(function, orders[0, i], reach)
            continue
        for row in range(2):
            side = 1 - 2 * row
            for k in range(SERIES_ORDER + 1):
                function[k] = -side * friction[k, i]
            function[0] += chain.friction_bound[i]
            ends[i] = min(ends[i], _first_passage(function, orders[row, i], reach))
    first = np.min(ends)
    for i in range(n):
        if ends[i] == first and first < np.inf:
            modes[i] = 0
    return min(first, 1.0)


@_called
def _first_passage(function: Any, order: int, reach: float) -> float:
    """First root on (0, 1] of a polynomial of s / reach, after `order` leading coefficients are divided out.

    Without one, inf; so it is where nothing is left.
    """
    if order > 0:
        for k in range(SERIES_ORDER + 1 - order):
            function[k] = function[k + order]
        function[SERIES_ORDER + 1 - order :] = 0.0
        if not np.any(function):
            return np.inf
    power = 1.0
    for k in range(SERIES_ORDER + 1):
        function[k] *= power
        power *= reach
    return first_root(function)
