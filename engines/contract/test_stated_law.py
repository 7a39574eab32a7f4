"""A preset steps as it says: by the reference's scheme, or by a law that is a model with constants from its options."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.engines.contract.lanes import (
    lane_of,
    modulated_lane,
    random_lanes,
    random_state,
    scaled_state,
    unexplained_impulse,
)
from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.law import Law
from multibody_xval.engines.interface.registry import law_of
from multibody_xval.engines.interface.tolerances import MOMENTUM_TOLERANCE, SCHEME_TOLERANCE_DB, STEPS
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.shared.law_distance import allowed_distance, stepped_by
from multibody_xval.engines.shared.law_limit import law_fault
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.defaults import STICK_SLIP_POINTS
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.steady.neighbours import orbits_from_euler
from reference_lcp.validation import FloatArray

ORBIT_RESIDUAL = 1e-9
"""Of the law's orbit, which an engine in double precision has to find again to 1e-8."""


def test_preset_says_by_which_law_it_steps(tested: Variant) -> None:
    """The reference's scheme, a model, or the reason why there is none; one of them, and no other."""
    preset = tested.preset
    assert preset.shares_scheme != (preset.law is not None), "it states no law, or two"


def test_stated_law_is_one_of_the_chain(modelled: Variant) -> None:
    """With ideal constants and ever finer steps it is the exact motion; it claims something, to a bound that is small.

    Otherwise it could be whatever the engine does.
    """
    fault = law_fault(modelled)
    assert fault is None, fault


def test_momentum_changes_as_in_the_law(modelled: Variant) -> None:
    """What the reported forces leave unexplained of the motion over a period is what dampers of the law explain."""
    lane = _claimed(modelled, [lane_of(0.3, 0.9, 4 * STEPS)])[0]
    runs = _runs(modelled, lane)
    own, of_law = (unexplained_impulse(lane, run) for run in runs)
    assert np.max(np.abs(own - of_law)) < MOMENTUM_TOLERANCE, "the forces do not explain the motion"


def test_steady_states_at_three_points_are_those_of_the_law(modelled: Variant) -> None:
    """Wherever the law has one, the engine's search from it stays there."""
    lanes = _claimed(modelled, [lane_of(*place) for place in STICK_SLIP_POINTS[::2]])
    law = law_of(modelled.preset)
    assert law is not None
    expected = orbits_from_euler(law.build(lanes), STEPS, tolerance=ORBIT_RESIDUAL, longest_multiple=1)
    steady = [number for number, orbit in enumerate(expected) if orbit.converged]
    if not steady:
        pytest.skip("its law has no steady state there")
    starts = State.stack([expected[number].trajectory.end for number in steady])
    simulation = modelled.build([lanes[number] for number in steady])
    residual = modelled.capabilities.residual
    found = orbits_from_euler(simulation, STEPS, start=starts, tolerance=residual, anew=False)
    simulation.close()
    off = [
        float(decibel(transmittance(orbit)) - decibel(transmittance(expected[number])))
        for number, orbit in zip(steady, found, strict=True)
    ]
    assert np.max(np.abs(off)) <= SCHEME_TOLERANCE_DB, f"off by {off} dB"


def _claimed(modelled: Variant, lanes: Sequence[Lane]) -> list[Lane]:
    """Give the lanes that the law of a variant claims, or skip."""
    law = law_of(modelled.preset)
    claimed = [lane for lane in lanes if law is not None and law.unclaimed_reason(lane) is None]
    return claimed or pytest.skip("its law claims none of these points")


def _runs(modelled: Variant, lane: Lane) -> list[Trajectory]:
    """Give a period of the variant and of its law from one state."""
    law = law_of(modelled.preset)
    assert law is not None
    return [_period(what, [lane], random_state(1), 4 * STEPS)[0] for what in (modelled, law)]


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
    lanes = [lane for lane in random_lanes() if law.unclaimed_reason(lane) is None]
    state = scaled_state(lanes)
    own = _period(tested, lanes, state)
    for symbol, constant in law.constants.items():
        factor = 0.0 if constant.too_small_to_see else 1 + constant.visible_error
        wrong = replace(law, constants={**law.constants, symbol: replace(constant, value=factor * constant.value)})
        distance = np.max(_apart(lanes, own, _period(wrong, lanes, state)))
        moved = distance > law.period_bound
        assert moved != constant.too_small_to_see, f"{symbol} × {factor:g} makes {distance:.1g}"


def _distances(tested: Variant, expected: Engine | Law, given: Sequence[Lane] = ()) -> FloatArray:
    """Largest difference of positions over a period from the same state, over the displacement scale, per lane.

    The lanes are random ones unless some are given; those that the law leaves out are left out.
    """
    law = law_of(tested.preset)
    lanes = [lane for lane in given or random_lanes() if law is None or law.unclaimed_reason(lane) is None]
    state = scaled_state(lanes)
    return _apart(lanes, _period(tested, lanes, state), _period(expected, lanes, state))


def _period(what: Variant | Engine | Law, lanes: Sequence[Lane], state: State, steps: int = STEPS) -> list[Trajectory]:
    """Give a period of every lane from a state."""
    simulation = what.build(lanes)
    runs = simulation.run(state, 0, steps)
    simulation.close()
    return runs


def _apart(lanes: Sequence[Lane], runs: Sequence[Trajectory], others: Sequence[Trajectory]) -> FloatArray:
    """Largest difference of positions, over the displacement scale, per lane."""
    return np.array(
        [
            np.max(np.abs(run.positions - other.positions)) / lane.drive.displacement_scale(lane.chain)
            for lane, run, other in zip(lanes, runs, others, strict=True)
        ]
    )
