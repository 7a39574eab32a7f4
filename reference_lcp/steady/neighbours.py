"""The period map close to a known steady state: how far a motion is from there, and others found beside it.

A motion that comes back after a period by r beside where it was is (I − J)⁺ r from the steady state, J being the
Jacobian of the period map of the Euler scheme there: of the free modes and of the modes in which contacts stick, for
as long as they do in a period.

So the steady state of a map that is near to another is found beside that one's: Newton's steps with the Jacobian of the
known map, mixed, take some ten periods where a search from harmonic balance takes thirty. The residual of a plain
period certifies what is found, as anywhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from reference_lcp.chain.simulation import PeriodicOrbit, Simulation
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import DEFAULT_PERIODS
from reference_lcp.schemes.euler import CompiledSimulation, euler_simulation
from reference_lcp.steady.anderson import WARM_UP_PERIODS, StateScales
from reference_lcp.steady.attraction import OFFSET
from reference_lcp.steady.harmonic_balance import harmonic_balance_start
from reference_lcp.steady.orbits import LONGEST_MULTIPLE, part_of, periodic_orbits, searched
from reference_lcp.validation import FloatArray

LASTING = 1e-4
"""Singular values of I − J below this belong to offsets that last, if what they move is at rest.

Those of cells that stay stuck, and of masses so heavy that they stand, change no amplitude, and are no error.
"""

AT_REST = 1e-3
"""Largest part of a direction, of length one, that may be velocities, over their scales, in an offset that lasts."""

NEWTON_PERIODS = 40
"""Periods after which a search beside a known steady state begins anew at harmonic balance; near ones need 8 to 25."""

LONGEST_CHAIN = 100
"""Most cells whose Jacobian is taken: 4n periods, and 64 n³ operations, cost less than what they save."""


@dataclass(frozen=True)
class PeriodInverse:
    """What the residual of a period says of the distance from the steady state, for several orbits."""

    distance: FloatArray
    """(I − J)⁺, shape (orbits, 4n, 4n), for scaled states as those of `StateScales`."""
    unexplained: FloatArray
    """Projector on the residuals that no distance makes, of the same shape; zero where no cell stays stuck."""

    @classmethod
    def of(cls, orbits: Sequence[PeriodicOrbit]) -> "PeriodInverse":
        """Take the Jacobians of the orbits together; their number of cells and of steps a period is the same."""
        width = 4 * orbits[0].lane.chain.cells
        left, sizes, right = np.linalg.svd(np.eye(width) - _jacobians(orbits))
        at_rest = np.linalg.norm(right[:, :, width // 2 :], axis=2) < AT_REST
        lasts = (sizes < LASTING) & at_rest
        shown = np.where(lasts, 0.0, 1 / np.where(lasts, 1.0, sizes))
        outside = np.where(lasts[:, None], left, 0.0)
        distance = (right.swapaxes(1, 2) * shown[:, None]) @ left.swapaxes(1, 2)
        return cls(distance, outside @ outside.swapaxes(1, 2))

    @property
    def newton(self) -> FloatArray:
        """Newton's step from a residual, shape (orbits, 4n, 4n); plain where cells stay stuck."""
        return self.distance + self.unexplained

    @property
    def amplification(self) -> FloatArray:
        """Largest component of a distance over that of its residual, at least 1, shape (orbits,)."""
        return np.maximum(1.0, np.max(np.sum(np.abs(self.distance), axis=2), axis=1))


def residual_amplification(orbit: PeriodicOrbit) -> float:
    """How many times farther from the steady state a motion may be than its residual; >= 1, in the residual's norm."""
    return float(PeriodInverse.of([orbit]).amplification[0])


def _jacobians(orbits: Sequence[PeriodicOrbit]) -> FloatArray:
    """Jacobians of the period maps at the ends of the orbits, shape (orbits, 4n, 4n): all of them in one batch."""
    lanes, steps = [orbit.lane for orbit in orbits], orbits[0].trajectory.steps
    width = 4 * lanes[0].chain.cells
    scales, every = StateScales(lanes, steps), np.repeat(np.arange(len(lanes)), width + 1)
    end = State.stack([orbit.trajectory.end for orbit in orbits])
    vectors = scales.vectors(State(end.positions, end.velocities), np.arange(len(lanes)))
    offsets = np.vstack([np.zeros(width), OFFSET * np.eye(width)])
    moved = scales.state((vectors[:, None] + offsets).reshape(-1, width), every)
    gaps = None if end.internal_state is None else end.internal_state[every]
    simulation = euler_simulation(lanes).subset(every)
    ends = simulation.advance(State(moved.positions, moved.velocities, gaps), 0, steps)
    after = scales.vectors(State(ends.positions, ends.velocities), every).reshape(len(lanes), width + 1, width)
    return (after[:, 1:] - after[:, :1]).swapaxes(1, 2) / OFFSET


