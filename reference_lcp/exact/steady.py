"""The exact steady state: Anderson acceleration, then Newton's method, on the event-driven period map."""

import dataclasses
from functools import partial

from reference_lcp.chain.harmonic import PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.step_limits import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.exact.event_driven import EventDrivenSimulation
from reference_lcp.exact.exact_orbit import ExactPeriod
from reference_lcp.exact.monodromy import polished
from reference_lcp.steady.limits import DEFAULT_PERIODS, DEFAULT_RESIDUAL, EXACT_RESIDUAL
from reference_lcp.steady.orbits import PeriodicOrbit, periodic_orbits


def exact_orbit(
    chain: Chain,
    drive: PeriodicDrive,
    *,
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD,
    tolerance: float = EXACT_RESIDUAL,
    max_periods: int = DEFAULT_PERIODS,
) -> tuple[PeriodicOrbit, ExactPeriod]:
    """Find the periodic orbit of `chain` under `drive`, and its segments between events.

    Parameters and errors are those of `reference_lcp.exact_steady_state`.
    """
    simulation = EventDrivenSimulation([Lane.periodic(chain, drive, steps_per_period)])
    search = partial(periodic_orbits, simulation, steps_per_period, longest_multiple=1)
    orbit = polished(search(tolerance=DEFAULT_RESIDUAL, max_periods=max_periods)[0], steps_per_period, tolerance)
    if not orbit.converged and orbit.periods < max_periods:
        again = search(start=orbit.trajectory.end, tolerance=tolerance, max_periods=max_periods - orbit.periods)[0]
        orbit = dataclasses.replace(again, periods=orbit.periods + again.periods)
    return orbit, ExactPeriod.following(orbit, drive.period)
