"""What a proof begins with, from floating point: the order of events, their times, and a state.

None of it is trusted; it only says what is to be proven.
"""

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from flint import arb
from numpy.typing import NDArray

from reference_lcp.chain.simulation import Lane, steps_per_period_for
from reference_lcp.chain.trajectory import State
from reference_lcp.exact.event_driven_system import EventDrivenSystem, system_of
from reference_lcp.exact.exact_orbit import SHORTEST_SEGMENT, exact_orbit
from reference_lcp.exact.mode_dynamics import harmonic_load
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.lcp.systems import Harmonic
from reference_lcp.schemes.euler import CompiledSimulation
from reference_lcp.steady.orbits import periodic_orbits
from reference_lcp.validation import FloatArray
from reference_lcp.watching import tell

SCHEME_STEPS = 1600
"""Steps a period of the Euler scheme's steady state, with which the search begins where normal forces change."""

ENOUGH = 1e-8
"""Residual from which on Newton's method is left to the proof, which has more digits."""

SETTLING_CYCLES = 300
"""Cycles from rest where drive and normal force repeat together only after several periods."""

SAMPLES = 500
"""Instants at which a sticking force is read, to centre it between its bounds."""

Number = float | arb
Event = tuple[int, int]
"""Cell from zero, and its new mode."""


@dataclass(frozen=True)
class Candidate:
    """The motion from a time t0 until the drive repeats, or is its own opposite: what happens, and about when."""

    start: float
    """t0, between events."""
    first: tuple[int, ...]
    """Modes at t0."""
    events: tuple[Event, ...]
    times: tuple[Number, ...]
    """When the events happen."""
    state: tuple[Number, ...]
    """(u, g, u̇, ġ) at t0."""

    @property
    def modes(self) -> list[tuple[int, ...]]:
        """Modes of every stretch, one more than events."""
        modes = [self.first]
        for cell, new in self.events:
            modes.append((*modes[-1][:cell], new, *modes[-1][cell + 1 :]))
        return modes

    @property
    def always_stuck(self) -> set[int]:
        """Cells that never slip."""
        return {cell for cell, mode in enumerate(self.first) if mode == 0} - {cell for cell, _ in self.events}

    @property
    def unknown(self) -> list[int]:
        """Entries of the state that are searched: no offset of cells that never slip, no slip of those at rest."""
        n, stuck = len(self.first), self.always_stuck
        fixed = {n + cell for cell in stuck} | {3 * n + cell for cell, mode in enumerate(self.first) if mode == 0}
        return [k for k in range(4 * n) if k not in fixed]

    def moved_to(self, values: Sequence[Number]) -> "Candidate":
        """Give the same events with other numbers: those that are searched, then times."""
        state, unknown = list(self.state), self.unknown
        for k, value in zip(unknown, values[: len(unknown)], strict=True):
            state[k] = value
        return dataclasses.replace(self, state=tuple(state), times=tuple(values[len(unknown) :]))

    def with_offsets(self, offsets: dict[int, float]) -> "Candidate":
        """Give the same with these v − u at t0 of cells that never slip."""
        n, state = len(self.first), list(self.state)
        for cell, offset in offsets.items():
            state[n + cell] = offset
        return dataclasses.replace(self, state=tuple(state))


@dataclass(frozen=True)
class FloatMotion:
    """A motion in floating point from t = 0 over whole periods."""

    starts: FloatArray
    """When each stretch of unchanged modes begins, shape (stretches,)."""
    modes: NDArray[np.int8]
    """Shape (stretches, n)."""
    state: Callable[[float], FloatArray]
    """(u, v, u̇, v̇) at a time."""


def candidate(exact: ExactChain) -> Candidate:
    """Find the steady state in floating point."""
    chain, drive, preload = exact.floating()
    cycle = exact.cycle * drive.period
    motion = _constant(exact) if preload is None else _modulated(exact)
    length = cycle / 2 if exact.half else cycle
    events = _events(motion, chain.friction_bound > 0)
    start = _quietest([time for time, _, _ in events], length)
    x = motion.state(start)
    if exact.half:
        x = (x - motion.state((start + length) % cycle)) / 2
    u, v, du, dv = np.split(x, 4)
    row = np.searchsorted(motion.starts, start, side="right") - 1
    first = motion.modes[row]
    ahead = sorted(((time - start) % cycle, cell, new) for time, cell, new in events)
    ahead = [event for event in ahead if event[0] < length]
    state = np.concatenate([u, v - u, du, np.where(first == 0, 0.0, dv - du)])
    found = Candidate(
        start,
        tuple(map(int, first)),
        tuple((cell, new) for _, cell, new in ahead),
        tuple(start + time for time, _, _ in ahead),
        tuple(state.tolist()),
    )
    return _centred(found, exact, motion, np.linspace(0, cycle, SAMPLES, endpoint=False))


