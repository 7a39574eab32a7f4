"""Engines under a normal force that changes in time: what the contract's canonical chain does not show."""

import dataclasses
import re

import numpy as np
import pytest

from multibody_xval.engines.interface.presets import NormalForce
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.tolerances import CREEP, TRAJECTORY_TOLERANCE
from multibody_xval.engines.interface.variant import Variant, variants_of
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Flight, Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, random_state, uneven_lane
from tests.installed import each_variant

SHARING = [
    variant
    for name in engine_names()
    if name != "reference"
    for variant in variants_of(name)
    if variant.preset_name == "tuned" and variant.preset.shares_scheme
]
FOLLOWING = each_variant(one for one in SHARING if one.preset.represents(NormalForce.MODULATED))
LIFTING = each_variant(one for one in SHARING if one.preset.represents(NormalForce.LIFTING))


def modulated(lane: Lane, modulation: float, multiple: int = 1, phase: float = 0.0) -> Lane:
    return dataclasses.replace(lane, preload=Preload.at_multiple(lane.drive, modulation, multiple, phase))


def allowed(variant: Variant) -> float:
    """Of motions of a few periods, over U0."""
    return (
        TRAJECTORY_TOLERANCE[variant.capabilities.precision]
        + CREEP * variant.preset.modulated().residual_slip_compliance
    )


@pytest.mark.parametrize("variant", FOLLOWING)
def test_uneven_cells_each_follow_their_own_normal_force(variant: Variant) -> None:
    lanes = [modulated(uneven_lane(), 0.8, 2, phase=0.7), uneven_lane(), modulated(uneven_lane(), 0.5)]
    state = random_state(3, size=0.3)
    for index, motion in enumerate(variant.build(lanes).run(state, 7, STEPS)):
        expected = Variant("reference").build([lanes[index]]).run(state.subset([index]), 7, STEPS)[0]
        assert np.max(np.abs(motion.positions - expected.positions)) <= allowed(variant) * AMPLITUDE
        assert motion.normal_force == pytest.approx(expected.normal_force, rel=1e-3)


@pytest.mark.parametrize("variant", LIFTING)
def test_gap_of_masses_that_differ_is_that_over_a_guided_outer_mass(variant: Variant) -> None:
    """Where nothing guides the outer mass it flies away too: the gap is another, its time in the air is not."""
    chain = Chain.from_ratios(friction_ratio=0.3, mass_ratio=0.4, base_amplitude=AMPLITUDE)
    lane = modulated(Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.5, AMPLITUDE), STEPS), 1.5)
    run = variant.build([lane]).run(State.at_rest(1, 7), 0, 2 * STEPS)[0]
    assert lane.preload is not None
    assert run.normal_gap is not None
    flight = Flight.of(lane.preload)
    scale = chain.normal_force / chain.inner_mass / lane.preload.angular_frequency**2
    assert np.max(run.normal_gap, axis=0) / scale == pytest.approx(np.full(7, flight.highest), rel=0.01)
    in_air = np.mean(run.normal_force[STEPS : 2 * STEPS] == 0, axis=0)
    assert in_air == pytest.approx(np.full(7, flight.open_fraction), abs=2 / STEPS)


@pytest.mark.parametrize("variant", LIFTING)
def test_lane_in_flight_keeps_its_gap_beside_one_that_stays_closed(variant: Variant) -> None:
    chain = Chain.from_ratios(friction_ratio=0.3, base_amplitude=AMPLITUDE)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.5, AMPLITUDE), STEPS)
    pair, alone = (variant.build([modulated(lane, a) for a in both]) for both in ((0.5, 1.5), (1.5,)))
    half = pair.advance(State.at_rest(2, 7), 0, 3 * STEPS // 4)
    assert half.internal_state is not None
    assert np.all(half.internal_state[1, :7] > 0)
    end = pair.advance(half, 3 * STEPS // 4, 50)
    expected = alone.advance(half.subset([1]), 3 * STEPS // 4, 50)
    assert np.array_equal(end.positions[1], expected.positions[0])


@pytest.mark.parametrize("variant", LIFTING)
def test_landing_is_inelastic(variant: Variant) -> None:
    """A mass that has landed stays on its face until the actuator pulls it off again.

    It may be pushed out of its face for a step without a force, as by ODE: that is no flight.
    """
    chain = Chain.from_ratios(friction_ratio=0.3, base_amplitude=AMPLITUDE)
    lane = modulated(Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.5, AMPLITUDE), STEPS), 1.5)
    run = variant.build([lane]).run(State.at_rest(1, 7), 0, 2 * STEPS)[0]
    assert run.normal_gap is not None
    takes_off = np.diff((run.normal_gap > 1e-9 * AMPLITUDE).astype(int), axis=0) == 1
    assert np.all(np.sum(takes_off, axis=0) == 2), "once in each of two cycles"


@pytest.mark.needs("pybullet")
def test_motor_that_may_do_nothing_reports_nothing() -> None:
    """Bullet keeps the last force of a motor whose bound is zero; at N = 0 the adapter does not believe it."""
    lane = modulated(uneven_lane(), 1.0)
    # sin = -1 exactly at three quarters of the period.
    run = Variant("pybullet").build([lane]).run(random_state(), 0, STEPS)[0]
    bound = lane.chain.friction_coefficient * lane.preloads(0, STEPS)
    assert np.all(np.abs(run.friction) <= bound * (1 + 1e-9))
    assert np.all(run.friction[3 * STEPS // 4] == 0)


@pytest.mark.needs("mujoco")
def test_sphere_sinks_into_its_plate_by_less_and_less_with_finer_steps() -> None:
    """Its contact is as stiff as a step allows, and no stiffer: the static depth is in proportion to N dt² / m."""
    chain = Chain.from_ratios(friction_ratio=0.3, base_amplitude=AMPLITUDE)
    depths = []
    for steps in (STEPS, 2 * STEPS):
        lane = modulated(Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.5, AMPLITUDE), steps), 0.0)
        run = Variant("mujoco", "contact").build([lane]).run(State.at_rest(1, 7), 0, steps)[0]
        assert run.normal_gap is not None
        depths.append(-run.normal_gap[-1])
    assert np.all(depths[0] < 1e-6 * AMPLITUDE)
    assert depths[0] / depths[1] == pytest.approx(np.full(7, 4.0), rel=0.01)


@pytest.mark.parametrize("name", ["drake", "siconos"])
def test_engine_with_a_constant_normal_force_says_so_before_it_is_looked_for(name: str) -> None:
    lane = modulated(uneven_lane(), 0.5)
    with pytest.raises(
        ParameterError, match=re.escape(f"modulation = 0.5: {name}:joint:tuned cannot represent a modulated")
    ):
        engine(name).build([lane])
