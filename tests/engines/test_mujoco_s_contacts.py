"""What MuJoCo's recipe leaves of contacts, in plain MuJoCo: pushes at an angle to a box's own sides, and soft ones."""

import math

import numpy as np
import pytest

from multibody_xval.engines.interface.scene import SceneSetting
from multibody_xval.engines.mujoco.probe.lines import HARD as HARD_CONTACTS
from multibody_xval.engines.mujoco.scene import contact_model
from multibody_xval.reports.reproducers.recipe import recipe_text
from multibody_xval.scenarios.cases.scene_motion import swinging
from multibody_xval.scenarios.catalogue.scenes.held_boxes import HEAVY_ON_LIGHT, SLOPE_HOLD
from multibody_xval.scenarios.catalogue.scenes.pushed_box import from_rest, way_pushed
from multibody_xval.scenarios.catalogue.scenes.scene import box_scene
from multibody_xval.scenarios.catalogue.scenes.shaken_boxes import HELD_WHILE_SHAKEN
from multibody_xval.scenarios.model import Config

pytestmark = pytest.mark.needs("mujoco")

STEP, SECOND, QUARTER = 0.002, 500, 125
"""[s]; steps."""

HARD = 'solimp="0.9999 0.9999"'

HARDER, LESS = ("<geom ", f"<geom {HARD} "), ('impratio="10000"', 'impratio="100"')
"""What harder contacts are in a model, and what goes with them."""

HARDER_ALONE = ":solimp=0.9999,0.9999"
HARDER_SAFELY = f":impratio=100{HARDER_ALONE}"
"""The same as options of a configuration."""


def model(case, *replaced: tuple[str, str]):
    """Compile a scene with the recipe, and texts of it replaced, and let it settle."""
    import mujoco

    text = contact_model(box_scene(case), SceneSetting(Config("mujoco", "contact", "recommended").preset, STEP))
    for old, new in replaced:
        assert old in text
        text = text.replace(old, new)
    own = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(own)
    advance(own, data, case, 0, SECOND)
    return own, data


def advance(own, data, case, first: int, steps: int) -> None:
    """Take steps from this one on, under the tones of the case."""
    import mujoco

    for step in range(first, first + steps):
        if case.shake:
            data.joint("shaker").qfrc_applied[0] = swinging(case.shake, step * STEP)
        mujoco.mj_step(own, data)


def off(load: float, degrees: float, askew: bool, *replaced: tuple[str, str]) -> float:
    """Give how far a box is from where it should be, that is pushed along its sides or not, over its way [%]."""
    import mujoco

    case, half = from_rest(load, degrees if not askew else 0), math.radians(degrees) / 2
    own, data = model(case, *replaced)
    forward = np.array([math.cos(2 * half), math.sin(2 * half)])
    begin = data.joint("box").qpos[:2].copy()
    data.xfrc_applied[-1, :2] = load * 0.5 * 9.81 * forward
    mujoco.mj_step(own, data, QUARTER)
    return 100 * float(np.linalg.norm((data.joint("box").qpos[:2] - begin) / way_pushed(case) - forward))


@pytest.mark.parametrize(("load", "least"), [(1.2, 5.0), (1.06, 20.0)])
def test_box_that_is_pushed_at_an_angle_to_its_own_sides_goes_astray_with_the_recipe(load, least) -> None:
    """It hops; turned with the push, or with harder contacts, it does not."""
    assert off(load, 30, askew=False) < 1
    assert off(load, 30, askew=True) > least
    assert off(load, 30, True, HARDER, LESS) < 1


def drift(case, *replaced: tuple[str, str]) -> float:
    """Give the drift of a box within two seconds, under the tones of its case [µm/s]."""
    own, data = model(case, *replaced)
    box, forward = data.joint("box"), np.array(box_scene(case).forward)
    begin = box.qpos[:3].copy()
    advance(own, data, case, SECOND, 2 * SECOND)
    return 1e6 * abs((box.qpos[:3] - begin) @ forward) / 2


