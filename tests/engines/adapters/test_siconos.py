"""Siconos: its relays and contacts, and where it says nothing of what goes wrong."""

import re

import numpy as np
import pytest

from multibody_xval.engines.isolated.process import EngineProcessError
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import Config
from reference_lcp.chain.trajectory import State
from reference_lcp.schemes.euler import CompiledSimulation
from reference_lcp.steady.orbits import periodic_orbits
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, lane_of, random_state, run, uneven_lane

pytestmark = pytest.mark.needs("siconos")


def test_a_relay_is_idle_while_the_inner_mass_is_ahead_unless_it_starts_deep_below() -> None:
    """Siconos takes the relation for a gap: without the offset half of the friction is lost, without a word."""
    ahead = State(np.repeat([0, AMPLITUDE], 7)[None], np.zeros((1, 14)))
    assert np.all(run("siconos", lane_of(0.3), ahead, 5, activation="gap <= 0").friction == 0)
    assert np.all(np.abs(run("siconos", lane_of(0.3), ahead, 5).friction) > 0)


@pytest.mark.parametrize("solver", ["PATH", "PGS"])
def test_a_solver_that_fails_is_reported(solver: str) -> None:
    """Siconos at most prints a warning: PATH is not built in, and PGS stops far too early."""
    said = rf"the solver {re.escape(solver)} failed: friction of cell \d in step \d+ breaks"
    with pytest.raises(EngineProcessError, match=said):
        run("siconos", uneven_lane(), random_state(), solver=solver)


@pytest.mark.parametrize(("threshold", "worst"), [(0.0, 0.9), (1e-6, 0.0)])
def test_without_a_threshold_lemke_parts_a_contact_and_presses_twice_in_the_next_step(threshold, worst) -> None:
    lane, options = lane_of(0.3, 0.9), {"units": "SI", "solver": "LEMKE", "threshold": threshold}
    motion = run("siconos:contact", lane, State.at_rest(1, 7), **options)
    assert worst <= np.max(np.abs(motion.normal_force / lane.chain.normal_force - 1)) <= worst + 0.2


def test_default_contacts_let_go_for_single_steps_and_a_threshold_above_round_off_holds_them() -> None:
    """Unequal cells over a period of their steady state: a contact that lets go has no normal force, no friction."""
    unequal = {"mass_ratio": [0.8374, 0.8888, 1.0881, 0.9612, 1.1257, 0.9023, 1.1914]}
    lane = lane_of([0.2211, 0.3327, 0.2689, 0.3154, 0.2377, 0.3581, 0.2793], 0.6, **unequal)
    (orbit,) = periodic_orbits(CompiledSimulation([lane]), STEPS)
    default, held = (
        run("siconos:contact:default", lane, orbit.trajectory.end, threshold=own).normal_force for own in (0.0, 1e-6)
    )
    assert 0 < np.sum(default == 0.0) < default.size / 100
    assert np.all(held > 0.0)


def measured(name: str, case: str) -> dict[str, float]:
    """Run a case of a scenario at 1 ms, and give its numbers."""
    scenario = SCENARIOS[name]
    own = scenario.own_runs(Config("siconos", "contact", "default"))[f"{case}, 1 ms"]
    (result,) = run_batch([own])
    return {quantity.name: quantity.read(result, own) for quantity in scenario.quantities}


def friction_on_slope(friction: float, load: float) -> float:
    """Give the friction of a contact over μ N, less 1 [%], whose first tangent is (0, −n_z, n_x).

    The normal n is not square to it, and the second tangent, n times the first, is shorter than 1.
    """
    slope = np.arctan(load * friction)
    along, up = np.sin(slope), np.cos(slope)
    slip = np.hypot(up, along**2)
    return float(100 * (slip / (1 + friction * along**3 * up / slip) - 1))


@pytest.mark.parametrize(
    ("friction", "load"), [(0.5, 1.5), *(pytest.param(mu, 1.2, marks=pytest.mark.slow) for mu in (0.2, 0.8))]
)
def test_box_on_a_slope_along_x_rubs_too_little_by_the_frame_of_its_contacts(friction: float, load: float) -> None:
    """By 3 to 29 % below 45°: Siconos 4.4.0."""
    off = measured("slope-slide", f"μ {friction:g}, load {load:g}")["friction"]
    assert off == pytest.approx(friction_on_slope(friction, load), abs=0.2)


def test_box_on_the_flat_stops_where_it_should_and_one_that_fingers_press_holds() -> None:
    """There the frame is sound."""
    assert abs(measured("slide-to-stop", "3 m/s")["distance"]) < 0.5
    assert measured("grip", "1 kg, 10 N") == pytest.approx({"drift": 0.0, "sag": 0.0}, abs=0.1)
