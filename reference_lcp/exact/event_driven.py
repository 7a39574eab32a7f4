"""Event-driven integration: the motion of the chain with a given normal force, exact to round-off.

Between two changes of mode the chain is linear and solved by its power series (`stick_pattern`). A
mode ends with an event:

- the relative velocity of a slipping contact reaches zero;
- the friction force that a sticking contact needs reaches its bound μ λ_N.

Both are polynomials on each stretch of the series, and `first_roots` proves either that one has no
root or finds its first: no event hides between samples, because there are no samples.

At every start of a stretch each contact at rest (ġ_T = 0) is given the mode that Coulomb's law allows. With λ* the
force that would keep the contact at rest, it sticks if |λ*| < μ λ_N, and if not it slips against λ*. Where |λ*| = μ λ_N
the first derivative of λ* that differs from zero decides: outwards it slips, inwards it sticks. A derivative of order k
depends on the modes of other contacts only through orders below k; deciding the lowest order first is therefore
consistent (cf. Pfeiffer and Glocker, "Multibody dynamics with unilateral contacts", 1996).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.simulation import Lane, check_one_coefficient, common_cells
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.deadline import UNLIMITED, Deadline
from reference_lcp.errors import ParameterError
from reference_lcp.exact.mode_dynamics import SERIES_ORDER, BoolArray, PiecewiseLinearChain, Segment
from reference_lcp.exact.polynomial_roots import first_roots
from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation
from reference_lcp.validation import FloatArray

REST_TOLERANCE = 1e-13
"""Relative velocity, over the largest velocity of the motion, at which a contact counts as at rest."""

FORCE_TOLERANCE = 1e-12
"""Distance of a sticking force from its bound, over the forces it is made up of, that counts as none."""

EVENTS_PER_SPAN = 200
"""Events of one contact within one span of the series beyond which they count as accumulating."""

Modes = NDArray[np.int8]


class EventsAccumulate(RuntimeError):
    """Contacts change their modes without end in a short time; the message says where."""


@dataclass(frozen=True)
class _Start:
    """Consistent modes, and the series from there.

    `orders` (2, n) holds the number of leading coefficients that vanish: of the distance of a sticking force from its
    upper and lower bound, or, in the first row, of a relative velocity.
    """

    modes: Modes
    coefficients: FloatArray
    friction: FloatArray
    orders: NDArray[np.intp]


class EventDrivenChain(LaneModel):
    """One chain under one harmonic or still drive, advanced from event to event; the time step sets the rows only."""

    def __init__(self, lane: Lane, deadline: Deadline = UNLIMITED):
        self.lane, self.deadline = lane, deadline
        self.system = PiecewiseLinearChain(lane.chain, lane.drive)
        chain = lane.chain
        self._bound = chain.friction_bound
        self._rubbing = self._bound > 0
        self.outer_share = chain.outer_mass / (chain.outer_mass + chain.inner_mass)
        self._drive_velocity = self.system.angular_frequency * lane.drive.displacement_scale(chain)

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`; λ_T is that of the instant of each row."""
        n, dt = self.lane.chain.cells, self.lane.time_step
        times = self.lane.times(start, steps)
        rows, friction = np.empty((steps, 4 * n)), np.empty((steps, n))
        segments = list(self.segments(state, start * dt, float(times[-1])))
        last = [*np.searchsorted(times, [segment.end for segment in segments[:-1]]), steps]
        for segment, begin, end in zip(segments, [0, *last[:-1]], last, strict=True):
            elapsed = times[begin:end] - segment.start
            rows[begin:end], friction[begin:end] = segment.states(elapsed), segment.friction_at(elapsed)
        normal = np.broadcast_to(self.lane.chain.normal_force, friction.shape)
        return Trajectory(times, rows[:, : 2 * n], rows[:, 2 * n :], friction, normal)

    def segments(self, state: State, start: float, end: float) -> Iterator[Segment]:
        """Segments of the motion from `state`, a batch of one lane, between two times [s]."""
        n = self.lane.chain.cells
        z = np.zeros(self.system.size)
        z[: 4 * n] = np.concatenate([state.positions[0], state.velocities[0]])
        modes = np.where(self._rubbing, np.sign(self._slip(z)), 1).astype(np.int8)
        time, events, counted_from = start, 0, start
        while time < end:
            self.deadline.check()
            z[4 * n : 4 * n + 2] = self.system.phase(time)
            begin = self._consistent(z, modes)
            segment, stopped = self._segment(begin, time, end)
            yield segment
            z, modes = segment.end_vector, begin.modes.copy()
            modes[stopped] = 0
            time = end if end - segment.end <= np.spacing(end) else segment.end
            events += 1
            if time - counted_from > self.system.span:
                events, counted_from = 0, time
            if events > EVENTS_PER_SPAN * n:
                raise EventsAccumulate(f"{events} changes of mode between {counted_from:.15g} and {time:.15g} s")

    def _slip(self, vectors: FloatArray) -> FloatArray:
        """Relative velocity ġ_T = v̇ − u̇ of vectors z, or coefficients of them."""
        n = self.lane.chain.cells
        return vectors[..., 3 * n : 4 * n] - vectors[..., 2 * n : 3 * n]

    def _consistent(self, z: FloatArray, modes: Modes) -> _Start:
        """Give every contact the mode that Coulomb's law allows; those at rest are decided anew."""
        z, modes, n = z.copy(), modes.copy(), modes.size
        carried = self.system.rate * np.max(np.abs(z[: 2 * n]))
        fastest = max(float(np.max(np.abs(z[2 * n : 4 * n]))), float(carried), self._drive_velocity)
        stuck = self._rubbing & ((modes == 0) | (np.abs(self._slip(z)) <= REST_TOLERANCE * fastest))
        self._bring_to_rest(z, stuck)
        modes[stuck] = 0
        slip_order = np.zeros(n, dtype=np.intp)
        while True:
            z[4 * n + 2 :] = -modes * self._bound
            coefficients = self.system.series(z, stuck)
            friction = self.system.friction(coefficients, stuck)
            tolerance = FORCE_TOLERANCE * (self._bound + self.system.force_magnitude(coefficients))
            orders, leaves = self._stick_orders(friction, stuck, tolerance)
            if not np.any(leaves):
                slips = self._rubbing & (modes != 0)
                orders[0, slips] = slip_order[slips]
                return _Start(modes, coefficients, friction, orders)
            order = np.where(leaves, np.max(orders, axis=0), SERIES_ORDER + 1)
            released = leaves & (order == np.min(order))
            modes[released] = -np.sign(friction[0, released])
            slip_order[released] = order[released] + 1
            stuck &= ~released

    def _bring_to_rest(self, z: FloatArray, stuck: BoolArray) -> None:
        """Give both masses of sticking cells their common velocity, in place; momentum is kept."""
        n = self.lane.chain.cells
        outer, inner = z[2 * n : 3 * n], z[3 * n : 4 * n]
        common = inner + self.outer_share * (outer - inner)
        outer[stuck] = common[stuck]
        inner[stuck] = common[stuck]

    def _stick_orders(
        self, friction: FloatArray, stuck: BoolArray, tolerance: FloatArray
    ) -> tuple[NDArray[np.intp], BoolArray]:
        """Leading coefficients of μ λ_N ∓ λ_T of sticking contacts that vanish (2, n), and which have to slip (n,)."""
        orders = np.zeros((2, stuck.size), dtype=np.intp)
        leaves = np.zeros(stuck.size, dtype=bool)
        near = stuck & (np.abs(friction[0]) >= self._bound - tolerance)
        for cell in np.flatnonzero(near):
            side = 1 if friction[0, cell] > 0 else -1
            outwards = side * friction[:, cell]
            outwards[0] -= self._bound[cell]
            significant = np.flatnonzero(np.abs(outwards) > tolerance[cell])
            order = int(significant[0]) if significant.size else SERIES_ORDER + 1
            orders[0 if side > 0 else 1, cell] = order
            leaves[cell] = order <= SERIES_ORDER and outwards[order] > 0
        return orders, leaves

    def _segment(self, begin: _Start, time: float, end: float) -> tuple[Segment, BoolArray]:
        """Follow the series to the first event, or to its end; give the slipping contacts that came to rest."""
        span = self.system.span
        reach = min(1.0, (end - time) / span)
        roots = first_roots(self._event_functions(begin, reach)).reshape(2, -1)
        first = float(np.min(roots))
        stopped = (np.min(roots, axis=0) == first) & (begin.modes != 0) & np.isfinite(first)
        duration = min(first, 1.0) * reach * span
        segment = Segment(time, duration, span, begin.coefficients, begin.friction, begin.modes)
        return segment, stopped

    def _event_functions(self, begin: _Start, reach: float) -> FloatArray:
        """Polynomials whose first root on (0, 1] ends the modes, shape (SERIES_ORDER + 1, 2n).

        Of a slipping contact: |ġ_T|, then nothing. Of a sticking one: μ λ_N − λ_T, then μ λ_N + λ_T.
        Leading coefficients that vanish are divided out; a polynomial without any root is the constant one.
        """
        n = begin.modes.size
        functions = np.zeros((SERIES_ORDER + 1, 2, n))
        functions[0] = 1.0
        stuck = begin.modes == 0
        slips = ~stuck & self._rubbing
        functions[:, 0, slips] = (begin.modes * self._slip(begin.coefficients))[:, slips]
        functions[:, 0, stuck] = -begin.friction[:, stuck]
        functions[:, 1, stuck] = begin.friction[:, stuck]
        functions[0][:, stuck] += self._bound[stuck]
        for side, cell in zip(*np.nonzero(begin.orders), strict=True):
            rest = functions[begin.orders[side, cell] :, side, cell].copy()
            functions[:, side, cell] = 0.0
            functions[: rest.size, side, cell] = rest
            if not np.any(rest):
                functions[0, side, cell] = 1.0
        return functions.reshape(SERIES_ORDER + 1, 2 * n) * reach ** np.arange(SERIES_ORDER + 1)[:, None]


class EventDrivenSimulation(SequentialSimulation):
    """The motion between events in closed form, and every event; a `Simulation` without a time-step error."""

    def __init__(self, lanes: Sequence[Lane], deadline: Deadline = UNLIMITED):
        common_cells(lanes)
        check_one_coefficient(lanes, "the event-driven chain")
        if any(lane.preload is not None for lane in lanes):
            raise ParameterError("the event-driven solver cannot represent a modulated normal force; allowed: constant")
        super().__init__([EventDrivenChain(lane, deadline) for lane in lanes])