def _constant(exact: ExactChain) -> FloatMotion:
    """Give the period that the event-driven solver finds."""
    chain, drive, _ = exact.floating()
    _, period = exact_orbit(chain, drive, tolerance=ENOUGH, thorough=False)
    rows, ends = period.lasting, np.array([segment.end for segment in period.segments])

    def state(time: float) -> FloatArray:
        segment = period.segments[min(int(np.searchsorted(ends, time)), ends.size - 1)]
        return segment.states(np.array([time - segment.start]))[0]

    return FloatMotion(np.array([period.segments[row].start for row in rows]), period.modes[rows], state)


def _modulated(exact: ExactChain) -> FloatMotion:
    """Go from event to event from where the Euler scheme repeats."""
    chain, drive, preload = exact.floating()
    cycle = exact.cycle * drive.period
    steps = steps_per_period_for(chain, drive, SCHEME_STEPS)
    lane = Lane.periodic(chain, drive, steps, preload)
    simulation = CompiledSimulation([lane])
    if exact.cycle == 1:
        end = periodic_orbits(simulation, steps, longest_multiple=1)[0].trajectory.end
    else:
        end = State.at_rest(1, exact.cells)
        for _ in range(SETTLING_CYCLES):
            tell()
            end = simulation.advance(end, 0, steps * exact.cycle)
    omega, (sine, cosine) = harmonic_load(chain, drive)
    load = Harmonic(
        amplitude=float(np.hypot(sine, cosine)), angular_frequency=omega, phase=float(np.arctan2(cosine, sine))
    )
    solver = EventDrivenSystem(system_of(chain, load, preload=preload))
    every = solver.stretches(position=end.positions[0], velocity=end.velocities[0], end=cycle)
    stretches = [each for each in every if each.duration > SHORTEST_SEGMENT * cycle]
    starts = np.array([each.start for each in stretches])

    def state(time: float) -> FloatArray:
        stretch = stretches[max(int(np.searchsorted(starts, time, side="right")) - 1, 0)]
        return stretch.values(stretch.motion, time)[0]

    return FloatMotion(starts, np.array([each.modes for each in stretches]), state)


def _events(motion: FloatMotion, rubbing: NDArray[np.bool_]) -> list[tuple[float, int, int]]:
    """Times, cells and new modes of all changes, the first row after the last."""
    modes = motion.modes
    changes = np.argwhere((modes != np.roll(modes, 1, axis=0)) & rubbing)
    return [(float(motion.starts[row]), int(cell), int(modes[row, cell])) for row, cell in changes]


def _quietest(times: list[float], length: float) -> float:
    """Give the middle of the longest gap between times, all of them modulo a length; zero without any."""
    if not times:
        return 0.0
    phases = np.sort(np.array(times) % length)
    gaps = np.diff(np.append(phases, phases[0] + length))
    return float((phases[np.argmax(gaps)] + gaps.max() / 2) % length)


def _centred(found: Candidate, exact: ExactChain, motion: FloatMotion, times: FloatArray) -> Candidate:
    """Give cells that never slip the offset that keeps their force farthest from its bounds; zero by symmetry."""
    if exact.half or not found.always_stuck:
        return found.with_offsets(dict.fromkeys(found.always_stuck, 0.0))
    chain, drive, preload = exact.floating()
    n, states = exact.cells, np.array([motion.state(time) for time in times.tolist()])
    forces = -states[:, : 2 * n] @ chain.stiffness_matrix - states[:, 2 * n :] @ chain.damping_matrix
    forces[:, 0] += drive.load(chain, times)
    outer, inner = forces[:, :n], forces[:, n:]
    friction = chain.inner_mass / (chain.outer_mass + chain.inner_mass) * (outer + inner) - inner
    bound = chain.friction_bound * (1.0 if preload is None else preload.factor(times)[:, None])
    shift = (np.min(bound - friction, axis=0) - np.min(bound + friction, axis=0)) / (2 * chain.inner_stiffness)
    return found.with_offsets({cell: float(found.state[n + cell]) + float(shift[cell]) for cell in found.always_stuck})
