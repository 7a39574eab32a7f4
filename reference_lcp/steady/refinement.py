"""Steady states with finer steps, each found from the ones with coarser steps before it.

They differ by a first order in the step, and so do the Jacobians of their period maps: Newton's steps with the coarsest
one's lead to the next in some five periods, where a search from harmonic balance takes thirty.
"""

import dataclasses
from collections.abc import Sequence

from reference_lcp.chain.trajectory import State
from reference_lcp.steady.amplification import PeriodInverse
from reference_lcp.steady.neighbours import orbits_beside
from reference_lcp.steady.orbits import PeriodicOrbit
from reference_lcp.stepping.euler_compiled import CompiledSimulation


def refined_orbits(
    orbits: Sequence[PeriodicOrbit],
    factors: Sequence[int],
    inverse: PeriodInverse,
    *,
    tolerance: float,
    max_periods: int,
) -> list[list[PeriodicOrbit]]:
    """Find the steady states of the Euler scheme with several times as many steps a period.

    Parameters
    ----------
    orbits
        Of chains of one length, with one number of steps a period.
    factors
        By which that number is multiplied, ascending.
    inverse
        That of the period maps of `orbits`.
    tolerance, max_periods
        As for `periodic_orbits`; lanes that are not found from the coarser ones are searched anew.

    Returns
    -------
    list of list of PeriodicOrbit
        For each factor one a lane.
    """
    ladder = [list(orbits)]
    for factor in factors:
        lanes = [dataclasses.replace(orbit.lane, time_step=orbit.lane.time_step / factor) for orbit in orbits]
        simulation, steps = CompiledSimulation(lanes), orbits[0].trajectory.steps * factor
        known = [orbit.converged for orbit in ladder[-1]]
        start = _extrapolated(ladder, steps)
        ladder.append(
            orbits_beside(simulation, start, known, inverse.newton, steps, tolerance=tolerance, max_periods=max_periods)
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
