"""What is said of a preset's steps: the reference's scheme, or a law, a model with constants from its options."""

from collections.abc import Callable, Sequence

import numpy as np

from multibody_xval.engines.contract.lanes import random_lanes, run_of, scaled_state, tolerance_of
from multibody_xval.engines.interface.laws import Law, law_of
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.tolerances import STEPS, TRAJECTORY_TOLERANCE
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray

Motion = Callable[[Lane, State], FloatArray]


def test_random_chain_moves_by_the_reference_s_scheme(sharing: Variant) -> None:
    """One period from a random state: unequal cells, other units, μ a cell, inner dashpots, base and force."""
    apart = _apart(_of_variant(sharing), _of_variant(Variant("reference")), random_lanes())
    assert apart <= tolerance_of(sharing, TRAJECTORY_TOLERANCE), "another motion than the scheme's [U0]"


def test_random_chain_moves_by_the_law_and_by_no_other(modelled: Variant) -> None:
    """The same beside a law; with any constant off by a hundredth it is another one."""
    law = law_of(engine(modelled.engine), modelled.formulation, modelled.preset_name)
    assert law is not None, "presets without a law are not asked for"
    lanes, own = random_lanes(), _of_variant(modelled)
    motions = {(id(lane)): own(lane, state) for lane, state in zip(lanes, _states(lanes), strict=True)}
    apart = _apart(lambda lane, _: motions[id(lane)], _of_law(law), lanes)
    assert apart <= law.bound, "another motion than the law's [U0]"
    for symbol, constant in law.constants.items():
        wrong = law.with_constant(symbol, 1 + constant.visible_error)
        apart = _apart(lambda lane, _: motions[id(lane)], _of_law(wrong), lanes)
        assert apart > law.bound, f"{symbol} × {1 + constant.visible_error:g} is not noticed: the law is as near [U0]"


def _of_variant(variant: Variant) -> Motion:
    return lambda lane, state: run_of(variant, lane, state, STEPS).positions


def _of_law(law: Law) -> Motion:
    return lambda lane, state: law.positions(lane, state, STEPS)


def _states(lanes: Sequence[Lane]) -> list[State]:
    state = scaled_state(lanes)
    return [state.subset([number]) for number in range(len(lanes))]


def _apart(one: Motion, other: Motion, lanes: Sequence[Lane]) -> float:
    """Largest difference of positions over a period from the same states, over the displacement scale."""
    return max(
        float(np.max(np.abs(one(lane, state) - other(lane, state)))) / lane.drive.displacement_scale(lane.chain)
        for lane, state in zip(lanes, _states(lanes), strict=True)
    )