def test_harder_contacts_let_what_is_heavy_drift_an_eighth_as_far() -> None:
    assert HARD in recipe_text("mujoco")
    assert LESS[1] in recipe_text("mujoco")
    case = next(iter(HEAVY_ON_LIGHT.cases.values()))
    assert drift(case) == pytest.approx(8.5, rel=0.02)
    assert drift(case, HARDER, LESS) == pytest.approx(1.1, rel=0.02)
    assert drift(case, ("<geom ", '<geom solref="0.014 1" ')) == pytest.approx(14, rel=0.05)


@pytest.mark.parametrize("name", ["slope, mass inside, 14 Hz", "level, mass inside, 120 Hz"])
def test_harder_contacts_hold_a_box_that_a_mass_inside_shakes_with_less_impratio_alone(name) -> None:
    """With that of the recipe the solver loses the contacts, and the box hops away."""
    case = HELD_WHILE_SHAKEN.cases[name]
    assert drift(case) < 0.2
    assert drift(case, HARDER, LESS) < 0.01
    assert drift(case, HARDER) > 1000


def test_own_contacts_of_a_model_that_are_hard_need_less_impratio() -> None:
    """By the first number of their solimp; `probe` names them."""
    case = HELD_WHILE_SHAKEN.cases["slope, mass inside, 14 Hz"]
    for hardness in ("0.997 0.9999", f"{HARD_CONTACTS:g} {HARD_CONTACTS:g}"):
        own = ("<geom ", f'<geom solimp="{hardness}" ')
        assert drift(case, own, LESS) < 0.2
        assert (drift(case, own) > 100) == (hardness != "0.997 0.9999")


def test_harder_contacts_that_are_springy_do_not_hold() -> None:
    case, springy = SLOPE_HOLD.cases["load 0.9"], ("<geom ", '<geom solref="-1000 -50" ')
    assert drift(case, springy) == pytest.approx(0.26, rel=0.02)
    assert drift(case, springy, HARDER, LESS) == pytest.approx(966, rel=0.02)


def test_harder_contacts_are_an_option_of_the_recipe() -> None:
    case = next(iter(HEAVY_ON_LIGHT.cases.values()))
    preset = Config.parse(f"mujoco:contact:recommended{HARDER_SAFELY}").preset
    text = contact_model(box_scene(case), SceneSetting(preset, STEP))
    assert text.count("<geom ") == text.count(HARD) == 3
    assert LESS[1] in text


def test_box_that_is_dropped_on_an_edge_sinks_in_as_deep_with_harder_contacts() -> None:
    """From half a metre, by 22 mm."""
    import mujoco

    deepest = []
    for replaced in ((), (HARDER, LESS)):
        own, data = model(SLOPE_HOLD.cases["load 0.1"], *replaced)
        mujoco.mj_resetData(own, data)
        data.joint("box").qpos[2:] += 0.5, 0.0, math.sin(0.2), 0.0, 0.0
        depth = 0.0
        for _ in range(SECOND):
            mujoco.mj_step(own, data)
            depth = max(depth, *-data.contact.dist, 0.0)
        deepest.append(1e3 * depth)
    assert min(deepest) > 10
    assert deepest[1] == pytest.approx(deepest[0], rel=0.1)


@pytest.mark.needs("mujoco-warp")
@pytest.mark.parametrize(("options", "expected"), [("", 8.8), (HARDER_SAFELY, 0.0036), (HARDER_ALONE, math.nan)])
def test_single_precision_needs_less_impratio_with_harder_contacts_in_every_scene(
    options: str, expected: float
) -> None:
    from multibody_xval.engines.mujoco_warp.scene import contacts

    scene = box_scene(next(iter(HEAVY_ON_LIGHT.cases.values())))
    preset = Config.parse(f"mujoco-warp:contact:recommended{options}").preset
    rows = contacts(scene, SceneSetting(preset, STEP)).run(3 * SECOND)[:, :3]
    creep = 1e6 * abs((rows[-1] - rows[SECOND - 1]) @ np.array(scene.forward)) / 2
    assert creep == pytest.approx(expected, rel=0.05, nan_ok=True)
