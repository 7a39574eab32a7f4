"""ODE: its contacts and its scenes, and where its Python binding misleads."""

import numpy as np
import pytest

from multibody_xval.engines.interface.scene import JointScene, SceneSetting
from multibody_xval.engines.isolated.out_of_process import process_of
from multibody_xval.engines.isolated.process import EngineProcessError
from multibody_xval.engines.ode import ODE
from multibody_xval.engines.ode.scene import SERVER, STEP
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import lane_of, random_state, run

pytestmark = pytest.mark.needs("ode")


@pytest.mark.parametrize("mode", [0x004, 0x1000])
def test_in_a_contact_mu_is_a_force_unless_the_mode_says_otherwise(mode: int) -> None:
    """`ContactBounce` takes mu = 0.5 for half a newton; so does `ContactApprox1_1`, for slip is along direction 2."""
    lane = lane_of(0.3)
    assert lane.chain.friction_bound == pytest.approx(3.0)
    motion = run("ode:contact", lane, random_state(), 50, units="SI", mode=mode)
    assert np.max(np.abs(motion.friction)) == pytest.approx(0.5, rel=1e-6)
    assert np.max(motion.normal_force) == pytest.approx(6.0, rel=1e-6)


@pytest.mark.parametrize(("layer", "pushed"), [(0.0, True), (2.0**-10, False)])
def test_a_contact_outside_the_surface_layer_is_pushed_out(layer: float, pushed: bool) -> None:
    lane = lane_of()
    motion = run("ode:contact", lane, State.at_rest(1, 7), 5, surface_layer=layer)
    most = np.max(np.abs(motion.normal_force / lane.chain.normal_force - 1))
    assert most > 1e-3 if pushed else most < 1e-12


def test_a_scene_whose_worker_is_lost_does_not_begin_anew_without_a_word() -> None:
    world = ODE().scene_world(JointScene(load=2.0), SceneSetting(ODE().preset("joint", "default"), STEP))
    first, second = world.run(1)[0, 0], world.run(1)[0, 0]
    assert second == pytest.approx(3 * first)  # 2 - 1 N m on 1 kg m²: h² and 3 h²
    assert abs(first) == pytest.approx(STEP**2)
    process_of("ode", SERVER).close()
    with pytest.raises(EngineProcessError, match="lost"):
        world.run(1)
