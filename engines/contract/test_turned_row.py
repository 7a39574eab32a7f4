"""A row of one cell that is turned in the plane of its contact, for presets that turn it; refused by the others."""

import dataclasses
import math
import re

import numpy as np
import pytest

from engines.contract.lanes import tolerance_of
from engines.interface.selection import variants_of
from engines.interface.tolerances import STEPS
from engines.interface.variant import Variant
from reference_lcp.chain.canonical import BASE_AMPLITUDE
from reference_lcp.chain.harmonic import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.refusal import ParameterError

SHORT_SLIDE = 20
"""Steps in which a slip that begins with some U0 ω does not come to rest."""

SAME_MOTION = {"double": 1e-9, "single": 1e-4}
"""Of positions, over U0: directions of x and y are rounded alike but for the last places of their cosines."""

MOMENTUM = 0.03
"""Of the bound, between the friction that is reported and what it does to the momentum: what finer steps inside of a
step, or damping, change. Friction that is read along another axis lacks a tenth and more."""


def slide(variant: Variant, direction: float) -> tuple[Lane, State, Trajectory]:
    """Let the inner mass slide on the outer one, some U0 ω fast."""
    chain = Chain.from_ratios(friction_ratio=0.3, cells=1)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, BASE_AMPLITUDE), STEPS)
    state = State(np.zeros((1, 2)), np.array([[0.0, 20 * BASE_AMPLITUDE]]))
    simulation = variant.build([dataclasses.replace(lane, direction=direction)])
    try:
        return lane, state, simulation.run(state, 0, SHORT_SLIDE)[0]
    finally:
        simulation.close()


def test_row_along_the_other_tangent_moves_alike(turning: Variant) -> None:
    """Nothing distinguishes the two tangents of a contact, whatever its cone."""
    (*_, along), (*_, aside) = (slide(turning, direction) for direction in (0.0, math.pi / 2))
    difference = np.max(np.abs(along.positions - aside.positions)) / BASE_AMPLITUDE
    assert difference <= tolerance_of(turning, SAME_MOTION), f"off by {difference:.2g} U0"


def test_friction_of_a_turned_row_is_read_along_it(turning: Variant) -> None:
    """The reported friction is what the momentum of the inner mass along the row loses beside that to its spring."""
    lane, state, run = slide(turning, math.pi / 6)
    chain, positions = lane.chain, np.vstack([state.positions, run.positions[:-1]])
    velocities = np.vstack([state.velocities, run.velocities])
    slip, rate = positions[:, 1] - positions[:, 0], velocities[:-1, 1] - velocities[:-1, 0]
    spring = -chain.inner_stiffness * slip - chain.inner_damping * rate
    lost = chain.inner_mass * np.diff(velocities[:, 1]) / lane.time_step - spring
    missing = np.abs(np.mean(run.friction[:, 0] - lost)) / float(chain.friction_bound[0])
    assert missing <= MOMENTUM, f"{missing:.2g} of the bound is missing"


def test_row_that_cannot_be_turned_is_refused(installed: str) -> None:
    """By presets that do not turn it, with the direction."""
    for variant in variants_of(installed):
        if not variant.preset.turns:
            with pytest.raises(ParameterError, match=rf"direction = 0\.5: .*{re.escape(variant.formulation)}.* cannot"):
                slide(variant, 0.5)
