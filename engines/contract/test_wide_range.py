"""All over the ranges that a user may ask for, and however long a simulation has been used."""

import numpy as np
import pytest

from multibody_xval.engines.contract.lanes import lane_of, random_state, scaled_state, tolerance_of
from multibody_xval.engines.interface.tolerances import STEPS, TRAJECTORY_TOLERANCE
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.shared.wide_range import DESIGN, LONG_USE, MANY_RUNS, RangePoint
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.validation import FloatArray

LATE_PERIODS = LONG_USE // STEPS + 10
"""After which the drive repeats, beyond `LONG_USE` steps."""


def positions_of(variant: Variant | Simulation, lane: Lane, state: State, start: int, steps: int) -> FloatArray:
    """Run one lane, in a simulation of its own unless one is given."""
    simulation = variant.build([lane]) if isinstance(variant, Variant) else variant
    try:
        return simulation.run(state, start, steps)[0].positions
    finally:
        if isinstance(variant, Variant):
            simulation.close()


@pytest.mark.parametrize("point", DESIGN, ids=lambda point: f"friction coefficient {point.friction_coefficient:g}")
def test_chain_anywhere_in_the_ranges_moves_by_the_reference_s_scheme(sharing: Variant, point: RangePoint) -> None:
    """One period from a random state: other friction coefficients, dashpots, frequencies, cells and time steps."""
    lane = point.lane
    state = scaled_state([lane])
    own, expected = (positions_of(each, lane, state, 0, point.steps) for each in (sharing, Variant("reference")))
    off = np.max(np.abs(own - expected)) / lane.drive.displacement_scale(lane.chain)
    assert off <= tolerance_of(sharing, TRAJECTORY_TOLERANCE), "the motion differs from the reference's [U0]"


def test_motion_does_not_depend_on_when_it_begins(tested: Variant) -> None:
    """A whole number of periods later, beyond any step of other clauses, the same drive makes the same motion."""
    lane, state = lane_of(0.3, 0.6), random_state(1)
    first, later = (positions_of(tested, lane, state, periods * STEPS, STEPS) for periods in (0, LATE_PERIODS))
    off = np.max(np.abs(later - first)) / BASE_AMPLITUDE
    own = 0.0 if tested.preset.shares_scheme else tested.capabilities.residual
    allowed = max(tolerance_of(tested, TRAJECTORY_TOLERANCE), own)
    assert off <= allowed, f"another motion after {LATE_PERIODS} periods [U0]"


@pytest.mark.slow
def test_long_use_leaves_nothing_behind(tuned: Variant) -> None:
    """After more steps and more runs than any other clause takes, a motion is that of a simulation that is new."""
    lane, state = lane_of(0.3, 0.6), random_state(1)
    used = tuned.build([lane])
    moving, steps = state, LONG_USE // MANY_RUNS
    for number in range(MANY_RUNS + 10):
        moving = used.advance(moving, number * steps, steps)
    start = LATE_PERIODS * STEPS
    later = positions_of(used, lane, state, start, STEPS)
    used.close()
    fresh = positions_of(tuned, lane, state, start, STEPS)
    allowed = 0.0 if tuned.capabilities.deterministic else tolerance_of(tuned, TRAJECTORY_TOLERANCE)
    off = np.max(np.abs(later - fresh)) / BASE_AMPLITUDE
    assert off <= allowed, f"another motion after {LONG_USE} steps [U0]"
