"""Event-driven integration: the motion of the chain with a given normal force, exact to round-off.

Between two changes of mode the chain is linear and solved by its power series (`mode_dynamics`). A
mode ends with an event:

- the relative velocity of a slipping contact reaches zero;
- the friction force that a sticking contact needs reaches its bound μ λ_N.

Both are polynomials on each stretch of the series, and `polynomial_roots` proves either that one has no
root or finds its first: no event hides between samples, because there are no samples.
"""

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from reference_lcp.chain.simulation import Lane, check_one_coefficient, common_cells
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.errors import ParameterError
from reference_lcp.exact.event_driven_kernel import COUNTED_FROM, EVENTS, TIME, Record, follow
from reference_lcp.exact.mode_dynamics import PiecewiseLinearChain, Segment, monodromy, values
from reference_lcp.observables.stick_slip import mode_changes
from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation
from reference_lcp.validation import FloatArray
from reference_lcp.watching import tell

EVENTS_PER_SPAN = 200
"""Events of one contact within one span of the series beyond which they count as accumulating."""

SEGMENTS_AT_ONCE = 64
"""Segments between two words to whoever watches; a period of the canonical chain has some thirty."""


class EventsAccumulate(RuntimeError):
    """Contacts change their modes without end in a short time; the message says where."""


class EventDrivenModel(LaneModel):
    """One lane, advanced from event to event; the time step sets the rows only."""

    @abstractmethod
    def segments(self, state: State, start: float, end: float) -> Iterator[Any]:
        """Segments of the motion from `state`, a batch of one lane, between two times [s]."""

    @abstractmethod
    def sampled(self, segments: Sequence[Any], times: FloatArray) -> Trajectory:
        """Read segments at times [s]; λ_T is that of the instant of each row."""

    @abstractmethod
    def monodromy(self, segments: Sequence[Any]) -> FloatArray:
        """Jacobian of the end of a row of segments to its start, in positions and velocities, shape (2f, 2f)."""

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        times = self.lane.times(start, steps)
        return self.sampled(list(self.segments(state, start * self.lane.time_step, float(times[-1]))), times)

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and read the end only."""
        times = self.lane.times(start + steps - 1, 1)
        segments = list(self.segments(state, start * self.lane.time_step, float(times[0])))
        return self.sampled(segments[-1:], times).end


class EventDrivenChain(EventDrivenModel):
    """One chain under one harmonic or still drive, with given normal forces and one coefficient of friction."""

    def __init__(self, lane: Lane):
        self.lane = lane
        self.system = PiecewiseLinearChain.of(lane.chain, lane.drive)

    def sampled(self, segments: Sequence[Segment], times: FloatArray) -> Trajectory:
        """Read segments at times [s]; λ_T is that of the instant of each row."""
        n, starts = self.lane.chain.cells, np.array([segment.start for segment in segments])
        which = np.searchsorted([segment.end for segment in segments[:-1]], times)
        s = (times - starts[which]) / self.system.span
        rows = values(np.array([segment.coefficients for segment in segments]), which, s)
        friction = values(np.array([segment.friction for segment in segments]), which, s)
        normal = np.broadcast_to(self.lane.chain.normal_force, friction.shape)
        modes, bound = np.array([segment.modes for segment in segments]), self.lane.chain.friction_bound
        changes = mode_changes(modes, starts, bound > 0, cyclic=False)
        return Trajectory(times, rows[:, : 2 * n], rows[:, 2 * n : 4 * n], friction, normal, changes=changes)

    def monodromy(self, segments: Sequence[Segment]) -> FloatArray:
        """Jacobian of the end of a row of segments to its start, in (u, v, u̇, v̇), shape (4n, 4n).

        Contacts that stick at the start have one velocity for both masses; a change of it that parts them
        counts for its common part.
        """
        coefficients = np.array([segment.coefficients for segment in segments])
        durations = np.array([segment.duration for segment in segments])
        transposed: FloatArray = monodromy(self.system, durations, coefficients, np.array([s.modes for s in segments]))
        return transposed.T

    def segments(self, state: State, start: float, end: float) -> Iterator[Segment]:
        """Segments of the motion from `state`, a batch of one lane, between two times [s]."""
        n, bound = self.lane.chain.cells, self.lane.chain.friction_bound
        z = np.concatenate([state.positions[0], state.velocities[0], np.zeros(2)])
        modes = np.where(bound > 0, np.sign(z[3 * n : 4 * n] - z[2 * n : 3 * n]), 1).astype(np.int8)
        clock, nearly, most = np.array([start, 0.0, start]), end - np.spacing(end), EVENTS_PER_SPAN * n
        while clock[TIME] < end:
            tell()
            record = Record.empty(SEGMENTS_AT_ONCE, n)
            for row in range(follow(self.system, clock, end, nearly, most, z, modes, record)):
                series = record.coefficients[row], record.friction[row]
                when = float(record.start[row]), float(record.duration[row]), self.system.span
                yield Segment(*when, *series, record.modes[row])
            if clock[EVENTS] > most:
                between = f"{clock[COUNTED_FROM]:.15g} and {clock[TIME]:.15g} s"
                raise EventsAccumulate(f"{clock[EVENTS]:.0f} changes of mode between {between}")


class EventDrivenSimulation(SequentialSimulation):
    """The motion between events in closed form, and every event; a `Simulation` without a time-step error."""

    def __init__(self, lanes: Sequence[Lane]):
        common_cells(lanes)
        check_one_coefficient(lanes, "the event-driven chain")
        if any(lane.preload is not None for lane in lanes):
            raise ParameterError("the event-driven solver cannot represent a modulated normal force; allowed: constant")
        super().__init__([EventDrivenChain(lane) for lane in lanes])
