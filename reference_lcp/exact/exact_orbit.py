"""Exact steady states: Newton's method on the event-driven period map, and what is read from the segments it gives.

It begins at the Euler scheme's steady state. Where that does not lead to one, Anderson acceleration leads from rest to
where Newton's method takes over.

The Jacobian (monodromy matrix) of a piecewise smooth flow is the product of the propagators of its segments and, at
each event, of a saltation matrix S = I + (f⁺ − f⁻) hᵀ / (hᵀ f⁻), with h the gradient of the event function and f the
rate of the state before and after (Leine and Nijmeijer 2004, chapter 7). Where a sticking contact starts to slip S = I;
where a slipping one stops or turns round, h is its relative velocity.
"""

import dataclasses
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.drives import PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, OrbitStatus, PeriodicOrbit, steps_per_period_for
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import DEFAULT_PERIODS, DEFAULT_RESIDUAL, EXACT_RESIDUAL, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.exact.event_driven import EventDrivenChain, EventDrivenModel
from reference_lcp.exact.event_driven_system import EventDrivenBodies
from reference_lcp.exact.mode_dynamics import values
from reference_lcp.observables.stick_slip import Transition, mode_changes
from reference_lcp.schemes.euler import euler_simulation
from reference_lcp.schemes.sequential import SequentialSimulation
from reference_lcp.steady.attraction import largest_multiplier, without_dashpots
from reference_lcp.steady.orbits import orbit_status, periodic_orbits
from reference_lcp.validation import FloatArray
from reference_lcp.watching import tell

GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(16)
"""On each segment: exact up to degree 31, of polynomials whose coefficients fall as 1 / k!."""

REAL = 1e-6
"""Imaginary part of a root, over the span, up to which it is a turn; one that is none only reads a place on the way."""

SHORTEST_SEGMENT = 1e-12
"""Segments shorter than this part of the period are none: events that coincide but for round-off."""

SHAKEDOWN_SLIP = 1e-6
"""Slip to one side only, over the displacement scale, that counts as none: the contact is on its way to where it sticks
throughout (shakedown), which it reaches in the limit only."""

NEWTON_STEPS = 16
"""Most steps of Newton's method; one or two reach round-off, but where a contact creeps towards a place in which its
force just reaches the bound each step lowers the residual by four only."""

POLISHING = "exact motion, by Newton's method"
"""What is told to whoever watches."""

NULL_DIRECTION = 1e-12
"""Singular values of I − J, over the largest, that belong to offsets of cells that stay stuck."""

SCHEME_STEPS = 800
"""Steps a period of the Euler scheme's steady state: within some 1e-3 of the exact one, where Newton's method works."""

SCHEME_RESIDUAL = 1e-3
"""Residual of that steady state: its own distance from the exact one, where Newton's method takes over."""

MOST_SCHEME_STEPS = 10 * SCHEME_STEPS
"""Steps with which a period of the scheme takes as long as one from event to event; stiff chains need more."""


ROUND_OFF = 1e-14
"""Residual at which Newton's method has nothing left to do: some fifty units of round-off. A resonance that cannot be
resolved so far ends it too, with a residual that falls no more."""


