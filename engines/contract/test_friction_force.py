"""The force of a contact: its bound, its sign, and where there is none."""

import dataclasses

import numpy as np
import pytest

from engines.contract.lanes import drive_of, lane_of, random_state, run_of, tolerance_of
from engines.interface.presets import FrictionLaw
from engines.interface.tolerances import BOUND_MARGIN, ROUND_OFF, SLIDING, STEPS
from engines.interface.variant import Variant
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.defaults import BASE_AMPLITUDE


def test_normal_force_is_the_one_that_is_given(tuned: Variant) -> None:
    """A measured one as well: nothing may press harder while a contact slides."""
    lane = lane_of(0.3, 0.6)
    run = run_of(tuned, lane, random_state(1), 50)
    given = np.broadcast_to(lane.chain.normal_force, (50, 7))
    assert run.normal_force == pytest.approx(given, rel=tolerance_of(tuned, ROUND_OFF))


def test_cells_without_friction_feel_none(tested: Variant) -> None:
    """Of both kinds: no normal force, and no coefficient of friction."""
    chain = Chain.from_ratios(friction_ratio=[0.3, 0.0, 0.3, 0.3, 0.1, 0.3, 1.0])
    coefficient = np.where(np.arange(7) == 3, 0.0, chain.friction_coefficient)
    chain = dataclasses.replace(chain, friction_coefficient=coefficient)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6), STEPS)
    run = run_of(tested, lane, random_state(1), 50)
    without = chain.friction_bound == 0
    assert np.all(run.friction[:, without] == 0), "a cell without friction reports some"
    assert np.all(np.any(run.friction[:, ~without] != 0, axis=0)), "a cell with friction reports none"


def test_friction_stays_within_its_bound(tested: Variant) -> None:
    """|λ_T| <= μ λ_N, in stick and in slip."""
    lane = lane_of(0.3, 0.6)
    run = run_of(tested, lane, random_state(1), STEPS)
    bound = lane.chain.friction_coefficient * run.normal_force
    largest = float(np.max(np.abs(run.friction) / bound))
    assert largest <= 1 + BOUND_MARGIN[tested.capabilities.precision], "friction passes its bound"


def test_friction_acts_on_the_inner_mass_against_its_slip(tested: Variant) -> None:
    """Sign convention: λ_T as it acts on the inner mass, so that its power with ġ_T takes energy out."""
    lane = lane_of(0.3, 0.6)
    run = run_of(tested, lane, random_state(1), STEPS)
    power = run.friction * run.relative_velocity
    sliding = np.abs(run.relative_velocity) > SLIDING * BASE_AMPLITUDE * drive_of(lane).angular_frequency
    if tested.capabilities.friction_law is FrictionLaw.BRISTLE or tested.preset_name != "tuned":
        # a bristle that has been bent gives its energy back after a reversal, and a soft constraint acts late:
        # only their sum is a loss
        assert np.all(np.sum(power, axis=0) < 0), "friction drives the slip"
    else:
        assert np.all(power[sliding] < 0), "friction drives the slip"
