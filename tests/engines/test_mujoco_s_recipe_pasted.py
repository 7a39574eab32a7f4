"""What MuJoCo's recipe says to write is pasted into models of users: all of its lines, and each alternative."""

import re

import numpy as np
import pandas as pd
import pytest

from multibody_xval.reports.reproducers.recipe import recipe_text
from tests.programs import DOCS, program

pytestmark = pytest.mark.needs("mujoco")

SECOND = 500
"""Steps of 2 ms."""

UNSEEN = 1.0
"""A drift below it is not noticeable, as the page says [µm/s]."""

FLOOR, TABLE = '<geom type="plane" size="2 2 .1"/>', '<geom name="table" type="box" size=".4 .4 .2" pos="0 0 .2"/>'

CUBE = '<body name="cube" pos="0 0 .43"><freejoint/><geom type="box" size=".03 .03 .03" mass=".2"/></body>'

LATCH = """<body pos="0 0 2"><joint class="latch" axis="0 0 1"/>
<inertial pos="0 0 0" mass="1" diaginertia=".1 .1 .1"/></body>"""
"""A hinge whose friction is that of a class."""

WITH_FLOOR, ALONE, APART = FLOOR + TABLE, TABLE, f"{FLOOR}<body>{TABLE}</body>"
"""Where the floor and the table are: in one body, the world, or not."""

pasted = program("scenes/pushed_boxes").pasted


def compiled(lines: str, ground: str = WITH_FLOOR):
    """Compile a model of a user, with lines pasted at its beginning; gives it with its data."""
    import mujoco

    own = mujoco.MjModel.from_xml_string(
        f'<mujoco>{lines}<option timestep="0.002" integrator="implicitfast"/><default>'
        '<geom friction="0.8 0.005 0.0001"/><default class="latch"><joint frictionloss="5"/></default></default>'
        f"<worldbody>{ground}{CUBE}{LATCH}</worldbody></mujoco>"
    )
    return own, mujoco.MjData(own)


def pushed(lines: str, ground: str = WITH_FLOOR) -> tuple[float, float, int]:
    """Push a cube with 0.9 μ m g: its drift [µm/s] and rise [µm] in a second, and steps without a contact."""
    import mujoco

    own, data = compiled(lines, ground)
    mujoco.mj_step(own, data, SECOND)
    data.body("cube").xfrc_applied[0] = 0.9 * 0.8 * 0.2 * 9.81
    mujoco.mj_step(own, data, SECOND)
    begin, heights, flying = data.body("cube").xpos[0], [], 0
    for _ in range(SECOND):
        mujoco.mj_step(own, data)
        heights.append(data.body("cube").xpos[2])
        flying += data.ncon == 0
    return 1e6 * (data.body("cube").xpos[0] - begin), 1e6 * float(np.ptp(heights)), flying


def test_all_lines_reach_a_model_with_an_option_element_and_classes_of_its_own() -> None:
    own, _ = compiled(pasted())
    assert (own.opt.tolerance, own.opt.iterations, own.opt.ls_iterations) == (1e-14, 100, 50)
    assert (own.opt.cone, own.opt.impratio, own.opt.integrator) == (1, 10000, 3)
    assert own.dof_solref[-1].tolist() == [0.004, 1]
    assert own.dof_solimp[-1, :2].tolist() == [0.9999, 0.9999]
    assert (own.geom_solref == [0.02, 1]).all()


@pytest.mark.parametrize("ground", [WITH_FLOOR, ALONE, APART])
@pytest.mark.parametrize("alternative", ["", "solref=", "midphase"])
def test_cube_that_is_pushed_on_a_table_neither_creeps_nor_leaves_it(alternative: str, ground: str) -> None:
    drift, rise, flying = pushed(pasted(alternative), ground)
    assert abs(drift) < UNSEEN
    assert rise < 0.01
    assert flying == 0


def test_harder_contacts_need_each_of_their_lines() -> None:
    """With the midphase a cube leaves a table that is in one body with the floor, and creeps."""
    harder = pasted("midphase")
    without = harder.replace('<flag midphase="disable"/>', "")
    assert without != harder
    drift, rise, flying = pushed(without)
    assert drift == pytest.approx(565, rel=0.02)
    assert rise > 100
    assert flying > 0
    assert "565 µm/s" in recipe_text("mujoco")
    assert abs(pushed(without, ALONE)[0]) < UNSEEN
    assert abs(pushed(without, APART)[0]) < UNSEEN


