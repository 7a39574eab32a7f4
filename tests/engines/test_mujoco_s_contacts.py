"""What MuJoCo's recipe leaves of contacts, in plain MuJoCo: pushes at an angle to a box's own sides, and soft ones."""

import math

import numpy as np
import pytest

from multibody_xval.engines.interface.scene import SceneSetting
from multibody_xval.engines.mujoco.scene import contact_model
from multibody_xval.reports.reproducers.recipe import recipe_text
from multibody_xval.scenarios.catalogue.scenes.held_boxes import HEAVY_ON_LIGHT
from multibody_xval.scenarios.catalogue.scenes.pushed_box import from_rest, way_pushed
from multibody_xval.scenarios.catalogue.scenes.scene import box_scene
from multibody_xval.scenarios.model import Config

pytestmark = pytest.mark.needs("mujoco")

STEP, SECOND, QUARTER = 0.002, 500, 125
"""[s]; steps."""

HARD = 'solimp="0.9999 0.9999"'


def model(case, *replaced: tuple[str, str]):
    """Compile a scene with the recipe, and texts of it replaced, and let it settle."""
    import mujoco

    text = contact_model(box_scene(case), SceneSetting(Config("mujoco", "contact", "recommended").preset, STEP))
    for old, new in replaced:
        assert old in text
        text = text.replace(old, new)
    own = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(own)
    mujoco.mj_step(own, data, SECOND)
    return own, data


def off(load: float, degrees: float, askew: bool) -> float:
    """Give how far a box is from where it should be, that is pushed along its sides or not, over its way [%]."""
    import mujoco

    case, half = from_rest(load, degrees if not askew else 0), math.radians(degrees) / 2
    own, data = model(case)
    forward = np.array([math.cos(2 * half), math.sin(2 * half)])
    begin = data.joint("box").qpos[:2].copy()
    data.xfrc_applied[-1, :2] = load * 0.5 * 9.81 * forward
    mujoco.mj_step(own, data, QUARTER)
    return 100 * float(np.linalg.norm((data.joint("box").qpos[:2] - begin) / way_pushed(case) - forward))


@pytest.mark.parametrize(("load", "least"), [(1.2, 5.0), (1.06, 20.0)])
def test_box_that_is_pushed_at_an_angle_to_its_own_sides_goes_astray_with_the_recipe(load, least) -> None:
    """It hops; turned with the push, it does not."""
    assert off(load, 30, askew=False) < 1
    assert off(load, 30, askew=True) > least


def test_harder_contacts_let_what_is_heavy_drift_a_hundredth_as_far() -> None:
    import mujoco

    assert HARD in recipe_text("mujoco")
    case, drifts = next(iter(HEAVY_ON_LIGHT.cases.values())), []
    forward = np.array(box_scene(case).forward)
    for replaced in ((), (("<geom ", f"<geom {HARD} "),)):
        own, data = model(case, *replaced)
        begin = data.joint("box").qpos[:3].copy()
        mujoco.mj_step(own, data, 2 * SECOND)
        drifts.append(1e6 * abs((data.joint("box").qpos[:3] - begin) @ forward) / 2)
    assert drifts[0] == pytest.approx(8.5, rel=0.02)
    assert drifts[1] < 0.02
