"""What a step costs: in the adapter, with and without a record, and in the engine's own loop alone."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

from engines.interface import BareStepping
from engines.variant import Variant
from reference_lcp.chain import Chain
from reference_lcp.drive import HarmonicBase
from reference_lcp.lanewise import LanewiseSimulation
from reference_lcp.simulation import Lane, Simulation
from reference_lcp.trajectory import State
from reference_lcp.validation import checked_count

STEPS = 400
"""Steps of a sample: a period, as the search for a steady state asks for them."""

SAMPLES = 7
"""Samples of each kind, taken in turn; the fastest counts, for other programs only ever make one slower."""


@dataclass(frozen=True)
class StepCost:
    """Seconds a step of one lane of seven cells, on one core.

    Parameters
    ----------
    variant
        Who was measured.
    advance, run
        By the adapter: the end of a period only, and with every step recorded.
    bare
        By the engine alone, from rest, in the tightest loop of its Python interface; NaN where it has none.
    """

    variant: Variant
    advance: float
    run: float
    bare: float

    @property
    def ratio(self) -> float:
        """`advance` over `bare`."""
        return self.advance / self.bare


def step_cost(variant: Variant, samples: int = SAMPLES) -> StepCost:
    """Measure one variant at (0.3, 0.9) of figure 3.

    Raises
    ------
    ParameterError
        If `samples` is not at least 1.
    EngineNotInstalled
        If the engine cannot be used on this machine.
    """
    checked_count("samples", samples)
    chain = Chain.from_ratios(friction_ratio=0.3)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), STEPS)
    simulation = variant.build([lane])
    try:
        start = State.at_rest(1, chain.cells)
        timed: dict[str, Callable[[], object]] = {
            "advance": lambda: simulation.advance(start, 0, STEPS),
            "run": lambda: simulation.run(start, 0, STEPS),
        }
        bare = _bare(simulation)
        if bare is not None:
            timed["bare"] = lambda: bare.bare_steps(STEPS)
        best = dict.fromkeys(("advance", "run", "bare"), math.inf)
        for _ in range(samples):
            for name, act in timed.items():
                best[name] = min(best[name], _seconds(act) / STEPS)
    finally:
        simulation.close()
    return StepCost(variant, best["advance"], best["run"], best["bare"] if bare is not None else math.nan)


def _bare(simulation: Simulation) -> BareStepping | None:
    """Find who steps alone: the simulation, or the model of its only lane."""
    candidate = simulation.models[0] if isinstance(simulation, LanewiseSimulation) else simulation
    return candidate if isinstance(candidate, BareStepping) else None


def _seconds(act: Callable[[], object]) -> float:
    begin = time.perf_counter()
    act()
    return time.perf_counter() - begin
