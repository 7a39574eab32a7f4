"""Periodic orbits: the fixed point of the period map, found by Anderson acceleration.

The map x(t) → x(t + T) has the steady state as its fixed point, which the acceleration finds in some thirty periods,
starting from harmonic balance. The residual of one plain period certifies what was found. Where there is no such point,
the attractor may be a cycle of m points of the map, a subharmonic response, or quasi-periodic, and repeat never.
"""

import dataclasses
import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from reference_lcp.chain.simulation import Lane, OrbitStatus, PeriodicOrbit, Simulation
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import DEFAULT_PERIODS, DEFAULT_RESIDUAL, FEWEST_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError
from reference_lcp.steady.anderson import LARGEST_RESIDUAL, FixedPointSearch, StateScales
from reference_lcp.steady.attraction import jacobians, largest_multiplier, without_dashpots
from reference_lcp.steady.harmonic_balance import harmonic_balance_start
from reference_lcp.validation import FloatArray, checked_count, checked_scalar
from reference_lcp.watching import tell

LONGEST_MULTIPLE = 8
"""Most periods of the drive after which a motion is looked at for a repetition."""

SETTLING_PERIODS = 64
"""Plain periods before the comparison: they lead from the search's best iterate to the attractor."""

SETTLING = "no steady state so far, looking for a repetition after several periods"
"""What is told to whoever watches."""

HINT = 0.5
"""x(t + mT) this many times closer to x(t) than x(t + T) is makes m worth a search of its own."""

