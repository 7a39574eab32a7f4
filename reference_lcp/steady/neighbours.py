"""Steady states found beside known ones: those of a map that is near to another whose steady states are known.

Newton's steps with the Jacobian of the known map, mixed, take some ten periods where a search from harmonic balance
takes thirty. The residual of a plain period certifies what is found, as anywhere.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from reference_lcp.chain.simulation import Simulation
from reference_lcp.chain.trajectory import State
from reference_lcp.steady.amplification import PeriodInverse
from reference_lcp.steady.anderson import WARM_UP_PERIODS
from reference_lcp.steady.harmonic_balance import harmonic_balance_start
from reference_lcp.steady.limits import DEFAULT_PERIODS
from reference_lcp.steady.orbits import PeriodicOrbit, part_of, periodic_orbits, searched
from reference_lcp.steady.subharmonics import LONGEST_MULTIPLE
from reference_lcp.stepping.euler import euler_simulation
from reference_lcp.validation import FloatArray

NEWTON_PERIODS = 40
"""Periods after which a search beside a known steady state gives up, and begins anew at harmonic balance.

Of laws and engines that were tried, those that are near enough to the Euler scheme for Newton's steps need 8 to 25.
"""

LONGEST_CHAIN = 100
"""Most cells whose Jacobian is taken: 4n periods, and 64 n³ operations, cost less than what they save."""


def orbits_beside(
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
    """Find the periodic orbit of every lane: beside a known one where there is one, and anew where that fails.

    Parameters
    ----------
    simulation, steps, tolerance, max_periods, longest_multiple
        As for `periodic_orbits`.
    start
        States of the known orbits, or others near to them.
    known
        Which lanes have one.
    newton
        Newton's steps of the known map, shape (lanes, 4n, 4n); see `FixedPointSearch`.
    anew
        Whether lanes whose orbit is not found beside a known one are searched from harmonic balance.
    """
    near = np.flatnonzero(known).tolist()
    orbits: dict[int, PeriodicOrbit] = {}
    if near:
        periods = min(max_periods, NEWTON_PERIODS)
        multiple = 1 if anew else longest_multiple
        part = part_of(simulation, near)
        searches = searched(part, start.subset(near), steps, tolerance, periods, multiple, newton[near])
        orbits = {lane: orbit for lane, orbit in zip(near, searches, strict=True) if orbit.converged or not anew}
    late = [lane for lane in range(len(simulation.lanes)) if lane not in orbits]
    if late:
        balanced = periodic_orbits(
            part_of(simulation, late),
            steps,
            tolerance=tolerance,
            max_periods=max_periods,
            longest_multiple=longest_multiple,
        )
        orbits |= dict(zip(late, balanced, strict=True))
    return [orbits[lane] for lane in range(len(simulation.lanes))]


def orbits_beside_euler(
    simulation: Simulation,
    steps: int,
    *,
    tolerance: float,
    start: State | None = None,
    longest_multiple: int = LONGEST_MULTIPLE,
    anew: bool = True,
) -> list[PeriodicOrbit]:
    """Find the periodic orbit of every lane of something that steps nearly like the Euler scheme.

    Parameters
    ----------
    simulation, steps, tolerance, longest_multiple
        As for `periodic_orbits`.
    start
        State in which the search begins; without it, in the steady state of the Euler scheme.
    anew
        As for `orbits_beside`.
    """
    if simulation.lanes[0].chain.cells > LONGEST_CHAIN:
        return periodic_orbits(simulation, steps, tolerance=tolerance, longest_multiple=longest_multiple)
    euler = periodic_orbits(euler_simulation(simulation.lanes), steps, longest_multiple=1)
    ends = State.stack([State(orbit.trajectory.end.positions, orbit.trajectory.end.velocities) for orbit in euler])
    return orbits_beside(
        simulation,
        ends if start is None else start,
        [orbit.converged for orbit in euler],
        PeriodInverse.of(euler).newton,
        steps,
        tolerance=tolerance,
        longest_multiple=longest_multiple,
        anew=anew,
    )


def orbits_from_balance(simulation: Simulation, steps: int, *, tolerance: float) -> list[PeriodicOrbit]:
    """Find the periodic orbit of every lane from harmonic balance, whatever steady state is known nearby.

    Plain periods decide to which orbit the motion goes; Newton's steps beside the Euler scheme then take ten periods
    where others take thirty.

    Parameters
    ----------
    simulation, steps, tolerance
        As for `periodic_orbits`.
    """
    balanced = harmonic_balance_start(simulation.lanes, steps)
    start = simulation.advance(balanced, 0, WARM_UP_PERIODS * steps)
    orbits = orbits_beside_euler(simulation, steps, tolerance=tolerance, start=start)
    return [replace(orbit, periods=orbit.periods + WARM_UP_PERIODS) for orbit in orbits]