def orbits_warm_started(
    simulation: Simulation,
    start: State,
    known: Sequence[bool],
    newton: FloatArray,
    steps: int,
    *,
    tolerance: float,
    max_periods: int = DEFAULT_PERIODS,
    longest_multiple: int = LONGEST_MULTIPLE,
    anew: bool = True,
) -> list[PeriodicOrbit]:
    """Find the periodic orbit of every lane: beside a known one, where `known`, and from harmonic balance where not.

    `newton` holds Newton's steps of the known map, see `FixedPointSearch`; `anew`, whether a lane that is not found
    beside its known orbit is searched from balance too.
    """
    near = np.flatnonzero(known).tolist()
    orbits: dict[int, PeriodicOrbit] = {}
    if near:
        periods, multiple = min(max_periods, NEWTON_PERIODS), 1 if anew else longest_multiple
        part = part_of(simulation, near)
        searches = searched(part, start.subset(near), steps, tolerance, periods, multiple, newton[near])
        orbits = {lane: orbit for lane, orbit in zip(near, searches, strict=True) if orbit.converged or not anew}
    late = [lane for lane in range(len(simulation.lanes)) if lane not in orbits]
    if late:
        search = partial(periodic_orbits, max_periods=max_periods, longest_multiple=longest_multiple)
        balanced = search(part_of(simulation, late), steps, tolerance=tolerance)
        orbits |= dict(zip(late, balanced, strict=True))
    return [orbits[lane] for lane in range(len(simulation.lanes))]


def orbits_from_euler(
    simulation: Simulation,
    steps: int,
    *,
    tolerance: float,
    start: State | None = None,
    max_periods: int = DEFAULT_PERIODS,
    longest_multiple: int = LONGEST_MULTIPLE,
    anew: bool = True,
) -> list[PeriodicOrbit]:
    """Find the periodic orbits of something that steps nearly like the Euler scheme, from the scheme's or `start`."""
    if simulation.lanes[0].chain.cells > LONGEST_CHAIN:
        return periodic_orbits(
            simulation, steps, tolerance=tolerance, max_periods=max_periods, longest_multiple=longest_multiple
        )
    euler = periodic_orbits(euler_simulation(simulation.lanes), steps, longest_multiple=1)
    ends = State.stack([State(orbit.trajectory.end.positions, orbit.trajectory.end.velocities) for orbit in euler])
    return orbits_warm_started(
        simulation,
        ends if start is None else start,
        [orbit.converged for orbit in euler],
        PeriodInverse.of(euler).newton,
        steps,
        tolerance=tolerance,
        max_periods=max_periods,
        longest_multiple=longest_multiple,
        anew=anew,
    )


def orbits_from_balance(simulation: Simulation, steps: int, *, tolerance: float) -> list[PeriodicOrbit]:
    """Find the periodic orbit of every lane from harmonic balance: plain periods decide to which the motion goes."""
    balanced = harmonic_balance_start(simulation.lanes, steps)
    start = simulation.advance(balanced, 0, WARM_UP_PERIODS * steps)
    orbits = orbits_from_euler(simulation, steps, tolerance=tolerance, start=start)
    return [replace(orbit, periods=orbit.periods + WARM_UP_PERIODS) for orbit in orbits]


def refined_orbits(
    orbits: Sequence[PeriodicOrbit],
    factors: Sequence[int],
    inverse: PeriodInverse,
    *,
    tolerance: float,
    max_periods: int,
) -> list[list[PeriodicOrbit]]:
    """Find the Euler scheme's steady states with several times as many steps a period: for each factor one a lane."""
    ladder = [list(orbits)]
    for factor in factors:
        lanes = [replace(orbit.lane, time_step=orbit.lane.time_step / factor) for orbit in orbits]
        simulation, steps = CompiledSimulation(lanes), orbits[0].trajectory.steps * factor
        known, start = [orbit.converged for orbit in ladder[-1]], _extrapolated(ladder, steps)
        ladder.append(
            orbits_warm_started(
                simulation, start, known, inverse.newton, steps, tolerance=tolerance, max_periods=max_periods
            )
        )
    return ladder[1:]


def _extrapolated(ladder: Sequence[Sequence[PeriodicOrbit]], steps: int) -> State:
    """State with so many steps, by the first order of the last two numbers of steps; that of the last one without."""
    *_, last = ends = [State.stack([orbit.trajectory.end for orbit in orbits]) for orbits in ladder[-2:]]
    if len(ends) == 1:
        return last
    sizes = [1 / orbits[0].trajectory.steps for orbits in ladder[-2:]]
    part = (sizes[1] - 1 / steps) / (sizes[0] - sizes[1])
    return State(
        last.positions + part * (last.positions - ends[0].positions),
        last.velocities + part * (last.velocities - ends[0].velocities),
        last.internal_state,
    )
