"""Speed of the reference: of the compiled scheme, and of the steady states of the paper's figure 3."""

import timeit
from typing import Any

import numpy as np

from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.linear_response import frictionless_transmittance
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import CELLS, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.schemes.euler import CompiledSimulation
from reference_lcp.steady.orbits import periodic_orbits

FIGURE3_FRICTION_RATIOS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.6, 1.0, 2.0, 5.0)
FIGURE3_FREQUENCY_RATIOS = tuple(float(ratio) for ratio in np.linspace(0.1, 3.0, 146))
BENCH_LANES = 64
PERIODS_OF_A_SAMPLE = 100
SAMPLES = 7


def canonical_lane(friction_ratio: float, frequency_ratio: float, cells: int = CELLS) -> Lane:
    """One point of figure 3 at the coarsest time step allowed."""
    chain = Chain.from_ratios(cells=cells, friction_ratio=friction_ratio)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency_ratio), MINIMUM_STEPS_PER_PERIOD)


def bench() -> dict[str, Any]:
    """Measure on one core: steps of 64 lanes of 7 cells, and the steady states of the points of figure 3."""
    # compiled before anything is measured
    periodic_orbits(CompiledSimulation([canonical_lane(0.3, 0.9)]), MINIMUM_STEPS_PER_PERIOD, max_periods=10)
    seconds, worst, points = _figure3()
    return {
        "cell_steps_per_second": _cell_steps_per_second(),
        "figure3_seconds": seconds,
        "figure3_worst_residual": worst,
        "figure3_points": points,
        "steady_states_per_second": points / seconds,
    }


def _cell_steps_per_second() -> float:
    """Of the fastest of several samples: the one that was disturbed least."""
    lanes = [canonical_lane(0.3, ratio) for ratio in np.linspace(0.3, 1.6, BENCH_LANES)]
    simulation = CompiledSimulation(lanes)
    cells = lanes[0].chain.cells
    state = simulation.advance(State.at_rest(len(lanes), cells), 0, MINIMUM_STEPS_PER_PERIOD)

    def periods() -> None:
        nonlocal state
        for _ in range(PERIODS_OF_A_SAMPLE):
            state = simulation.advance(state, 0, MINIMUM_STEPS_PER_PERIOD)

    seconds = min(timeit.repeat(periods, number=1, repeat=SAMPLES))
    return len(lanes) * cells * MINIMUM_STEPS_PER_PERIOD * PERIODS_OF_A_SAMPLE / seconds


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
