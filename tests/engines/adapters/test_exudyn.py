"""Exudyn: its two friction laws and its restarts."""

import numpy as np
import pytest

from multibody_xval.engines.exudyn.joint import static_decays
from multibody_xval.engines.shared.script_units import SI
from reference_lcp.chain.trajectory import State
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.one_call import exact_steady_state
from reference_lcp.steady.orbits import periodic_orbits
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, built, lane_of, random_state, run

pytestmark = pytest.mark.needs("exudyn-bristle")


def test_fresh_bristle_carries_the_load_that_it_meets() -> None:
    """A stuck contact that starts without internal state must not let go."""
    lane = lane_of(5.0, 0.6)
    state = run("exudyn-bristle", lane, State.at_rest(1, 7)).end
    kept, lost = (run("exudyn-bristle", lane, own) for own in (state, State(state.positions, state.velocities)))
    assert 0 < np.max(np.abs(kept.positions - lost.positions)) / AMPLITUDE < 1e-3


def test_a_disc_moves_as_the_connector_of_the_same_zone_does() -> None:
    """Two implementations of one law: what differs is the integration across the corners of the zone."""
    lane, zone = lane_of(0.3, 0.9), {"zone": 0.01, "substeps": 4, "zone_per_kick": 0.0}
    pressed, joined = (run(f"exudyn-regularised:{own}", lane, random_state(), **zone) for own in ("contact", "joint"))
    assert np.max(np.abs(pressed.positions - joined.positions)) < 1e-3 * AMPLITUDE
    assert pressed.normal_force == pytest.approx(np.broadcast_to(lane.chain.normal_force, (STEPS, 7)), rel=1e-6)


@pytest.mark.parametrize(("steps", "substeps"), [(STEPS, 4), (2 * STEPS, 1)])
def test_static_friction_of_a_stiff_bristle_decays_over_4_per_cent_of_a_kick(steps, substeps) -> None:
    """A kick is what the bound does to the relative velocity in a step of the solver."""
    lane = lane_of(0.3, 0.9, steps, mass_ratio=0.5)
    (inside,) = built("exudyn-bristle", lane, substeps=substeps).models
    kick = lane.chain.friction_bound[0] * (1 / lane.chain.outer_mass[0] + 1 / lane.chain.inner_mass[0])
    part = 0.04 * kick * lane.time_step / substeps
    assert static_decays(lane, inside._preset, SI)[0] == pytest.approx(part)


@pytest.mark.slow
def test_error_of_transmittance_is_in_proportion_to_the_zone() -> None:
    """The law of regularised friction: where cells hardly move, creep within the zone is all of the error."""
    lane, errors = lane_of(0.1, 1.4), []
    exact = exact_steady_state(lane.chain, lane.drive).transmittance_db
    for zone in (4e-3, 2e-3, 1e-3):
        simulation = built("exudyn-regularised", lane, zone=zone)
        errors.append(decibel(transmittance(periodic_orbits(simulation, STEPS)[0])) - exact)
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(2, rel=0.05)


def test_a_zone_so_narrow_that_newtons_iteration_fails_needs_steps_that_may_be_halved() -> None:
    with pytest.raises(RuntimeError, match=r"exudyn stopped at \S+ s: no convergence"):
        run("exudyn-regularised:joint:default", lane_of(1.0, 0.7), random_state(), 2 * STEPS, smallest_step=0.9)
