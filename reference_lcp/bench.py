"""Speed of the compiled scheme: steps a second, and the paper's figure 3."""

import time
from typing import Any

import numpy as np

from reference_lcp.chain import Chain
from reference_lcp.compiled import BLOCK_LANES, CompiledSimulation
from reference_lcp.drive import HarmonicBase
from reference_lcp.linear_limits import frictionless_transmittance
from reference_lcp.periodic import periodic_orbits
from reference_lcp.simulation import MINIMUM_STEPS_PER_PERIOD, Lane
from reference_lcp.trajectory import State
from reference_lcp.transmittance import decibel, transmittance

FIGURE3_FRICTION_RATIOS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.6, 1.0, 2.0, 5.0)
FIGURE3_FREQUENCY_RATIOS = tuple(float(ratio) for ratio in np.linspace(0.1, 3.0, 146))
PERIODS_OF_A_SAMPLE = 100
SAMPLES = 7


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
        and ``figure3_worst_residual`` (1,314 points), ``figure3_points``.
    """
    _compile()
    seconds, worst, points = _figure3()
    return {
        "cell_steps_per_second": _cell_steps_per_second(),
        "figure3_seconds": seconds,
        "figure3_worst_residual": worst,
        "figure3_points": points,
    }


def _compile() -> None:
    """Have everything compiled that is timed later."""
    periodic_orbits(CompiledSimulation([canonical_lane(0.3, 0.9)]), MINIMUM_STEPS_PER_PERIOD, max_periods=10)


def _cell_steps_per_second() -> float:
    lanes = [canonical_lane(0.3, ratio) for ratio in np.linspace(0.3, 1.6, BLOCK_LANES)]
    simulation = CompiledSimulation(lanes)
    cells = lanes[0].chain.cells
    state = simulation.advance(State.at_rest(len(lanes), cells), 0, MINIMUM_STEPS_PER_PERIOD)
    best = np.inf
    for _ in range(SAMPLES):
        begin = time.perf_counter()
        for _ in range(PERIODS_OF_A_SAMPLE):
            state = simulation.advance(state, 0, MINIMUM_STEPS_PER_PERIOD)
        best = min(best, time.perf_counter() - begin)
    return len(lanes) * cells * MINIMUM_STEPS_PER_PERIOD * PERIODS_OF_A_SAMPLE / best


def _figure3() -> tuple[float, float, int]:
    """Seconds, worst residual and number of points of the whole figure."""
    begin = time.perf_counter()
    with_friction = [
        canonical_lane(friction, frequency)
        for friction in FIGURE3_FRICTION_RATIOS
        if friction > 0
        for frequency in FIGURE3_FREQUENCY_RATIOS
    ]
    orbits = periodic_orbits(CompiledSimulation(with_friction), MINIMUM_STEPS_PER_PERIOD)
    curve = [decibel(transmittance(orbit)) for orbit in orbits]
    chain = Chain.from_ratios()
    curve += [
        decibel(frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, frequency)))
        for frequency in FIGURE3_FREQUENCY_RATIOS
    ]
    seconds = time.perf_counter() - begin
    return seconds, max(orbit.residual for orbit in orbits), len(curve)
