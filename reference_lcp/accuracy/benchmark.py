"""Speed: of the compiled scheme, of Lemke's method, of the paper's figure 3; and what long chains cost."""

import timeit
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from reference_lcp.chain.harmonic import HarmonicBase
from reference_lcp.chain.linear_response import frictionless_transmittance
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.step_limits import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.chain.trajectory import State
from reference_lcp.lcp.lemke import lemke
from reference_lcp.lcp.time_step import assemble_given_normal_force
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.steady.orbits import periodic_orbits
from reference_lcp.stepping.euler_compiled import CompiledSimulation
from reference_lcp.stepping.euler_lemke import LemkeSimulation, chain_step

FIGURE3_FRICTION_RATIOS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.6, 1.0, 2.0, 5.0)
FIGURE3_FREQUENCY_RATIOS = tuple(float(ratio) for ratio in np.linspace(0.1, 3.0, 146))
BENCH_LANES = 64
PERIODS_OF_A_SAMPLE = 100
SAMPLES = 7
CHAIN_LENGTHS = (7, 100, 1_000, 10_000, 100_000)
CELL_STEPS_OF_A_SAMPLE = 10_000_000
LCPS_OF_A_SAMPLE = 1_000


def canonical_lane(friction_ratio: float, frequency_ratio: float) -> Lane:
    """One point of figure 3 at the coarsest time step allowed."""
    chain = Chain.from_ratios(friction_ratio=friction_ratio)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency_ratio), MINIMUM_STEPS_PER_PERIOD)


def bench() -> dict[str, Any]:
    """Measure, on one core, with compilation and its cache left out.

    Returns
    -------
    dict
        ``cell_steps_per_second`` (best of several samples, 64 lanes of 7 cells), ``figure3_seconds``
        and ``figure3_worst_residual`` (1,314 points), ``figure3_points``; ``lemke_step_seconds``: one step of
        7 cells with Lemke's method; ``lemke_seconds``: one LCP of 7 cells, from the start.
    """
    _compile()
    seconds, worst, points = _figure3()
    return {
        "cell_steps_per_second": _cell_steps_per_second(),
        "figure3_seconds": seconds,
        "figure3_worst_residual": worst,
        "figure3_points": points,
        "lemke_step_seconds": lemke_step_seconds(),
        "lemke_seconds": lemke_seconds(),
    }


def lemke_step_seconds() -> float:
    """Seconds for one step of the canonical chain with Lemke's method, over one period."""
    lane = canonical_lane(0.3, 0.9)
    simulation, state = LemkeSimulation([lane]), _moving_state(lane)
    return _best(lambda: simulation.advance(state, 0, MINIMUM_STEPS_PER_PERIOD)) / MINIMUM_STEPS_PER_PERIOD


def lemke_seconds() -> float:
    """Seconds for one LCP of the canonical chain's friction, without warm start."""
    lane = canonical_lane(0.3, 0.9)
    state = _moving_state(lane)
    step = chain_step(lane.chain, state.positions[0], state.velocities[0], 0.0, lane.time_step)
    matrix, vector = assemble_given_normal_force(step, lane.chain.normal_force * lane.time_step)
    lemke(matrix, vector)
    return _best(lambda: [lemke(matrix, vector) for _ in range(LCPS_OF_A_SAMPLE)]) / LCPS_OF_A_SAMPLE


def bench_cells(lengths: Sequence[int] = CHAIN_LENGTHS) -> list[dict[str, float]]:
    """Measure what chains of several lengths cost, one lane each, on one core.

    Returns
    -------
    list of dict
        ``cells``; ``seconds_per_cell_step``, best of several samples; ``bytes`` of the state and of the
        parameters (the table of loads, one number a step, is left out); ``highest_natural_frequency``
        [rad/s], which every choice of a time step needs.
    """
    _compile()
    return [_cost_of_length(cells) for cells in lengths]


def _cost_of_length(cells: int) -> dict[str, float]:
    chain = Chain.from_ratios(cells=cells, friction_ratio=0.3)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), MINIMUM_STEPS_PER_PERIOD)
    simulation, state = CompiledSimulation([lane]), State.at_rest(1, cells)
    steps = max(100, CELL_STEPS_OF_A_SAMPLE // cells)
    state = simulation.advance(state, 0, 100)
    seconds = _best(lambda: simulation.advance(state, 0, steps))
    return {
        "cells": cells,
        "seconds_per_cell_step": seconds / (cells * steps),
        "bytes": simulation.nbytes - 8 * steps + state.positions.nbytes + state.velocities.nbytes,
        "highest_natural_frequency": chain.highest_natural_frequency,
    }


def _moving_state(lane: Lane) -> State:
    """State after one period from rest, with contacts that stick and contacts that slip."""
    return CompiledSimulation([lane]).advance(State.at_rest(1, lane.chain.cells), 0, MINIMUM_STEPS_PER_PERIOD)


def _best(work: Callable[[], object]) -> float:
    """Seconds of the fastest of several runs: the one that was disturbed least."""
    return min(timeit.repeat(work, number=1, repeat=SAMPLES))


def _compile() -> None:
    """Have everything compiled that is timed later."""
    periodic_orbits(CompiledSimulation([canonical_lane(0.3, 0.9)]), MINIMUM_STEPS_PER_PERIOD, max_periods=10)


def _cell_steps_per_second() -> float:
    lanes = [canonical_lane(0.3, ratio) for ratio in np.linspace(0.3, 1.6, BENCH_LANES)]
    simulation = CompiledSimulation(lanes)
    cells = lanes[0].chain.cells
    state = simulation.advance(State.at_rest(len(lanes), cells), 0, MINIMUM_STEPS_PER_PERIOD)

    def periods() -> None:
        nonlocal state
        for _ in range(PERIODS_OF_A_SAMPLE):
            state = simulation.advance(state, 0, MINIMUM_STEPS_PER_PERIOD)

    return len(lanes) * cells * MINIMUM_STEPS_PER_PERIOD * PERIODS_OF_A_SAMPLE / _best(periods)


def _figure3() -> tuple[float, float, int]:
    """Seconds, worst residual and number of points of the whole figure."""
    begin = timeit.default_timer()
    chains = [Chain.from_ratios(friction_ratio=friction) for friction in FIGURE3_FRICTION_RATIOS if friction > 0]
    with_friction = [
        Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency), MINIMUM_STEPS_PER_PERIOD)
        for chain in chains
        for frequency in FIGURE3_FREQUENCY_RATIOS
    ]
    orbits = periodic_orbits(CompiledSimulation(with_friction), MINIMUM_STEPS_PER_PERIOD)
    curve = [decibel(transmittance(orbit)) for orbit in orbits]
    chain = Chain.from_ratios()
    curve += [
        decibel(frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, frequency)))
        for frequency in FIGURE3_FREQUENCY_RATIOS
    ]
    seconds = timeit.default_timer() - begin
    return seconds, max(orbit.residual for orbit in orbits), len(curve)
