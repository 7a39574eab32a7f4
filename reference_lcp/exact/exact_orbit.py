"""One period of event-driven motion: its transitions, harmonics and energies without sampling error."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.simulation import Lane
from reference_lcp.exact.event_driven import EventDrivenChain
from reference_lcp.exact.mode_dynamics import Segment
from reference_lcp.observables.stick_slip import MODE_OF_SIGN, Transition
from reference_lcp.steady.orbits import PeriodicOrbit
from reference_lcp.validation import FloatArray

QUADRATURE_POINTS = 16
"""Gauss points on each segment: exact up to degree 31, of polynomials whose coefficients fall as 1 / k!."""

SHORTEST_SEGMENT = 1e-12
"""Segments shorter than this part of the period are none: events that coincide but for round-off."""

SHAKEDOWN_SLIP = 1e-6
"""Slip to one side only, over the displacement scale, that counts as none.

What slips forward in a steady state must slip back. A contact that creeps to one side is on its way to
where it sticks throughout (shakedown), which it reaches in the limit only; the slip left over is of the
size of the periodicity residual.
"""


@dataclass(frozen=True)
class ExactPeriod:
    """The segments of one period of a steady state.

    Parameters
    ----------
    lane
        The chain and its periodic drive.
    segments
        From phase zero of the drive over one period.
    """

    lane: Lane
    segments: list[Segment]

    @classmethod
    def following(cls, orbit: PeriodicOrbit, period: float) -> "ExactPeriod":
        """Go through the period [s] that follows the recorded one of an orbit, which is the same but for its residual.

        The end of the recorded period has sticking contacts at rest, which the mixed start of it need not have.
        """
        segments = EventDrivenChain(orbit.lane).segments(orbit.trajectory.end, 0.0, period)
        return cls(orbit.lane, list(segments))

    @property
    def period(self) -> float:
        """Length [s]."""
        return self.segments[-1].end - self.segments[0].start

    @property
    def transitions(self) -> list[Transition]:
        """Changes of mode by cell and then by time, at their exact times; as `stick_slip.transitions`."""
        modes = self._modes[self._lasting]
        return [
            Transition(int(cell) + 1, self.segments[self._lasting[row]].start, MODE_OF_SIGN[int(modes[row, cell])])
            for cell, row in self._changes
        ]

    @property
    def travels(self) -> list[float]:
        """Distance [m] that the contact slips in the phase that each transition begins; zero where it sticks."""
        slips = np.abs(self._slips[self._lasting])
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
        durations = np.array([[segment.duration] for segment in self.segments])
        sticks = self._modes == 0
        sums: FloatArray = np.sum(durations * sticks, axis=0) / np.sum(durations * np.ones_like(sticks), axis=0)
        return sums

    def harmonic(self, order: int = 1) -> NDArray[np.complex128]:
        """Complex amplitudes [m] of a harmonic of all masses, shape (2n,), outer masses first.

        A displacement A sin(kωt + φ) gives A exp(iφ), as `transmittance.fundamental` does for k = 1.
        """
        phases = np.exp(-2j * np.pi * order / self.period * self._times)
        positions = self._states[:, : 2 * self.lane.chain.cells]
        amplitudes: NDArray[np.complex128] = 2j / self.period * ((self._weights * phases) @ positions)
        return amplitudes

    @property
    def complex_transmittance(self) -> complex:
        """Complex amplitude of the fundamental harmonic of the last outer mass over the displacement scale."""
        chain = self.lane.chain
        return complex(self.harmonic()[chain.cells - 1] / self.lane.drive.displacement_scale(chain))

    @property
    def transmittance(self) -> float:
        """Amplitude of the fundamental harmonic of the last outer mass over the displacement scale."""
        return abs(self.complex_transmittance)

    @property
    def friction_heat(self) -> FloatArray:
        """Energy that each contact turns into heat [J], shape (n,): the bound times the distance slipped."""
        return self.lane.chain.friction_bound * np.sum(np.abs(self._slips), axis=0)

    @property
    def dashpot_heat(self) -> float:
        """∫ qᵀ C q dt [J]; with the load of a moving base, what its dashpot takes is in both."""
        velocities = self._states[:, 2 * self.lane.chain.cells :]
        return float(self._weights @ np.einsum("ti,ij,tj->t", velocities, self.lane.chain.damping_matrix, velocities))

    @property
    def work_of_load(self) -> float:
        """Work that the drive's load does on the outer mass of cell 1 [J]."""
        velocity = self._states[:, 2 * self.lane.chain.cells]
        return float(self._weights @ (self.lane.drive.load(self.lane.chain, self._times) * velocity))

    @cached_property
    def _lasting(self) -> NDArray[np.intp]:
        """Indices of segments that are more than round-off."""
        durations = np.array([segment.duration for segment in self.segments])
        return np.flatnonzero(durations > SHORTEST_SEGMENT * self.period)

    @cached_property
    def _changes(self) -> list[tuple[int, int]]:
        """Cell from zero, and row of `_lasting` with which a new mode begins, by cell and then by time."""
        modes = self._modes[self._lasting]
        rubbing = self.lane.chain.friction_bound > 0
        cells, rows = np.nonzero(((modes != np.roll(modes, 1, axis=0)) & rubbing).T)
        return list(zip(cells.tolist(), rows.tolist(), strict=True))

    @cached_property
    def _slips(self) -> FloatArray:
        """Change of the relative displacement of every contact in every segment [m], shape (segments, n)."""
        n = self.lane.chain.cells
        ends = np.array([s.states(np.array([0.0, s.duration]))[:, : 2 * n] for s in self.segments])
        changes = ends[:, 1] - ends[:, 0]
        slipping = np.array([segment.modes for segment in self.segments]) != 0
        return np.where(slipping, changes[:, n:] - changes[:, :n], 0.0)

    @cached_property
    def _modes(self) -> NDArray[np.int8]:
        """Modes in every segment, shape (segments, n), with what is left of a shakedown as sticking."""
        modes = np.array([segment.modes for segment in self.segments])
        distance = np.sum(np.abs(self._slips), axis=0) / self.lane.drive.displacement_scale(self.lane.chain)
        one_sided = np.all(modes >= 0, axis=0) | np.all(modes <= 0, axis=0)
        modes[:, one_sided & (distance < SHAKEDOWN_SLIP) & (self.lane.chain.friction_bound > 0)] = 0
        return modes

    @cached_property
    def _nodes(self) -> tuple[FloatArray, FloatArray]:
        """Gauss points and weights on [0, 1]."""
        points, weights = np.polynomial.legendre.leggauss(QUADRATURE_POINTS)
        return (points + 1) / 2, weights / 2

    @cached_property
    def _times(self) -> FloatArray:
        return np.concatenate([s.start + s.duration * self._nodes[0] for s in self.segments])

    @cached_property
    def _weights(self) -> FloatArray:
        return np.concatenate([s.duration * self._nodes[1] for s in self.segments])

    @cached_property
    def _states(self) -> FloatArray:
        return np.concatenate([s.states(s.duration * self._nodes[0]) for s in self.segments])
