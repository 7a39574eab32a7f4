"""Periodic orbits: the fixed point of the period map, found by Anderson acceleration.

A lightly damped chain needs thousands of periods to settle. The map x(t) → x(t + T) has the steady state as its fixed
point, which the acceleration finds in some thirty periods, starting from harmonic balance. The residual of one plain
period certifies what was found. Where there is no such point, motions that repeat after some periods of the drive
only are looked for.
"""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.step_limits import FEWEST_STEPS_PER_PERIOD
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.refusal import ParameterError
from reference_lcp.steady.anderson import LARGEST_RESIDUAL, FixedPointSearch
from reference_lcp.steady.harmonic_balance import harmonic_balance_start
from reference_lcp.steady.limits import DEFAULT_PERIODS, DEFAULT_RESIDUAL
from reference_lcp.steady.state_scales import StateScales
from reference_lcp.steady.subharmonics import LONGEST_MULTIPLE, repetitions
from reference_lcp.validation import FloatArray, checked_count, checked_scalar


class OrbitStatus(StrEnum):
    """How the search for a periodic orbit ended."""

    CONVERGED = "converged"
    PERIOD_LIMIT = "period limit"
    DIVERGED = "diverged"


@dataclass(frozen=True)
class PeriodicOrbit:
    """One period of the steady state of one lane.

    Parameters
    ----------
    lane
        The chain, its drive and the time step.
    trajectory
        One period, one row a step, starting at phase zero of the drive.
    residual
        max(|Δ position| / s, |Δ velocity| / (s ω), |Δ internal state| / its size) over one plain period, with s the
        displacement scale of the drive and ω its angular frequency; for the size see `StateScales`.
    periods
        Periods that were simulated to find it, the certifying one included.
    status
        Whether the tolerance has been reached.
    multiple
        Periods of the drive after which the motion repeats, if the search has looked for it: more than one for a
        subharmonic response, 0 where no repetition was found.
    """

    lane: Lane
    trajectory: Trajectory
    residual: float
    periods: int
    status: OrbitStatus
    multiple: int = 1

    @property
    def converged(self) -> bool:
        """Whether the tolerance has been reached."""
        return self.status is OrbitStatus.CONVERGED


def periodic_orbits(
    simulation: Simulation,
    steps_per_period: int,
    *,
    start: State | None = None,
    tolerance: float = DEFAULT_RESIDUAL,
    max_periods: int = DEFAULT_PERIODS,
    longest_multiple: int = LONGEST_MULTIPLE,
) -> list[PeriodicOrbit]:
    """Find the periodic orbit of every lane of a simulation.

    Coulomb friction with a given normal force is monotone: the energy norm of the difference of two
    motions under the same drive never grows. A fixed point of the period map is therefore the
    attractor, unique up to the offsets of cells that stay stuck. Where normal forces depend on the motion it
    need not attract, see `reference_lcp.steady.multipliers`.

    Parameters
    ----------
    simulation
        The lanes; each has a time step of its drive's period over `steps_per_period`.
    steps_per_period
        Number of steps that make one period.
    start
        State that may be in the steady state: lanes whose first period from it repeats are done with it, and the
        search of the others goes on from its end. Without it, the search starts from `harmonic_balance_start`.
    tolerance
        Residual to reach, see `PeriodicOrbit.residual`.
    max_periods
        Periods after which the search gives up, if its residual has been halved at times; it gives the best orbit then.
    longest_multiple
        Most periods of the drive after which a motion without a fixed point is searched for a repetition; 1 for
        no such search. See `repetitions`, whose periods come on top of `max_periods`.

    Returns
    -------
    list of PeriodicOrbit
        One a lane, in order. Whether an orbit converged is its status.

    Raises
    ------
    ParameterError
        If a number is outside its range, a lane's time step does not divide its drive's period, or that is no
        period of its preload.
    """
    checked_scalar("tolerance", tolerance, "> 0")
    checked_count("max_periods", max_periods)
    checked_count("longest_multiple", longest_multiple)
    for lane in simulation.lanes:
        _check_period(lane, steps_per_period)
    if start is None:
        balanced = harmonic_balance_start(simulation.lanes, steps_per_period)
        return searched(simulation, balanced, steps_per_period, tolerance, max_periods, longest_multiple)
    orbits = _first_periods(simulation, start, steps_per_period, tolerance)
    if max_periods > 1:
        _search_on(orbits, simulation, steps_per_period, tolerance, max_periods - 1, longest_multiple)
    return orbits


def _search_on(
    orbits: list[PeriodicOrbit], simulation: Simulation, steps: int, tolerance: float, max_periods: int, longest: int
) -> None:
    """Search the orbits that have not converged after their first period from its end on, in place."""
    late = [lane for lane, orbit in enumerate(orbits) if not orbit.converged]
    if not late:
        return
    ends = State.stack([orbits[lane].trajectory.end for lane in late])
    later = searched(part_of(simulation, late), ends, steps, tolerance, max_periods, longest)
    for number, orbit in zip(late, later, strict=True):
        orbits[number] = dataclasses.replace(orbit, periods=orbit.periods + 1)


