"""Event-driven motion of masses, springs and friction contacts with given normal forces: exact to round-off.

As `reference_lcp.exact.event_driven` for the chain, with contacts between any two bodies, forces and normal forces
that change in time, and static friction above kinetic friction. While every contact keeps its mode,

    z = (u, u̇, 1, t, sin ω_1 t, cos ω_1 t, …),        ż = A z,

is linear, and solved by its power series over at most one span. A stretch ends where

- the relative velocity of a sliding contact reaches zero;
- the friction that holds a contact at rest reaches μ_s N(t);
- a given force or normal force switches.

At every start of a stretch the modes of contacts at rest are decided anew. Those that slide at once are found on the
level of accelerations, by the LCP of a step of unit time from rest (`reference_lcp.lcp.time_step`). Of the others, one
whose friction is on its bound and about to pass slides too: the lowest order in time first and of these the largest
excess. What slides must then move against its friction, or the motion is ambiguous and refused.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.errors import ParameterError
from reference_lcp.exact.event_driven import EVENTS_PER_SPAN, EventDrivenModel, EventsAccumulate
from reference_lcp.exact.event_driven_kernel import FORCE_TOLERANCE
from reference_lcp.exact.mode_dynamics import SERIES_ORDER, Stretch, harmonic_load, values
from reference_lcp.exact.polynomial_roots import first_roots
from reference_lcp.lcp.systems import FrictionContact, Harmonic, MassSpringSystem, Signal, Spring
from reference_lcp.lcp.time_step import REST_TOLERANCE, FrictionalStep, solve_step
from reference_lcp.observables.stick_slip import mode_changes
from reference_lcp.validation import FloatArray, checked_array, checked_scalar
from reference_lcp.watching import tell

Modes = NDArray[np.int8]

AT_EVENT = 1e-9
"""What the distance of a force from its bound is at its event, over its parts: far above round-off."""

LEADING_ONE = np.eye(SERIES_ORDER + 1)[0]
"""The polynomial 1, which has no root."""


class AmbiguousModes(RuntimeError):
    """More than one set of sliding contacts fulfils the law of friction, or none; the message says when."""


@dataclass(frozen=True)
class SystemStretch(Stretch):
    """A stretch of the motion of a system."""

    normal_force: FloatArray
    """N [N] of every contact, a series as `friction`."""
    slip: FloatArray
    """ġ_T [m/s], likewise."""
    rates: FloatArray
    """A times the span, shape (d, d)."""
    held: FloatArray
    """Rows that give λ_T from z, shape (c, d)."""

    def values(self, series: FloatArray, times: ArrayLike) -> FloatArray:
        """Give one of the series at times [s], shape (times,), as rows."""
        return self.powers(np.atleast_1d(np.asarray(times, dtype=np.float64)) - self.start) @ series

    @property
    def slipped(self) -> FloatArray:
        """Distance that every contact slides [m], shape (c,)."""
        return self.sliding_distance(self.start, self.end)

    def sliding_distance(self, start: float, end: float) -> FloatArray:
        """∫ |ġ_T| dt of every contact over the part of the stretch between two times [m], shape (c,)."""
        first, last = max(start, self.start), min(end, self.end)
        if last <= first:
            return np.zeros(self.modes.size)
        integral = np.vstack([np.zeros(self.modes.size), self.slip[:-1] / np.arange(1, SERIES_ORDER + 1)[:, None]])
        begin, finish = self.values(integral * self.span, [first, last])
        return np.abs(finish - begin)


class EventDrivenSystem:
    """A `MassSpringSystem`, advanced from event to event."""

    def __init__(self, system: MassSpringSystem):
        self.system = system
        signals = [*(signal for _, signal in system.loads), *system.normal_signals]
        pieces = [piece for signal in signals for piece in signal.harmonics] + list(system.surface_speeds)
        self._first = 1 + any(piece.rate for piece in pieces)
        self._frequencies = sorted({piece.angular_frequency for piece in pieces if piece.amplitude})
        self._switches = sorted({time for signal in signals for time in signal.switches})
        own = system.highest_natural_frequency + np.linalg.norm(system.per_mass(system.damping_matrix), 2)
        self._rate = max([float(own), *self._frequencies])
        self.inverse_mass = 1 / system.masses
        f = system.freedoms
        surfaces = [self.signal_row(speed) for speed in system.surface_speeds]
        given = np.reshape(surfaces, (system.contacts, self._first + 2 * len(self._frequencies)))
        self.slip_rows = np.hstack([np.zeros((system.contacts, f)), system.directions.T, -given])
        """Rows that give ġ_T from z, shape (c, d)."""
        self.surface_rows = given @ self.rates(np.zeros((f, self.slip_rows.shape[1])))[2 * f :, 2 * f :]
        """Rows that give the acceleration of the ground under every contact from what is given, shape (c, d − 2f)."""

    def motion(self, *, position: ArrayLike, velocity: ArrayLike, times: ArrayLike) -> Trajectory:
        """Give the motion at `times`.

        Parameters
        ----------
        position, velocity
            u [m] and u̇ [m/s] at t = 0, shape (f,).
        times
            Rising, > 0 [s], shape (rows,).

        Raises
        ------
        ParameterError
            If an argument is outside its range, or a normal force becomes negative.
        """
        rows = np.atleast_1d(checked_array("times", times, "> 0"))
        if np.any(np.diff(rows) <= 0):
            raise ParameterError("times do not rise; allowed: rising times")
        stretches = list(self.stretches(position=position, velocity=velocity, end=float(rows[-1])))
        return self.sampled(stretches, rows)

    def sampled(self, stretches: Sequence[SystemStretch], times: FloatArray) -> Trajectory:
        """Read stretches at times [s], with the exact times of all changes of mode."""
        starts, system, f = np.array([own.start for own in stretches]), self.system, self.system.freedoms
        which = np.searchsorted([own.end for own in stretches[:-1]], times)
        s = (times - starts[which]) / stretches[0].span
        motion, friction, normal, slip = (
            values(np.array([getattr(own, name) for own in stretches]), which, s)
            for name in ("coefficients", "friction", "normal_force", "slip")
        )
        modes = np.array([own.modes for own in stretches])
        return Trajectory(
            time=times, positions=motion[:, :f], velocities=motion[:, f:], friction=friction, normal_force=normal,
            slip=slip, friction_coefficient=system.friction_coefficient,
            changes=mode_changes(modes, starts, system.friction_bound > 0, cyclic=False),
        )  # fmt: skip

    def stretches(
        self, *, position: ArrayLike, velocity: ArrayLike, end: float, start: float = 0.0
    ) -> Iterator[SystemStretch]:
        """Give the stretches of the motion from `start` to `end` [s]; arguments and errors as of `motion`."""
        f, limit = self.system.freedoms, checked_scalar("end", end, "> 0")
        state = [checked_array("position", position, shape=(f,)), checked_array("velocity", velocity, shape=(f,))]
        x, time, events, counted_from = np.concatenate(state), start, 0, start
        span = 1 / max(self._rate, 1 / (limit - start))
        while time < limit:
            until = min([limit, *(switch for switch in self._switches if switch > time)])
            tell()
            stretch = _Start(self, x, time, span).stretch(until)
            yield stretch
            x = stretch.values(stretch.coefficients, stretch.end)[0]
            time = until if until - stretch.end <= 2 * np.spacing(until) else stretch.end
            events += 1
            if time - counted_from > span:
                events, counted_from = 0, time
            if events > EVENTS_PER_SPAN * (1 + self.system.contacts):
                raise EventsAccumulate(f"{events} changes of mode between {counted_from:.15g} and {time:.15g} s")

    def extended(self, x: FloatArray, time: float) -> FloatArray:
        """Vector z of a state (u, u̇) at a time [s], shape (d,)."""
        phases = [(np.sin(omega * time), np.cos(omega * time)) for omega in self._frequencies]
        return np.concatenate([x, [1.0, time][: self._first], np.ravel(phases)])

    def signal_row(self, piece: Harmonic) -> FloatArray:
        """The row that gives a piece of a signal from (1, t, sin ω_1 t, cos ω_1 t, …), shape (d − 2f,)."""
        row = np.zeros(self._first + 2 * len(self._frequencies))
        row[: self._first] = [piece.mean, piece.rate][: self._first]
        if piece.amplitude:
            k = self._first + 2 * self._frequencies.index(piece.angular_frequency)
            row[k : k + 2] = piece.amplitude * np.cos(piece.phase), piece.amplitude * np.sin(piece.phase)
        return row

    def forces(self, time: float) -> FloatArray:
        """Rows that give h [N] from z just behind a time [s], shape (f, d)."""
        system = self.system
        given = np.zeros((system.freedoms, self._first + 2 * len(self._frequencies)))
        for body, signal in system.loads:
            given[body] += self.signal_row(signal.piece(time))
        return np.hstack([-system.stiffness_matrix, -system.damping_matrix, given])

    def normal_forces(self, time: float) -> FloatArray:
        """Rows that give N [N] from z just behind a time [s], shape (c, d)."""
        rows = [self.signal_row(signal.piece(time)) for signal in self.system.normal_signals]
        f = self.system.freedoms
        return np.hstack(
            [np.zeros((len(rows), 2 * f)), np.reshape(rows, (len(rows), self._first + 2 * len(self._frequencies)))]
        )

    def rates(self, acceleration: FloatArray) -> FloatArray:
        """A of ż = A z, from the rows that give the acceleration, shape (d, d)."""
        f, d = acceleration.shape
        rates = np.zeros((d, d))
        rates[:f, f : 2 * f] = np.eye(f)
        rates[f : 2 * f] = acceleration
        rates[2 * f + 1 : 2 * f + self._first, 2 * f] = 1.0
        for k, omega in enumerate(self._frequencies):
            sine = 2 * f + self._first + 2 * k
            rates[sine, sine + 1], rates[sine + 1, sine] = omega, -omega
        return rates


class _Start:
    """A state at which a stretch begins, the modes of its contacts, and the series from there."""

    def __init__(self, solver: EventDrivenSystem, x: FloatArray, time: float, span: float):
        system = solver.system
        self._solver, self._time, self._span = solver, time, span
        self._W, self._mass_matrix, self._inverse_mass = system.directions, system.mass_matrix, solver.inverse_mass
        self._forces, self._normal = solver.forces(time), solver.normal_forces(time)
        self._kinetic, self._static = system.friction_coefficient, system.static_friction_coefficient
        self._rubs = np.any(self._normal != 0, axis=1) & (self._static > 0)
        self._z = solver.extended(x, time)
        self._speed, self._size = self._round_off_scales()
        slip = solver.slip_rows @ self._z
        rest = np.abs(slip) <= REST_TOLERANCE * self._speed
        self._modes: Modes = np.where(self._rubs & rest, 0, np.where(slip < 0, -1, 1)).astype(np.int8)
        self._bring_to_rest()
        self._release()

    def stretch(self, until: float) -> SystemStretch:
        """Follow the series to the first event, or to its end, or to `until` [s]."""
        reach = min(1.0, (until - self._time) / self._span)
        roots = first_roots(self._event_functions() * reach ** np.arange(SERIES_ORDER + 1)[:, None])
        part = reach * min(1.0, float(np.min(roots, initial=np.inf)))
        f = self._W.shape[0]
        motion, slip = self._series[:, : 2 * f], self._slip()
        slip[:, self._modes == 0] = 0.0
        normal = self._series @ self._normal.T
        result = SystemStretch(
            self._time, part * self._span, self._span, motion, self._friction, self._modes, normal, slip,
            self._rates, self._held,
        )  # fmt: skip
        ends = result.values(normal, [result.start, result.end])
        negative = np.argwhere(ends < -FORCE_TOLERANCE * np.max(np.abs(normal), axis=0, initial=0.0))
        if negative.size:
            row, contact = negative[0].tolist()
            raise ParameterError(
                f"normal force of contact {contact} = {ends[row, contact]:g} N at {result.start:g} s to "
                f"{result.end:g} s; allowed: >= 0"
            )
        return result

    @property
    def _velocity(self) -> FloatArray:
        f = self._W.shape[0]
        return self._z[f : 2 * f]

    def _round_off_scales(self) -> tuple[float, FloatArray]:
        """Largest velocity [m/s] that round-off compares with, and the size of the forces on every contact [N]."""
        given = np.abs(self._forces) @ np.abs(self._z)
        bound = self._static * (np.abs(self._normal) @ np.abs(self._z))
        gained = self._span * np.max((given + np.abs(self._W) @ bound) * self._inverse_mass)
        moved = np.max(np.abs(self._solver.slip_rows[:, 2 * len(self._W) :] @ self._z[2 * len(self._W) :]), initial=0.0)
        return float(max(np.max(np.abs(self._velocity)), moved) + gained), np.abs(self._W.T) @ given + bound

    def _bring_to_rest(self) -> None:
        """Give the bodies of contacts at rest velocities without slip, in place; momentum is kept."""
        W, slip = self._W[:, self._modes == 0], self._solver.slip_rows[self._modes == 0] @ self._z
        response = self._inverse_mass[:, None] * W
        self._velocity[:] -= response @ np.linalg.solve(W.T @ response, slip)

    def _release(self) -> None:
        """Let those contacts slide that friction at rest cannot hold; see the module."""
        at_rest = self._modes == 0
        while True:
            self._accelerate()
            self._solve_series()
            order, excess = self._excess()
            leaves = (self._modes == 0) & (excess > 0)
            if not np.any(leaves):
                break
            first = leaves & (order == np.min(order[leaves]))
            contact = int(np.argmax(np.where(first, excess, -np.inf)))
            self._modes[contact] = -1 if self._friction[0, contact] > 0 else 1
        slip = self._modes * self._slip()
        for contact in np.flatnonzero(at_rest & (self._modes != 0)).tolist():
            if slip[self._leading(slip[:, contact], self._speed_tolerance), contact] < -self._speed_tolerance:
                raise AmbiguousModes(f"contact {contact} at {self._time:.9g} s neither slides nor stays at rest")

    def _accelerate(self) -> None:
        """Let those contacts slide that begin to with an acceleration: a step of unit time from rest."""
        rest = self._modes == 0
        normal = np.maximum(self._normal @ self._z, 0.0)
        force = self._forces @ self._z - self._W[:, ~rest] @ (self._modes * self._kinetic * normal)[~rest]
        step = FrictionalStep.under_normal_force(
            self._W[:, rest],
            np.zeros(force.size),
            mass_matrix=self._mass_matrix,
            force=force,
            time_step=1.0,
            tangential_motion=-self._solver.surface_rows[rest] @ self._z[2 * len(self._W) :],
            friction_coefficient=self._kinetic[rest],
            static_friction_coefficient=self._static[rest],
            # Where a contact is at its bound, round-off would decide; there its series does.
            normal_force=(1 + FORCE_TOLERANCE) * normal[rest],
        )
        gained = solve_step(step).relative_velocity
        self._modes[rest] = np.where(np.abs(gained) > self._speed_tolerance / self._span, np.sign(gained), 0)

    def _solve_series(self) -> None:
        """Give z and λ_T in powers of s, with the modes as they are."""
        moving, W = self._modes != 0, self._W
        friction = np.zeros_like(self._normal)
        friction[moving] = -(self._modes * self._kinetic)[moving, None] * self._normal[moving]
        held = W[:, ~moving]
        free = self._inverse_mass[:, None] * (self._forces + W @ friction)
        needed = held.T @ free
        needed[:, 2 * len(W) :] -= self._solver.surface_rows[~moving]
        friction[~moving] = -np.linalg.solve(held.T @ (self._inverse_mass[:, None] * held), needed)
        self._held = friction
        rates = self._solver.rates(self._inverse_mass[:, None] * (self._forces + W @ friction)) * self._span
        self._rates: FloatArray = rates
        series = [self._z]
        for k in range(1, SERIES_ORDER + 1):
            series.append(rates @ series[-1] / k)
        self._series = np.array(series)
        self._friction: FloatArray = self._series @ friction.T

    def _slip(self) -> FloatArray:
        slip: FloatArray = self._series @ self._solver.slip_rows.T
        return slip

    def _distance_from_bound(self, side: FloatArray) -> FloatArray:
        """μ_s N less friction at rest on one side, ±1 a contact, in powers of s, shape (SERIES_ORDER + 1, c)."""
        return self._static * (self._series @ self._normal.T) - side * self._friction

    def _excess(self) -> tuple[NDArray[np.intp], FloatArray]:
        """By how much the friction of every contact passes its bound, over its size, and in which order of time."""
        beyond = -self._distance_from_bound(np.where(self._friction[0] < 0, -1.0, 1.0))
        tolerance = FORCE_TOLERANCE * self._size
        order = np.argmax(np.abs(beyond) > tolerance, axis=0)
        value = beyond[order, np.arange(order.size)]
        significant = np.abs(value) > tolerance
        return order, np.where(significant, value / np.where(self._size > 0, self._size, 1.0), 0.0)

    @property
    def _speed_tolerance(self) -> float:
        return FORCE_TOLERANCE * self._speed

    @staticmethod
    def _leading(column: FloatArray, tolerance: float) -> int:
        """Index of the first coefficient that is not round-off; 0 if there is none."""
        return int(np.argmax(np.abs(column) > tolerance))

    def _event_functions(self) -> FloatArray:
        """Polynomials whose first root on (0, 1] ends the modes, shape (SERIES_ORDER + 1, 2c)."""
        contacts = self._modes.size
        functions = np.repeat(LEADING_ONE[:, None], 2 * contacts, axis=1)
        slip = self._modes * self._slip()
        sides = [self._distance_from_bound(np.full(contacts, side)) for side in (1.0, -1.0)]
        for contact in np.flatnonzero(self._rubs):
            if self._modes[contact]:
                functions[:, contact] = self._without_leading(slip[:, contact], self._speed_tolerance)
                continue
            for side, column in zip(sides, (contact, contacts + contact), strict=True):
                functions[:, column] = self._without_leading(side[:, contact], FORCE_TOLERANCE * self._size[contact])
        return functions

    def _without_leading(self, column: FloatArray, tolerance: float) -> FloatArray:
        """Divide out those powers of s whose coefficients are round-off; the constant one if nothing is left."""
        order = self._leading(column, tolerance)
        if abs(column[order]) <= tolerance:
            return LEADING_ONE
        return np.concatenate([column[order:], np.zeros(order)])


class EventDrivenBodies(EventDrivenModel):
    """A lane of bodies, or a chain as such: with static friction, and with normal forces that change in time."""

    def __init__(self, lane: Lane):
        self.lane = lane
        system = lane.chain if isinstance(lane.chain, MassSpringSystem) else system_of_lane(lane)
        self.solver = EventDrivenSystem(system)

    def segments(self, state: State, start: float, end: float) -> Iterator[SystemStretch]:
        """Stretches of the motion from `state`, a batch of one lane, between two times [s]."""
        return self.solver.stretches(position=state.positions[0], velocity=state.velocities[0], start=start, end=end)

    def sampled(self, segments: Sequence[Any], times: FloatArray) -> Trajectory:
        """Read stretches at times [s]; λ_T is that of the instant of each row."""
        return self.solver.sampled(segments, times)

    def monodromy(self, segments: Sequence[Any]) -> FloatArray:
        """Jacobian of the end of a row of stretches to its start, in (u, u̇), shape (2f, 2f)."""
        system, f = self.solver.system, self.solver.system.freedoms
        W, total = system.directions[:, segments[0].modes == 0], np.eye(2 * f)
        response = W / system.masses[:, None]
        total[f:, f:] -= response @ np.linalg.solve(W.T @ response, W.T)
        for before, after in zip([None, *segments], segments, strict=False):
            if before is not None:
                total = self._jump(before, after) @ total
            term, rates = total, after.rates[: 2 * f, : 2 * f] * (after.duration / after.span)
            for k in range(1, SERIES_ORDER + 1):
                term = rates @ term / k
                total = total + term
        return total

    def _jump(self, before: SystemStretch, after: SystemStretch) -> FloatArray:
        """Saltation matrix where contacts stop, turn round or leave their rest by themselves, shape (2f, 2f)."""
        width, total = before.coefficients.shape[1], np.eye(before.coefficients.shape[1])
        z = self.solver.extended(before.values(before.coefficients, before.end)[0], before.end)
        rate, jump = before.rates @ z, (after.rates @ z - before.rates @ z)[:width]
        bound = self.solver.system.static_friction_coefficient[:, None] * self.solver.normal_forces(before.start)
        distance = bound - np.sign(before.held @ z)[:, None] * before.held
        for contact in np.flatnonzero(before.modes != after.modes):
            row = (self.solver.slip_rows if before.modes[contact] else distance)[contact]
            # one that leaves its rest may do so because another stops, away from its own bound
            if row @ rate and (before.modes[contact] or abs(row @ z) <= AT_EVENT * (abs(row) @ abs(z))):
                total = total + np.outer(jump, row[:width]) / (row @ rate)
        return total


def system_of_lane(lane: Lane) -> MassSpringSystem:
    """Give a chain under a harmonic or still drive body by body, outer masses first."""
    chain, n = lane.chain, lane.chain.cells
    omega, (sine, cosine) = harmonic_load(chain, lane.drive)
    load = Harmonic(amplitude=math.hypot(sine, cosine), angular_frequency=omega, phase=math.atan2(cosine, sine))
    outer = [Spring(k, k - 1 if k else None, chain.chain_stiffness[k], chain.chain_damping[k]) for k in range(n)]
    inner = [Spring(n + k, k, chain.inner_stiffness[k], chain.inner_damping[k]) for k in range(n)]
    friction = [
        FrictionContact(n + k, k, _pressing(float(chain.normal_force[k]), lane.preload), mu, lane.static_ratio * mu)
        for k, mu in enumerate(chain.friction_coefficient.tolist())
    ]
    masses = np.concatenate([chain.outer_mass, chain.inner_mass])
    return MassSpringSystem(masses=masses, springs=[*outer, *inner], friction=friction, forces={0: load})


def _pressing(mean: float, preload: Preload | None) -> Signal:
    """Give the normal force [N] of this mean."""
    if preload is None:
        return mean
    return Harmonic(mean, preload.modulation * mean, preload.angular_frequency, preload.phase)
