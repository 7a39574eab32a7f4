"""What is said of a preset's steps: the reference's scheme, or a law, a model with constants from its options."""

from collections.abc import Iterator

import numpy as np

from multibody_xval.engines.contract.lanes import random_lanes, run_of, scaled_state, tolerance_of
from multibody_xval.engines.interface.laws import law_of
from multibody_xval.engines.interface.tolerances import STEPS, TRAJECTORY_TOLERANCE
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray


def test_random_chain_moves_by_the_reference_s_scheme(sharing: Variant) -> None:
    """One period from a random state: unequal cells, other units, μ a cell, inner dashpots, base and force."""
    apart = max(
        distance(lane, *(run_of(each, lane, state, STEPS).positions for each in (sharing, Variant("reference"))))
        for lane, state in starts()
    )
    assert apart <= tolerance_of(sharing, TRAJECTORY_TOLERANCE), (
        "the motion of a random chain differs from the reference's [U0]"
    )


def test_random_chain_moves_by_the_law_and_by_no_other(modelled: Variant) -> None:
    """The same beside a law; with any constant off by a hundredth it is another one."""
    law = law_of(modelled)
    assert law is not None, "presets without a law are not asked for"
    motions = [(lane, state, run_of(modelled, lane, state, STEPS).positions) for lane, state in starts()]
    apart = max(distance(lane, own, law.positions(lane, state, STEPS)) for lane, state, own in motions)
    assert apart <= law.bound, "another motion than the law's [U0]"
    for symbol, constant in law.constants.items():
        wrong = law.with_constant(symbol, 1 + constant.visible_error)
        off = (distance(lane, own, wrong.positions(lane, state, STEPS)) for lane, state, own in motions)
        assert any(own > law.bound for own in off), f"{symbol} × {1 + constant.visible_error:g} is not noticed"


def starts() -> Iterator[tuple[Lane, State]]:
    """Give the random chains, each with a random state."""
    lanes = random_lanes()
    state = scaled_state(lanes)
    return ((lane, state.subset([number])) for number, lane in enumerate(lanes))


def distance(lane: Lane, one: FloatArray, other: FloatArray) -> float:
    """Largest difference of positions, over the displacement scale."""
    return float(np.max(np.abs(one - other))) / lane.drive.displacement_scale(lane.chain)
