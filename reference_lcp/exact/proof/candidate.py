"""What a proof begins with, from floating point: the order of events, their times, and a state.

None of it is trusted; it only says what is to be proven.
"""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb

from reference_lcp.chain.drives import HarmonicForce
from reference_lcp.chain.simulation import Lane
from reference_lcp.defaults import FEWEST_STEPS_PER_PERIOD
from reference_lcp.exact.event_driven_system import system_of_lane
from reference_lcp.exact.exact_orbit import ExactPeriod, exact_orbit
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.validation import FloatArray

ENOUGH = 1e-8
"""Residual from which on Newton's method is left to the proof, which has more digits."""

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


def candidate(exact: ExactChain) -> Candidate:
    """Find the steady state in floating point."""
    chain, drive, _ = exact.floating()
    cycle = exact.cycle * drive.period
    motion = _motion(exact)
    length = cycle / 2 if exact.half else cycle
    modes = motion.modes[motion.lasting]
    starts = np.array([motion.segments[row].start for row in motion.lasting])
    changes = np.argwhere((modes != np.roll(modes, 1, axis=0)) & (chain.friction_bound > 0))
    events = [(float(starts[row]), int(cell), int(modes[row, cell])) for row, cell in changes]
    start = _quietest([time for time, _, _ in events], length)
    x = motion.state(start)
    if exact.half:
        x = (x - motion.state((start + length) % cycle)) / 2
    u, v, du, dv = np.split(x, 4)
    first = modes[np.searchsorted(starts, start, side="right") - 1]
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


def _motion(exact: ExactChain) -> ExactPeriod:
    """Give the period that the event-driven solver finds; where normal forces change, of the chain body by body."""
    chain, drive, preload = exact.floating()
    moved: tuple[Any, Any] = chain, drive
    if preload is not None:
        cycle = HarmonicForce(1.0, drive.angular_frequency / exact.cycle, drive.displacement_scale(chain))
        moved = system_of_lane(Lane.periodic(chain, drive, FEWEST_STEPS_PER_PERIOD, preload)), cycle
    _, period = exact_orbit(*moved, tolerance=ENOUGH, thorough=False)
    return period


def _quietest(times: list[float], length: float) -> float:
    """Give the middle of the longest gap between times, all of them modulo a length; zero without any."""
    if not times:
        return 0.0
    phases = np.sort(np.array(times) % length)
    gaps = np.diff(np.append(phases, phases[0] + length))
    return float((phases[np.argmax(gaps)] + gaps.max() / 2) % length)


def _centred(found: Candidate, exact: ExactChain, motion: ExactPeriod, times: FloatArray) -> Candidate:
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