@dataclass(frozen=True)
class ExactPeriod:
    """The segments of one period of a steady state, from phase zero of the drive."""

    lane: Lane
    segments: list[Any]
    """Each a `Segment`, or a `SystemStretch` of bodies."""

    @classmethod
    def following(cls, orbit: PeriodicOrbit, period: float) -> "ExactPeriod":
        """Go through the period [s] that follows the recorded one, at whose end sticking contacts are at rest."""
        return cls(orbit.lane, list(event_driven_model(orbit.lane).segments(orbit.trajectory.end, 0.0, period)))

    @property
    def period(self) -> float:
        """Length [s]."""
        return self.segments[-1].end

    @property
    def transitions(self) -> list[Transition]:
        """Changes of mode by cell and then by time, at their exact times; as `stick_slip.transitions`."""
        starts = np.array([self.segments[row].start for row in self.lasting])
        return mode_changes(self.modes[self.lasting], starts, self.lane.chain.friction_bound > 0, cyclic=True)

    @property
    def travels(self) -> list[float]:
        """Distance [m] that the contact slips in the phase that each transition begins; zero where it sticks."""
        slips = np.abs(self._slips[self.lasting])
        distances = []
        for place, (cell, row) in enumerate(self._changes):
            following = [other for other in (*self._changes[place + 1 :], *self._changes[:place]) if other[0] == cell]
            end = following[0][1] if following else row
            rows = np.arange(row, end if end > row else end + len(slips)) % len(slips)
            distances.append(float(np.sum(slips[rows, cell])))
        return distances

    @property
    def stuck_fraction(self) -> FloatArray:
        """Part of the period that each contact sticks, shape (n,)."""
        # Both sums run over the same rows in the same order: a contact that always sticks has exactly one.
        durations = self._durations[:, None]
        sticks = self.modes == 0
        return np.sum(durations * sticks, axis=0) / np.sum(durations * np.ones_like(sticks), axis=0)

    def harmonic(self, order: int = 1) -> NDArray[np.complex128]:
        """Complex amplitudes A exp(iφ) [m] of the displacements A sin(kωt + φ), shape (f,)."""
        times, weights, states = self.quadrature
        phases = 2 * np.pi * order / self.period * times
        parts = (weights * np.array([np.sin(phases), np.cos(phases)])) @ states[:, : self.lane.chain.freedoms]
        return 2 / self.period * (parts[0] + 1j * parts[1])

    @cached_property
    def quadrature(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gauss points of all segments [s], their weights [s], and positions and velocities there."""
        elapsed = np.outer(self._durations, (GAUSS_POINTS + 1) / 2)
        rows = np.repeat(np.arange(len(self.segments)), GAUSS_POINTS.size)
        starts = np.array([segment.start for segment in self.segments])
        states = values(self._series, rows, elapsed.ravel() / self.segments[0].span)
        times = (starts[:, None] + elapsed).ravel()
        return times, np.outer(self._durations, GAUSS_WEIGHTS / 2).ravel(), states[:, : 2 * self.lane.chain.freedoms]

    def state(self, time: float) -> FloatArray:
        """Positions and velocities at a time [s] of the period, shape (2f,)."""
        ends = [segment.end for segment in self.segments[:-1]]
        segment = self.segments[int(np.searchsorted(ends, time))]
        return np.asarray(segment.states(np.array([time - segment.start]))[0])

    @property
    def amplitude(self) -> FloatArray:
        """Half of the distance between the ends of the way of every mass [m], shape (f,)."""
        f, reached = self.lane.chain.freedoms, []
        for part, series in zip(self._durations / self.segments[0].span, self._series, strict=True):
            turns = np.concatenate([np.roots(series[::-1, k]) for k in range(f, 2 * f)])
            inside = turns.real[(abs(turns.imag) < REAL) & (turns.real > 0) & (turns.real < part)]
            reached.append(np.polynomial.polynomial.polyval(np.array([0.0, part, *inside]), series[:, :f]))
        return np.ptp(np.hstack(reached), axis=1) / 2

    @property
    def complex_transmittance(self) -> complex:
        """Complex amplitude of the fundamental harmonic of the last outer mass over the displacement scale."""
        chain = self.lane.chain
        return complex(self.harmonic()[chain.cells - 1] / self.lane.drive.displacement_scale(chain))

    @property
    def transmittance(self) -> float:
        """Size of `complex_transmittance`."""
        return abs(self.complex_transmittance)

    @cached_property
    def lasting(self) -> NDArray[np.intp]:
        """Indices of segments that are more than round-off."""
        return np.flatnonzero(self._durations > SHORTEST_SEGMENT * self.period)

    @cached_property
    def _durations(self) -> FloatArray:
        return np.array([segment.duration for segment in self.segments])

    @cached_property
    def _series(self) -> FloatArray:
        return np.array([segment.coefficients for segment in self.segments])

    @cached_property
    def _changes(self) -> list[tuple[int, int]]:
        """Cell from zero, and row of `lasting` with which a new mode begins, by cell and then by time."""
        modes = self.modes[self.lasting]
        rubbing = self.lane.chain.friction_bound > 0
        cells, rows = np.nonzero(((modes != np.roll(modes, 1, axis=0)) & rubbing).T)
        return list(zip(cells.tolist(), rows.tolist(), strict=True))

    @cached_property
    def _slips(self) -> FloatArray:
        """Change of the relative displacement of every contact in every segment [m], shape (segments, n)."""
        slipping = np.array([segment.modes for segment in self.segments]) != 0
        return np.where(slipping, np.array([segment.slipped for segment in self.segments]), 0.0)

    @cached_property
    def modes(self) -> NDArray[np.int8]:
        """Modes in every segment, shape (segments, n), with what is left of a shakedown as sticking."""
        modes = np.array([segment.modes for segment in self.segments])
        distance = np.sum(np.abs(self._slips), axis=0) / self.lane.drive.displacement_scale(self.lane.chain)
        one_sided = np.all(modes >= 0, axis=0) | np.all(modes <= 0, axis=0)
        modes[:, one_sided & (distance < SHAKEDOWN_SLIP) & (self.lane.chain.friction_bound > 0)] = 0
        return modes


def event_driven_model(lane: Lane) -> EventDrivenModel:
    """Give what advances a lane from event to event: the compiled chain where that suffices."""
    if isinstance(lane.chain, Chain) and lane.one_coefficient and lane.preload is None:
        return EventDrivenChain(lane)
    return EventDrivenBodies(lane)


def monodromy_matrix(model: EventDrivenModel, segments: list[Any], frequency: float) -> FloatArray:
    """Jacobian of the end of a row of segments to its start, in positions and velocities over ω, shape (2f, 2f)."""
    scale = np.repeat([1.0, frequency], model.lane.chain.freedoms)
    return model.monodromy(segments) * scale / scale[:, None]


def polished(lane: Lane, start: State, tolerance: float, thorough: bool = True) -> PeriodicOrbit:
    """Find an orbit by Newton's method, while its residual falls; `tolerance` decides the status."""
    model, drive, width = event_driven_model(lane), cast(PeriodicDrive, lane.drive), lane.chain.freedoms
    scale = drive.displacement_scale(lane.chain) * np.repeat([1.0, drive.angular_frequency], width)
    x, best, residual, periods = np.concatenate([start.positions[0], start.velocities[0]]), [], np.inf, 0
    while periods <= NEWTON_STEPS:
        segments = list(model.segments(State(x[None, :width], x[None, width:]), 0.0, drive.period))
        change = (segments[-1].states(np.array([segments[-1].duration]))[0] - x) / scale
        periods += 1
        tell(POLISHING, periods, NEWTON_STEPS)
        if not np.max(np.abs(change)) < residual:
            break
        best, residual = segments, float(np.max(np.abs(change)))
        if residual <= (ROUND_OFF if thorough else tolerance):
            break
        # X + (I − J)⁺ (g(x) − x) with g the period map; offsets of stuck cells stay as they are.
        matrix = np.eye(2 * width) - monodromy_matrix(model, segments, 2 * np.pi / drive.period)
        x = x + scale * np.linalg.lstsq(matrix, change, rcond=NULL_DIRECTION)[0]
    trajectory = model.sampled(best, lane.times(0, round(drive.period / lane.time_step)))
    return PeriodicOrbit(lane, trajectory, residual, periods, orbit_status(residual, tolerance))


def exact_orbit(
    chain: Chain,
    drive: PeriodicDrive,
    *,
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD,
    tolerance: float = EXACT_RESIDUAL,
    max_periods: int = DEFAULT_PERIODS,
    thorough: bool = True,
) -> tuple[PeriodicOrbit, ExactPeriod]:
    """Find the periodic orbit, and its segments between events; arguments are those of `exact_steady_state`.

    Newton's method ends where the residual falls no more; one that is not `thorough`, at the tolerance.
    """
    lane = Lane.periodic(chain, drive, steps_per_period)
    simulation = SequentialSimulation([event_driven_model(lane)])
    polish = partial(polished, lane, tolerance=tolerance, thorough=thorough)
    search = partial(periodic_orbits, simulation, steps_per_period, longest_multiple=1)
    steps = steps_per_period_for(chain, drive, SCHEME_STEPS)
    if steps <= MOST_SCHEME_STEPS and lane.one_coefficient:
        euler = euler_simulation([Lane.periodic(chain, drive, steps)])
        scheme = periodic_orbits(euler, steps, tolerance=SCHEME_RESIDUAL, longest_multiple=1)[0]
        if scheme.converged:
            orbit = polish(scheme.trajectory.end)
            if orbit.converged:
                return _judged(orbit, drive.period)
    orbit = search(tolerance=DEFAULT_RESIDUAL, max_periods=max_periods)[0]
    if orbit.status is not OrbitStatus.DIVERGED:
        other = polish(orbit.trajectory.end)
        best = other if other.residual < orbit.residual else orbit
        orbit = dataclasses.replace(best, periods=orbit.periods + other.periods)
    if not orbit.converged and orbit.periods < max_periods:
        again = search(start=orbit.trajectory.end, tolerance=tolerance, max_periods=max_periods - orbit.periods)[0]
        orbit = dataclasses.replace(again, periods=orbit.periods + again.periods)
    return _judged(orbit, drive.period)


def _judged(orbit: PeriodicOrbit, period: float) -> tuple[PeriodicOrbit, ExactPeriod]:
    """Give an orbit with the period [s] that follows; without dashpots, its multipliers say whether it is reached."""
    exact = ExactPeriod.following(orbit, period)
    if not (orbit.converged and orbit.lane.one_coefficient) or orbit.lane.chain.damped:
        return orbit, exact
    jacobian = monodromy_matrix(event_driven_model(orbit.lane), exact.segments, 2 * np.pi / period)
    return without_dashpots(orbit, largest_multiplier(jacobian)), exact
