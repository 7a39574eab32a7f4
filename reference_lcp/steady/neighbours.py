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

import numpy as np

from reference_lcp.chain.simulation import OrbitStatus, PeriodicOrbit, Simulation
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import DEFAULT_PERIODS
from reference_lcp.schemes.euler import euler_simulation
from reference_lcp.steady.attraction import jacobians
from reference_lcp.steady.orbits import LONGEST_MULTIPLE, periodic_orbits, searched
from reference_lcp.validation import FloatArray

LASTING = 5e-3
"""Singular values of I − J below this belong to offsets that last, if what they move is at rest.

Those of cells that stay stuck, and of masses so heavy that they stand, change no amplitude, and are no error. A cell
that sticks just at its limit gives way at once: on Figure 3 such values are 1e-4 to 4e-3, of motions 0.03 at least.
"""

AT_REST = 1e-2
"""Largest part of a direction, of length one, that may be velocities, over their scales, in an offset that lasts:
where a cell sticks at its limit up to 0.01, in motions 0.38 and more."""

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
        width = 2 * orbits[0].lane.chain.freedoms
        left, sizes, right = np.linalg.svd(
            np.eye(width) - jacobians(euler_simulation([own.lane for own in orbits]), orbits)
        )
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


def beside_euler(
    simulation: Simulation,
    steps: int,
    *,
    tolerance: float,
    max_periods: int = DEFAULT_PERIODS,
    start: State | None = None,
) -> list[PeriodicOrbit]:
    """Search from the steady states of Euler's scheme, or `start`, by Newton's steps with the Jacobians there, mixed.

    A step may lead to where an engine's motion grows without bound: such a search begins anew, from harmonic balance.
    """
    if simulation.lanes[0].chain.cells > LONGEST_CHAIN:
        return periodic_orbits(simulation, steps, tolerance=tolerance)
    euler = periodic_orbits(euler_simulation(simulation.lanes), steps, longest_multiple=1)
    ends = State.stack([State(orbit.trajectory.end.positions, orbit.trajectory.end.velocities) for orbit in euler])
    newton, start = PeriodInverse.of(euler).newton, ends if start is None else start
    orbits = searched(simulation, start, steps, tolerance, max_periods, LONGEST_MULTIPLE, newton)
    lost = [number for number, orbit in enumerate(orbits) if orbit.status is OrbitStatus.DIVERGED]
    if lost:
        again = periodic_orbits(simulation.subset(lost), steps, tolerance=tolerance)
        orbits = [again[lost.index(number)] if number in lost else orbit for number, orbit in enumerate(orbits)]
    return orbits


def refined_orbits(
    orbit: PeriodicOrbit, factors: Sequence[int], inverse: PeriodInverse, *, tolerance: float, max_periods: int
) -> list[PeriodicOrbit]:
    """Find the Euler scheme's steady states with several times as many steps a period: one for each factor."""
    ladder = [orbit]
    for factor in factors:
        simulation = euler_simulation([replace(orbit.lane, time_step=orbit.lane.time_step / factor)])
        steps, found = orbit.trajectory.steps * factor, None
        if ladder[-1].converged:
            start, limit = _extrapolated(ladder, steps), min(max_periods, NEWTON_PERIODS)
            (found,) = searched(simulation, start, steps, tolerance, limit, 1, inverse.newton)
        if found is None or not found.converged:
            (found,) = periodic_orbits(simulation, steps, tolerance=tolerance, max_periods=max_periods)
        ladder.append(found)
    return ladder[1:]


def _extrapolated(ladder: Sequence[PeriodicOrbit], steps: int) -> State:
    """State with so many steps, by the first order of the last two numbers of steps; that of the last one without."""
    *before, last = [orbit.trajectory.end for orbit in ladder[-2:]]
    if not before:
        return last
    sizes = [1 / orbit.trajectory.steps for orbit in ladder[-2:]]
    part = (sizes[1] - 1 / steps) / (sizes[0] - sizes[1])
    return State(
        last.positions + part * (last.positions - before[0].positions),
        last.velocities + part * (last.velocities - before[0].velocities),
        last.internal_state,
    )