@pytest.mark.parametrize(("ground", "contacts"), [(WITH_FLOOR, 0), (ALONE, 4), (APART, 4)])
def test_midphase_loses_contacts_that_are_a_tenth_of_a_micrometre_deep(ground: str, contacts: int) -> None:
    """The box around floor and table is 10 million km high: the upper end of it is rounded to 1 µm."""
    import mujoco

    own, data = compiled("", ground)
    data.joint(0).qpos[2] -= 1e-7
    mujoco.mj_forward(own, data)
    assert data.ncon == contacts
    own.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_MIDPHASE
    mujoco.mj_forward(own, data)
    assert data.ncon == 4


@pytest.mark.parametrize(
    ("lines", "depth"), [("", 57), ('<option cone="elliptic"/>', 108), (pasted(), 108), (pasted("solref="), 53)]
)
def test_depth_of_a_cube_in_a_table(lines: str, depth: float) -> None:
    """The elliptic cone alone makes contacts softer [µm]."""
    import mujoco

    own, data = compiled(lines)
    mujoco.mj_step(own, data, 2 * SECOND)
    assert -1e6 * data.contact.dist.min() == pytest.approx(depth, abs=0.5)
    assert f" {depth}" in recipe_text("mujoco")


def test_cup_between_fingers_sinks_in_as_deep_as_by_default_with_the_alternative() -> None:
    """A weight of 3 N between two fingers that press with 5 N: depth [µm], drift [µm/s]."""
    import mujoco

    finger = '<geom type="box" size=".015 .006 .04" mass=".08"/>'
    slide = '<joint type="slide" axis="0 {} 0" damping="5" armature="0.01"/>'
    ground = (
        "".join(
            f'<body name="{name}" pos="0 {side * 0.044} 1">{slide.format(-side)}{finger}</body>'
            for name, side in (("left", 1), ("right", -1))
        )
        + '<body name="cup" pos="0 0 1"><freejoint/><geom type="box" size=".02 .038 .03" mass=".3"/></body>'
    )
    found = {}
    for name, lines in {"default": "", "recipe": pasted(), "alternative": pasted("solref=")}.items():
        own, data = compiled(lines, ground)
        for body in ("left", "right"):
            data.joint(own.body(body).jntadr[0]).qfrc_applied[0] = 5
        mujoco.mj_step(own, data, 2 * SECOND)
        begin, depth = data.body("cup").xpos[2], -1e6 * data.contact.dist.min()
        mujoco.mj_step(own, data, SECOND)
        found[name] = (depth, 1e6 * (begin - data.body("cup").xpos[2]))
    depths, drifts = ({name: own[part] for name, own in found.items()} for part in (0, 1))
    assert depths == pytest.approx({"default": 383, "recipe": 567, "alternative": 364}, abs=0.5)
    words = re.findall(r"\d+", recipe_text("mujoco"))
    assert all(f"{depth:.0f}" in words for depth in depths.values())
    assert drifts["alternative"] < drifts["recipe"] < UNSEEN < 1000 < drifts["default"]


def test_joint_with_damping_stops_sooner_with_the_line_for_it() -> None:
    import mujoco

    attribute = 'solreffriction="-1000 -1000"'
    assert f"`{attribute}`" in recipe_text("mujoco")
    times = []
    for own_lines in (pasted(), f"{pasted()}<default><joint {attribute}/></default>"):
        own, data = compiled(own_lines)
        own.dof_damping[-1] = 50
        data.qvel[-1] = 20
        while abs(data.qvel[-1]) > 1e-3:
            mujoco.mj_step(own, data)
        times.append(1e3 * data.time)
    assert times == pytest.approx([30, 16], abs=2)


WORST = [("6 × 6 × 6", 0.5, "centre"), ("6 × 6 × 6", 0.8, "centre"), ("20 × 20 × 10", 0.8, "centre")]


@pytest.mark.parametrize("own", WORST)
def test_table_of_boxes_that_are_pushed_at_an_angle_is_what_its_program_measures(own: tuple[str, float, str]) -> None:
    table = pd.read_csv(DOCS / "scenes" / "pushed_boxes.csv").set_index(["box [cm]", "μ", "pushed at its"])
    measured = pd.Series(program("scenes/pushed_boxes").row(*own)).iloc[3:].astype(float)
    assert measured.to_numpy() == pytest.approx(table.loc[own].astype(float).to_numpy(), rel=0.1)
    worst = measured["recipe, at 15 to 45° [%]"]
    assert re.search(rf"\b{worst:.0f} %|by up to {worst:.0f}\b|or {worst:.0f} %", recipe_text("mujoco"))
