"""Whether a stated law is one of this chain: what it tends to with finer steps, and with its constants at their ideal.

Laws are code of those who write engines. Whatever constants decide at some step, with none of them left the motion is
the exact one; a law that tends to another is of another chain, or of other friction.
"""

from functools import cache

import numpy as np

from multibody_xval.engines.interface.registry import engine, law_of
from multibody_xval.engines.interface.tolerances import STEPS
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.shared.law_distance import figure3_lanes
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.validation import FloatArray

FINER, FINEST = 8, 64
"""Steps over `STEPS` with which a law is tried, and those of the reference that stand for the exact motion."""

SEEN = 1.01
"""Friction over the right one that the limit of a law has to tell from it: an error of first order is less at `FINER`
steps, for every scheme met so far."""

BOUND_PART = 0.1
"""Of what that hundredth makes of a period, the largest bound of a law: a thousandth of the friction shows."""


@cache
def law_fault(variant: Variant) -> str | None:
    """Say why what a preset states is no law of the chain; ``None`` where it is one, or the preset states none."""
    law = law_of(variant.preset)
    if law is None:
        return None
    if all(law.unclaimed_reason(lane) is not None for lane in figure3_lanes()):
        return "it claims no point of figure 3"
    exact, seen = _exact()
    allowed = BOUND_PART * seen
    if not law.period_bound <= allowed:
        return f"its bound after a period is {law.period_bound:.2g} U0; allowed: {allowed:.2g}"
    if law.without_friction:
        exact = _motion(engine("reference").build([_lane(0.0, FINEST)]), FINEST)
    try:
        own = _motion(law.ideal().build([_lane(1.0, FINER)]), FINER)
    except Exception as problem:  # a stranger's code
        return f"it cannot be built with ideal constants: {type(problem).__name__}: {problem}"
    off = _distance(own, exact)
    if off <= seen:
        return None
    return f"with ideal constants and {FINER * STEPS} steps it is {off:.2g} U0 off after a period; allowed: {seen:.2g}"


@cache
def _exact() -> tuple[FloatArray, float]:
    """Give the exact motion, and how far another with `SEEN` times the friction is from it, over U0."""
    exact, other = (_motion(engine("reference").build([_lane(part, FINEST)]), FINEST) for part in (1.0, SEEN))
    return exact, _distance(exact, other)


def _lane(friction: float, finer: int) -> Lane:
    """Give three unequal cells that slide and stick, under a part of their friction."""
    chain = Chain.from_ratios(
        cells=3, mass_ratio=[0.6, 0.9, 0.7], stiffness_ratio=[0.5, 0.3, 0.4], damping_ratio=[0.01, 0.02, 0.015],
        friction_ratio=[0.3 * friction, 0.1 * friction, 0.6 * friction],
    )  # fmt: skip
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, BASE_AMPLITUDE), finer * STEPS)


def _motion(simulation: Simulation, finer: int) -> FloatArray:
    """Give the positions of a period at the ends of `STEPS` steps, from a state far from any steady one."""
    count = 2 * simulation.lanes[0].chain.cells
    state = BASE_AMPLITUDE * np.cos(np.arange(count))[None]
    speed = (
        np.sin(np.arange(count))[None] * BASE_AMPLITUDE * 2 * np.pi / (finer * STEPS * simulation.lanes[0].time_step)
    )
    try:
        return simulation.run(State(state, speed), 0, finer * STEPS)[0].positions[finer - 1 :: finer]
    finally:
        simulation.close()


def _distance(one: FloatArray, other: FloatArray) -> float:
    return float(np.max(np.abs(one - other))) / BASE_AMPLITUDE
