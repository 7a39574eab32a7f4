"""What a step costs: in the adapter, with and without a record, and in the engine's own loop alone."""

import math
import timeit
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec

from engines.interface.device import PROCESSOR, on_device
from engines.interface.engine import NativeStepping
from engines.interface.registry import engine
from engines.interface.variant import Variant
from engines.shared.warp_worlds import import_warp
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD as STEPS
from reference_lcp.errors import ParameterError, checked_choice
from reference_lcp.schemes.sequential import SequentialSimulation
from reference_lcp.validation import checked_count

SAMPLES = 7
"""Samples of each kind, a period of steps each, taken in turn; the fastest counts, for other programs only add time."""


@dataclass(frozen=True)
class StepCost:
    """Seconds a step and lane of seven cells, on one core or on a graphics card."""

    variant: Variant
    """What was measured."""
    lanes: int
    """Of the batch."""
    advance: float
    run: float
    """By the adapter: the end of a period only, and with every step recorded; NaN on a card."""
    bare: float
    """By the engine alone, from rest or a first step, in the tightest loop of its Python interface; NaN where it has
    none. Lanes that are advanced one after the other cost the same alone, and one of them is measured."""
    device: str = PROCESSOR
    """The processor, or the name of the card."""

    @property
    def ratio(self) -> float:
        """`advance` over `bare`."""
        return self.advance / self.bare


def step_cost(variant: Variant, samples: int = SAMPLES, lanes: int | None = None, device: str = PROCESSOR) -> StepCost:
    """Measure one variant at (0.3, 0.9) of figure 3, in a batch of equal lanes, as the suite runs engines.

    Parameters
    ----------
    variant
        What is measured.
    samples
        See `SAMPLES`.
    lanes
        Of the batch, at least 1; as many as the engine takes at best unless given.
    device
        On a card, the engine is timed alone: its motions, that adapters give, would have to leave the card.

    Raises
    ------
    ParameterError
        If `samples` or `lanes` is not at least 1, or the engine or this machine has no such device.
    EngineNotInstalled
        If the engine cannot be used on this machine.
    """
    checked_count("samples", samples)
    chain = Chain.from_ratios(friction_ratio=0.3)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), STEPS)
    lanes = checked_count("lanes", variant.batch_lanes if lanes is None else lanes)
    title = device_title(variant, device)
    with on_device(device):
        simulation = variant.build([lane] * lanes)
    try:
        start = State.at_rest(lanes, chain.cells)
        timed: dict[str, Callable[[], object]] = {}
        if device == PROCESSOR:
            timed["advance"] = lambda: simulation.advance(start, 0, STEPS)
            timed["run"] = lambda: simulation.run(start, 0, STEPS)
        else:
            simulation.advance(start, 0, 1)  # its load stays
        taken = dict.fromkeys(timed, STEPS * lanes)
        bare = native_stepping(simulation)
        if bare is not None:
            timed["bare"] = lambda: bare.native_steps(STEPS)
            taken["bare"] = STEPS if isinstance(simulation, SequentialSimulation) else STEPS * lanes
        best: dict[str, float] = {}
        for _ in range(samples):
            for name, act in timed.items():
                best[name] = min(best.get(name, math.inf), timeit.timeit(act, number=1) / taken[name])
    finally:
        simulation.close()
    advance, run, least = (best.get(name, math.nan) for name in ("advance", "run", "bare"))
    return StepCost(variant, lanes, advance, run, least, title)


def device_title(variant: Variant, device: str) -> str:
    """Give the name of a device on which the steps of a variant can be timed here: that of the card.

    Raises
    ------
    ParameterError
        If the adapter does not take the device, or this machine has none.
    """
    checked_choice(f"device of {variant.engine}", device, engine(variant.engine).devices)
    if device == PROCESSOR:
        return device
    if find_spec("warp") is None or not import_warp().is_cuda_available():
        raise ParameterError(f"device = {device}: no graphics card that CUDA finds is here; allowed here: {PROCESSOR}")
    return str(import_warp().get_device(device).name)


def native_stepping(simulation: Simulation) -> NativeStepping | None:
    """Find what steps without the adapter: the simulation with all its lanes, or the model of its first one."""
    candidate = simulation.models[0] if isinstance(simulation, SequentialSimulation) else simulation
    return candidate if isinstance(candidate, NativeStepping) else None