def part_of(simulation: Simulation, lanes: Sequence[int]) -> Simulation:
    """Give a simulation of some lanes; itself if they are all."""
    return simulation if len(lanes) == len(simulation.lanes) else simulation.subset(lanes)


def searched(
    simulation: Simulation,
    start: State,
    steps: int,
    tolerance: float,
    max_periods: int,
    longest_multiple: int,
    newton: FloatArray | None = None,
) -> list[PeriodicOrbit]:
    """Search every lane from a start; arguments as for `periodic_orbits`, `newton` as for `FixedPointSearch`."""
    search = FixedPointSearch(simulation, StateScales(simulation.lanes, steps), steps, tolerance, newton)
    search.run(start, max_periods)
    orbits = _certified(simulation, search, steps, tolerance)
    if longest_multiple > 1:
        _search_repetitions(orbits, simulation, search, steps, tolerance, longest_multiple)
    return orbits


def _first_periods(simulation: Simulation, start: State, steps: int, tolerance: float) -> list[PeriodicOrbit]:
    """Record one period from a start that may be in the steady state, and take its residual."""
    scales = StateScales(simulation.lanes, steps)
    orbits = []
    for number, trajectory in enumerate(simulation.run(start, 0, steps)):
        own, lane = start.subset([number]), [number]
        scales.learn(None, own, lane)
        scales.learn(own, trajectory.end, lane)
        x = scales.vectors(own, lane)
        change = scales.vectors(trajectory.end, lane) - x
        residual = float(scales.residuals(x, change)[0])
        orbits.append(PeriodicOrbit(simulation.lanes[number], trajectory, residual, 1, _status(residual, tolerance)))
    return orbits


def _certified(
    simulation: Simulation, search: FixedPointSearch, steps_per_period: int, tolerance: float
) -> list[PeriodicOrbit]:
    """Record one plain period from the best start of each lane, and take its residual."""
    starts = search.starts(np.arange(len(simulation.lanes)))
    trajectories = simulation.run(starts, 0, steps_per_period)
    residuals = search.residuals(starts, State.stack([trajectory.end for trajectory in trajectories])).tolist()
    return [
        PeriodicOrbit(lane, trajectory, residual, periods + 1, _status(residual, tolerance))
        for lane, trajectory, residual, periods in zip(
            simulation.lanes, trajectories, residuals, search.periods.tolist(), strict=True
        )
    ]


def _status(residual: float, tolerance: float) -> OrbitStatus:
    """What a residual means."""
    if residual <= tolerance:
        return OrbitStatus.CONVERGED
    return OrbitStatus.PERIOD_LIMIT if residual < LARGEST_RESIDUAL else OrbitStatus.DIVERGED


def _search_repetitions(
    orbits: list[PeriodicOrbit],
    simulation: Simulation,
    search: FixedPointSearch,
    steps_per_period: int,
    tolerance: float,
    longest: int,
) -> None:
    """Set the multiple of the orbits at the period limit, in place: after how many periods they repeat."""
    late = [lane for lane, orbit in enumerate(orbits) if orbit.status is OrbitStatus.PERIOD_LIMIT]
    if not late:
        return
    part = simulation.subset(late)
    repeated = repetitions(part, search.starts(late), steps_per_period, tolerance, longest)
    for k, lane in enumerate(late):
        orbits[lane] = dataclasses.replace(orbits[lane], multiple=repeated.multiples[k])
        if repeated.multiples[k] == 1:
            period = part.subset([k]).run(repeated.states.subset([k]), 0, steps_per_period)[0]
            periods, residual = orbits[lane].periods + repeated.periods + 1, float(repeated.distances[k, 0])
            orbits[lane] = PeriodicOrbit(orbits[lane].lane, period, residual, periods, OrbitStatus.CONVERGED)


def _check_period(lane: Lane, steps_per_period: int) -> None:
    """Refuse a lane whose steps do not make up a period of its drive."""
    checked_count("steps_per_period", steps_per_period, FEWEST_STEPS_PER_PERIOD)
    period = getattr(lane.drive, "period", None)
    if period is None:
        raise ParameterError(f"{type(lane.drive).__name__} has no period; allowed: a periodic drive")
    if not math.isclose(lane.time_step * steps_per_period, period, rel_tol=1e-12):
        steps = period / lane.time_step
        raise ParameterError(f"the time step makes {steps:g} steps a period; allowed: {steps_per_period}")
    if lane.preload is not None:
        multiple = lane.preload.angular_frequency * period / (2 * np.pi)
        if not math.isclose(multiple, max(1, round(multiple)), rel_tol=1e-12):
            raise ParameterError(f"the preload has {multiple:g} times the drive's frequency; allowed: whole multiples")
