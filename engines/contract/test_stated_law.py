"""A preset steps as it says: by the reference's scheme, or by a law that is a model with constants from its options."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from engines.contract.lanes import modulated_lane, random_lanes, scaled_state
from engines.interface.engine import Engine
from engines.interface.law import Law
from engines.interface.registry import law_of
from engines.interface.tolerances import STEPS
from engines.interface.variant import Variant
from engines.shared.law_distance import allowed_distance, stepped_by
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.validation import FloatArray


def test_preset_says_by_which_law_it_steps(tested: Variant) -> None:
    """The reference's scheme, a model, or the reason why there is none; one of them, and no other."""
    preset = tested.preset
    assert preset.shares_scheme != (preset.law is not None), "it states no law, or two"


def test_random_chain_moves_by_the_stated_law(tested: Variant) -> None:
    """One period from a random state: unequal cells, other units, μ a cell, inner dashpots, base and force."""
    stated = stepped_by(tested)
    if stated is None:
        pytest.skip("its steps are not modelled")
    distances = _distances(tested, stated)
    assert np.max(distances) <= allowed_distance(tested), f"off by {distances} displacement scales"


def test_stated_law_holds_under_a_modulated_normal_force(following: Variant) -> None:
    """One period from a random state: the law's bound of friction is that of the step."""
    law = law_of(following.preset)
    if law is None or not law.modulated:
        pytest.skip("it states no law for a modulated normal force")
    distances = _distances(following, law, [modulated_lane(0.5)])
    assert np.max(distances) <= law.period_bound, f"off by {distances} displacement scales"


def test_law_with_a_constant_off_by_a_hundredth_is_found_out(tested: Variant) -> None:
    """Every constant of the law is one that the engine has, or so small that it could be left out."""
    law = law_of(tested.preset)
    if law is None:
        pytest.skip("it has no constants of its own")
    for symbol, constant in law.constants.items():
        factor = 0.0 if constant.too_small_to_see else 1 + constant.visible_error
        wrong = replace(law, constants={**law.constants, symbol: replace(constant, value=factor * constant.value)})
        distance = np.max(_distances(tested, wrong))
        moved = distance > law.period_bound
        assert moved != constant.too_small_to_see, f"{symbol} × {factor:g} makes {distance:.1g}"


def _distances(tested: Variant, expected: Engine | Law, given: Sequence[Lane] = ()) -> FloatArray:
    """Largest difference of positions over a period from the same state, over the displacement scale, per lane.

    The lanes are random ones unless some are given; those that the law leaves out are left out.
    """
    law = law_of(tested.preset)
    lanes = [lane for lane in given or random_lanes() if law is None or law.unclaimed_reason(lane) is None]
    state = scaled_state(lanes)
    simulations: list[Simulation] = [tested.build(lanes), expected.build(lanes)]
    runs = [simulation.run(state, 0, STEPS) for simulation in simulations]
    for simulation in simulations:
        simulation.close()
    return np.array(
        [
            np.max(np.abs(run.positions - predicted.positions)) / lane.drive.displacement_scale(lane.chain)
            for lane, run, predicted in zip(lanes, *runs, strict=True)
        ]
    )
