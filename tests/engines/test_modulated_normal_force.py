"""Engines under a normal force that changes in time: what the contract's canonical chain does not show."""

import dataclasses

import numpy as np
import pytest

from multibody_xval.engines.interface.presets import NormalForce
from multibody_xval.engines.interface.registry import engine_names
from multibody_xval.engines.interface.tolerances import CREEP, TRAJECTORY_TOLERANCE
from multibody_xval.engines.interface.variant import Variant, variants_of
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, lane_of, random_state, uneven_lane
from tests.installed import each_variant

TUNED = [
    own for name in engine_names() if name != "reference" for own in variants_of(name) if own.preset_name == "tuned"
]
SHARING = [own for own in TUNED if own.preset.shares_scheme]
FOLLOWING = each_variant(one for one in SHARING if one.preset.represents(NormalForce.MODULATED))
LIFTING = each_variant(one for one in SHARING if one.preset.represents(NormalForce.LIFTING))


def modulated(lane: Lane, modulation: float, multiple: int = 1, phase: float = 0.0) -> Lane:
    return dataclasses.replace(lane, preload=Preload.at_multiple(lane.drive, modulation, multiple, phase))


@pytest.mark.parametrize("variant", FOLLOWING)
def test_uneven_cells_each_follow_their_own_normal_force(variant: Variant) -> None:
    lanes = [modulated(uneven_lane(), 0.8, 2, phase=0.7), uneven_lane(), modulated(uneven_lane(), 0.5)]
    state, creep = random_state(3, size=0.3), CREEP * variant.preset.modulated().residual_slip_compliance
    allowed = TRAJECTORY_TOLERANCE[variant.capabilities.precision] + creep
    for index, motion in enumerate(variant.build(lanes).run(state, 7, STEPS)):
        expected = Variant("reference").build([lanes[index]]).run(state.subset([index]), 7, STEPS)[0]
        assert np.max(np.abs(motion.positions - expected.positions)) <= allowed * AMPLITUDE
        assert motion.normal_force == pytest.approx(expected.normal_force, rel=1e-3)


@pytest.mark.parametrize("variant", LIFTING)
def test_a_chain_in_flight_keeps_its_gap_beside_one_that_stays_closed(variant: Variant) -> None:
    pair, alone = (variant.build([modulated(lane_of(), a) for a in both]) for both in ((0.5, 1.5), (1.5,)))
    half = pair.advance(State.at_rest(2, 7), 0, 3 * STEPS // 4)
    assert np.all(half.internal_state[1, :7] > 0)
    end = pair.advance(half, 3 * STEPS // 4, 50)
    expected = alone.advance(half.subset([1]), 3 * STEPS // 4, 50)
    assert np.array_equal(end.positions[1], expected.positions[0])


@pytest.mark.parametrize("variant", LIFTING)
def test_landing_is_inelastic(variant: Variant) -> None:
    """A mass that has landed stays on its face until the actuator pulls it off again.

    It may be pushed out of its face for a step without a force, as by ODE: that is no flight.
    """
    run = variant.build([modulated(lane_of(), 1.5)]).run(State.at_rest(1, 7), 0, 2 * STEPS)[0]
    takes_off = np.diff((run.normal_gap > 1e-9 * AMPLITUDE).astype(int), axis=0) == 1
    assert np.all(np.sum(takes_off, axis=0) == 2), "once in each of two cycles"


@pytest.mark.needs("mujoco")
def test_sphere_sinks_into_its_plate_by_less_and_less_with_finer_steps() -> None:
    """Its contact is as stiff as a step allows, and no stiffer: the static depth is in proportion to N dt² / m."""
    depths = []
    for steps in (STEPS, 2 * STEPS):
        lane = modulated(lane_of(0.3, 0.5, steps), 0.0)
        run = Variant("mujoco", "contact").build([lane]).run(State.at_rest(1, 7), 0, steps)[0]
        depths.append(-run.normal_gap[-1])
    assert np.all(depths[0] < 1e-6 * AMPLITUDE)
    assert depths[0] / depths[1] == pytest.approx(np.full(7, 4.0), rel=0.01)
