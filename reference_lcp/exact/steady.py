"""The exact steady state: Newton's method on the event-driven period map, from the Euler scheme's steady state.

Where that does not lead to one, Anderson acceleration leads from rest to where Newton's method takes over.
"""

import dataclasses
from functools import partial

from reference_lcp.chain.harmonic import PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, steps_per_period_for
from reference_lcp.chain.step_limits import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.chain.trajectory import State
from reference_lcp.exact.event_driven import EventDrivenSimulation
from reference_lcp.exact.exact_orbit import ExactPeriod
from reference_lcp.exact.monodromy import polished
from reference_lcp.steady.limits import DEFAULT_PERIODS, DEFAULT_RESIDUAL, EXACT_RESIDUAL
from reference_lcp.steady.orbits import PeriodicOrbit, periodic_orbits
from reference_lcp.stepping.euler_compiled import CompiledSimulation

SCHEME_STEPS = 800
"""Steps a period of the Euler scheme's steady state: within some 1e-3 of the exact one, where Newton's method works."""

MOST_SCHEME_STEPS = 10 * SCHEME_STEPS
"""Steps with which a period of the scheme takes as long as one from event to event; stiff chains need more."""


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
    state = _scheme_state(chain, drive)
    if state is not None:
        orbit = polished(search(start=state, tolerance=tolerance, max_periods=1)[0], steps_per_period, tolerance)
        if orbit.converged:
            return orbit, ExactPeriod.following(orbit, drive.period)
    orbit = polished(search(tolerance=DEFAULT_RESIDUAL, max_periods=max_periods)[0], steps_per_period, tolerance)
    if not orbit.converged and orbit.periods < max_periods:
        again = search(start=orbit.trajectory.end, tolerance=tolerance, max_periods=max_periods - orbit.periods)[0]
        orbit = dataclasses.replace(again, periods=orbit.periods + again.periods)
    return orbit, ExactPeriod.following(orbit, drive.period)


def _scheme_state(chain: Chain, drive: PeriodicDrive) -> State | None:
    """Give where a period of the Euler scheme's steady state begins; ``None`` where it finds none, or is slow."""
    steps = steps_per_period_for(chain, drive, SCHEME_STEPS)
    if steps > MOST_SCHEME_STEPS:
        return None
    orbit = periodic_orbits(CompiledSimulation([Lane.periodic(chain, drive, steps)]), steps, longest_multiple=1)[0]
    return orbit.trajectory.end if orbit.converged else None
