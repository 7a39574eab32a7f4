"""ODE: its motors, its contacts and its own springs, and where its Python binding or its defaults mislead."""

import sys

import numpy as np
import pytest

from multibody_xval.engines.interface.scene import JointScene, SceneSetting
from multibody_xval.engines.isolated.out_of_process import process_of
from multibody_xval.engines.isolated.process import EngineProcessError
from multibody_xval.engines.ode import ODE
from multibody_xval.engines.ode.scene import SERVER, STEP
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUND_OFF,
    STEPS,
    built_with,
    lane_of,
    random_state,
    scheme,
)

pytestmark = pytest.mark.needs("ode")


def run(
    lane: Lane, state: State, steps: int = STEPS, formulation: str = "joint", preset: str = "tuned", **options: object
) -> Trajectory:
    return built_with(ODE(), lane, formulation, preset, **options).run(state, 0, steps)[0]


def test_the_binding_names_another_parameter_for_the_largest_force() -> None:
    """In ODE 0.16 a new number came before it: what pyode calls FMax is the lowest velocity, and nothing rubs."""
    lane, state = lane_of(), random_state()
    without = run(lane, state, 50, fmax=3)
    assert np.all(without.friction == 0)
    frictionless = scheme(lane_of(0.0), state, 50)[0]
    np.testing.assert_allclose(without.positions, frictionless, rtol=0, atol=ROUND_OFF * AMPLITUDE)


def test_soft_constraints_make_a_stuck_contact_creep_and_hard_ones_do_not() -> None:
    lane = lane_of(5.0, 0.3)
    speed = AMPLITUDE * lane.drive.angular_frequency
    soft, hard = (run(lane, State.at_rest(1, 7), 3 * STEPS, units="SI", cfm=cfm) for cfm in (1e-10, 0.0))
    assert 1e-11 < np.max(np.abs(soft.relative_velocity)) / speed < 1e-6
    assert np.max(np.abs(hard.relative_velocity)) / speed <= 1e-13
    assert np.max(np.abs(hard.inner_positions - hard.outer_positions)) <= 1e-12 * AMPLITUDE


@pytest.mark.parametrize("mode", [0x004, 0x1000])
def test_in_a_contact_mu_is_a_force_unless_the_mode_says_otherwise(mode: int) -> None:
    """`ContactBounce` takes mu = 0.5 for half a newton; so does `ContactApprox1_1`, for slip is along direction 2."""
    lane, state = lane_of(0.3), random_state()
    assert lane.chain.friction_bound == pytest.approx(3.0)
    motion = run(lane, state, 50, "contact", units="SI", mode=mode)
    assert np.max(np.abs(motion.friction)) == pytest.approx(0.5, rel=1e-6)
    assert np.max(motion.normal_force) == pytest.approx(6.0, rel=1e-6)


@pytest.mark.parametrize("inertia", [2.0**20, 2.0**60])
def test_redundant_points_of_a_hard_contact_give_a_wrong_motion_without_a_word(inertia: float) -> None:
    lane, state = lane_of(0.3, 0.9), State.at_rest(1, 7)
    motion = run(lane, state, 10 * STEPS, "contact", shape="box", inertia=inertia)
    assert np.max(np.abs(motion.positions - scheme(lane, state, 10 * STEPS)[0])) > 0.05 * AMPLITUDE


def test_a_contact_outside_the_surface_layer_is_pushed_out() -> None:
    lane, state = lane_of(), State.at_rest(1, 7)
    pushed, left = (
        run(lane, state, 5, "contact", surface_layer=layer).normal_force / lane.chain.normal_force
        for layer in (0.0, 2.0**-10)
    )
    assert np.max(np.abs(pushed - 1)) > 1e-3
    assert np.max(np.abs(left - 1)) < 1e-12


def test_a_python_without_ode_is_a_reason_with_a_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MULTIBODY_XVAL_ODE_PYTHON", sys.executable)
    reason = ODE().unavailable_reason()
    ODE().process().close()
    assert reason is not None
    assert reason.startswith("apt install python3-pyode, or let MULTIBODY_XVAL_ODE_PYTHON name a Python that has it (")
    assert reason.endswith("No module named 'ode')")


def test_the_version_is_that_of_the_library() -> None:
    assert ODE().version().startswith("0.16")


def test_a_scene_whose_worker_is_lost_does_not_begin_anew_without_a_word() -> None:
    world = ODE().scene_world(JointScene(load=2.0), SceneSetting(ODE().preset("joint", "default"), STEP))
    first, second = world.run(1)[0, 0], world.run(1)[0, 0]
    assert second == pytest.approx(3 * first)  # 2 - 1 N m on 1 kg m²: h² and 3 h²
    assert abs(first) == pytest.approx(STEP**2)
    process_of("ode", SERVER).close()
    with pytest.raises(EngineProcessError, match="lost"):
        world.run(1)