SEARCHED = 30
"""Applications of the m-fold map that such a search may take: the median of figure 3's with m = 1 is 28."""


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

    Where every cell has a chain dashpot, the fixed point of the period map is the attractor; elsewhere
    `PeriodicOrbit.reason` says whether it is.

    Parameters
    ----------
    simulation, steps_per_period
        The lanes; each has a time step of its drive's period over so many steps.
    start
        State that may be in the steady state; without it, the search starts from `harmonic_balance_start`.
    tolerance, max_periods
        Residual to reach, see `PeriodicOrbit.residual`; periods after which the search gives the best orbit.
    longest_multiple
        Most periods of the drive after which a motion without a fixed point is searched for a repetition, on top of
        `max_periods`; 1 for no such search, and for no word on what attracts.

    Returns
    -------
    list of PeriodicOrbit
        One a lane; whether it converged is its status.

    Raises
    ------
    ParameterError
        If a number is outside its range, or steps, period and preload do not fit together.
    """
    checked_scalar("tolerance", tolerance, "> 0")
    checked_count("max_periods", max_periods)
    checked_count("longest_multiple", longest_multiple)
    for lane in simulation.lanes:
        _check_period(lane, steps_per_period)
    begin = harmonic_balance_start(simulation.lanes, steps_per_period) if start is None else start
    found = searched(simulation, begin, steps_per_period, tolerance, max_periods, longest_multiple)
    return found if longest_multiple == 1 else _judged(found, simulation)


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
    starts = search.starts(np.arange(len(simulation.lanes)))
    trajectories = simulation.run(starts, 0, steps)
    residuals = search.residuals(starts, State.stack([trajectory.end for trajectory in trajectories])).tolist()
    found = zip(simulation.lanes, trajectories, residuals, (search.periods + 1).tolist(), strict=True)
    orbits = [PeriodicOrbit(*one, orbit_status(one[2], tolerance)) for one in found]
    if longest_multiple > 1:
        _name_repetitions(orbits, simulation, starts, steps, tolerance, longest_multiple)
    return orbits


def orbit_status(residual: float, tolerance: float) -> OrbitStatus:
    """Give the status of an orbit whose search is over."""
    if residual <= tolerance:
        return OrbitStatus.CONVERGED
    return OrbitStatus.PERIOD_LIMIT if residual < LARGEST_RESIDUAL else OrbitStatus.DIVERGED


def _judged(orbits: Sequence[PeriodicOrbit], simulation: Simulation) -> list[PeriodicOrbit]:
    """Say of the steady states of chains with a cell without dashpot whether they attract."""
    judged = list(orbits)
    for number, orbit in enumerate(orbits):
        known = orbit.trajectory.internal_state is None or orbit.lane.opens
        if orbit.converged and known and orbit.lane.one_coefficient and not orbit.lane.chain.damped:
            jacobian = jacobians(simulation.subset([number]), [orbit])[0]
            judged[number] = without_dashpots(orbit, largest_multiplier(jacobian))
    return judged


def _name_repetitions(
    orbits: list[PeriodicOrbit], simulation: Simulation, starts: State, steps: int, tolerance: float, longest: int
) -> None:
    """Set the multiple of the orbits at the period limit, in place: after how many periods they repeat."""
    late = [lane for lane, orbit in enumerate(orbits) if orbit.status is OrbitStatus.PERIOD_LIMIT]
    if not late:
        return
    part = simulation.subset(late)
    multiples, states, distances = _repetitions(part, starts.subset(late), steps, tolerance, longest)
    for k, lane in enumerate(late):
        orbits[lane] = dataclasses.replace(orbits[lane], multiple=multiples[k])
        if multiples[k] == 1:
            period = part.subset([k]).run(states.subset([k]), 0, steps)[0]
            periods, residual = orbits[lane].periods + SETTLING_PERIODS + longest + 1, float(distances[k, 0])
            orbits[lane] = PeriodicOrbit(orbits[lane].lane, period, residual, periods, OrbitStatus.CONVERGED)


def _check_period(lane: Lane, steps_per_period: int) -> None:
    checked_count("steps_per_period", steps_per_period, FEWEST_STEPS_PER_PERIOD)
    period = getattr(lane.drive, "period", None)
    if period is None:
        raise ParameterError(f"{type(lane.drive).__name__} has no period; allowed: a periodic drive")
    if not math.isclose(lane.time_step * steps_per_period, period, rel_tol=1e-12):
        steps = period / lane.time_step
        raise ParameterError(f"the time step makes {steps:g} steps a period; allowed: {steps_per_period}")
    if lane.preload is not None and lane.preload.modulation:
        multiple = lane.preload.angular_frequency * period / (2 * np.pi)
        if not math.isclose(multiple, max(1, round(multiple)), rel_tol=1e-12):
            raise ParameterError(f"the preload has {multiple:g} times the drive's frequency; allowed: whole multiples")


def _repetitions(
    simulation: Simulation, start: State, steps_per_period: int, tolerance: float, longest: int
) -> tuple[list[int], State, FloatArray]:
    """Find after how many periods of the drive, `longest` at most, each lane's motion repeats to `tolerance`.

    The plain motion is followed for `SETTLING_PERIODS`, and x(t + mT) compared with x(t). The m that comes closest to a
    repetition is tried on its own, by a search of the m-fold map. Gives the smallest m of each lane, 0 where there is
    none; where its motion has settled; and |x(t + mT) − x(t)| from there, shape (lanes, longest).
    """
    scales, end = StateScales(simulation.lanes, steps_per_period), start
    for period in range(SETTLING_PERIODS):
        end = simulation.advance(end, 0, steps_per_period)
        tell(SETTLING, period + 1, SETTLING_PERIODS)
    distances = _distances(simulation, scales, end, steps_per_period, longest)
    multiples = [_smallest(row <= tolerance) for row in distances]
    for lane in [lane for lane, m in enumerate(multiples) if m == 0]:
        m = int(np.argmin(distances[lane])) + 1
        if distances[lane, m - 1] < HINT * distances[lane, 0]:
            alone, own = simulation.subset([lane]), scales.subset([lane])
            search = FixedPointSearch(alone, own, m * steps_per_period, tolerance)
            search.run(end.subset([lane]), SEARCHED)
            if search.best_residual[0] <= tolerance:
                repeated = _smallest(_distances(alone, own, search.starts([0]), steps_per_period, m)[0] <= tolerance)
                multiples[lane] = repeated if repeated > 1 else 0
    return multiples, end, distances


def _distances(
    simulation: Simulation, scales: StateScales, state: State, steps_per_period: int, longest: int
) -> FloatArray:
    """|x(t + mT) − x(t)| of each lane, m = 1…longest; shape (lanes, longest)."""
    lanes = np.arange(len(simulation.lanes))
    states = [state]
    for _ in range(longest):
        states.append(simulation.advance(states[-1], 0, steps_per_period))
    scales.learn(None, states[0], lanes)
    for before, after in pairwise(states):
        scales.learn(before, after, lanes)
    first, *others = (scales.vectors(state, lanes) for state in states)
    return np.stack([np.max(np.abs(other - first), axis=1) for other in others], axis=1)


def _smallest(repeats: Any) -> int:
    """Smallest m, counted from 1, that repeats; 0 without any."""
    return int(np.argmax(repeats)) + 1 if np.any(repeats) else 0
