"""Subharmonic responses: motions that repeat after several periods of the drive.

Where the period map has no fixed point that can be found, the attractor may be a cycle of m points of the map,
and the motion then repeats after m periods of the drive; or it may be quasi-periodic, and repeat never.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from reference_lcp.chain.simulation import Simulation
from reference_lcp.chain.trajectory import State
from reference_lcp.steady.anderson import FixedPointSearch
from reference_lcp.steady.state_scales import StateScales
from reference_lcp.validation import FloatArray

LONGEST_MULTIPLE = 8
"""Most periods of the drive after which a motion is looked at for a repetition."""

SETTLING_PERIODS = 64
"""Plain periods before the comparison: they lead from the search's best iterate to the attractor."""

HINT = 0.5
"""x(t + mT) this many times closer to x(t) than x(t + T) is makes m worth a search of its own."""

SEARCHED = 30
"""Applications of the m-fold map that such a search may take: the median of figure 3's with m = 1 is 28."""


@dataclass(frozen=True)
class Repetitions:
    """After how many periods of the drive the motions of a batch repeat.

    Parameters
    ----------
    multiples
        For each lane the smallest m in 1…longest; 0 where there is none.
    states
        Where the plain motion of each lane has settled.
    distances
        |x(t + mT) − x(t)| from there, shape (lanes, longest).
    periods
        Plain periods that were followed.
    """

    multiples: list[int]
    states: State
    distances: FloatArray
    periods: int


def repetitions(
    simulation: Simulation, start: State, steps_per_period: int, tolerance: float, longest: int = LONGEST_MULTIPLE
) -> Repetitions:
    """Find after how many periods of the drive each lane's motion repeats.

    The plain motion is followed for `SETTLING_PERIODS`, and x(t + mT) compared with x(t). The m that comes closest to
    a repetition is tried on its own: a fixed point of the m-fold map is searched for with Anderson acceleration. It
    costs `SETTLING_PERIODS` + `longest` periods a lane, and at most `SEARCHED` · m where an m is tried.

    Parameters
    ----------
    simulation
        The lanes.
    start
        Their states at phase zero of the drive.
    steps_per_period
        Steps of one period of the drive.
    tolerance
        Largest |x(t + mT) − x(t)| of a repetition, non-dimensional as `PeriodicOrbit.residual`.
    longest
        Largest m, >= 1.
    """
    scales = StateScales(simulation.lanes, steps_per_period)
    end = _advanced(simulation, start, steps_per_period, SETTLING_PERIODS)
    distances = _distances(simulation, scales, end, steps_per_period, longest)
    multiples = [_smallest(row <= tolerance) for row in distances]
    for lane in [lane for lane, m in enumerate(multiples) if m == 0]:
        m = int(np.argmin(distances[lane])) + 1
        if distances[lane, m - 1] < HINT * distances[lane, 0]:
            alone, own, state = simulation.subset([lane]), scales.subset([lane]), end.subset([lane])
            repeated = _searched(alone, own, state, steps_per_period, m, tolerance)
            multiples[lane] = repeated if repeated > 1 else 0
    return Repetitions(multiples, end, distances, SETTLING_PERIODS + longest)


def _advanced(simulation: Simulation, state: State, steps_per_period: int, periods: int) -> State:
    """State after so many plain periods."""
    for _ in range(periods):
        state = simulation.advance(state, 0, steps_per_period)
    return state


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


def _searched(
    simulation: Simulation, scales: StateScales, start: State, steps_per_period: int, m: int, tolerance: float
) -> int:
    """Search a lane's fixed point of the m-fold map; gives the smallest repetition of what is found, or 0."""
    search = FixedPointSearch(simulation, scales, m * steps_per_period, tolerance)
    search.run(start, SEARCHED)
    if not search.best_residual[0] <= tolerance:
        return 0
    return _smallest(_distances(simulation, scales, search.starts([0]), steps_per_period, m)[0] <= tolerance)


def _smallest(repeats: Any) -> int:
    """Smallest m, counted from 1, that repeats; 0 without any."""
    return int(np.argmax(repeats)) + 1 if np.any(repeats) else 0
