"""``multibody-xval probe``: drift in a user's own model."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from multibody_xval.engines.interface.scene import JointScene, SceneSetting
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.mujoco.scene import contact_model, joint_model
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.probe import app
from multibody_xval.scenarios.catalogue.scenes.held_boxes import SLOPE_HOLD, on_slope
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import Config

pytestmark = pytest.mark.needs("mujoco")

MODELS = Path(__file__).with_name("probe_models")

STEP = 0.002

RECIPE = "recipe (all lines)"

STEADY = 1e-3
"""Relative: velocities at the beginnings of steps against those at their ends, and what still settles."""


def model(folder: Path, body: str) -> Path:
    """Write a model with gravity."""
    file = folder / "model.xml"
    file.write_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>", encoding="utf-8")
    return file


def measured(capsys: pytest.CaptureFixture[str], file: Path, *options: str) -> dict:
    before = file.read_bytes()
    assert run_command(app, [str(file), "--json", *options]) == 0
    assert file.read_bytes() == before
    return json.loads(capsys.readouterr().out)


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Give the one line with which a command line is refused."""
    assert run_command(app, list(arguments)) == 2
    out, error = capsys.readouterr()
    assert (out, error.count("\n")) == ("", 1)
    return error


@pytest.mark.slow
def test_box_on_a_slope_creeps_as_in_the_scene_as_it_is_and_with_the_recipe(capsys, tmp_path) -> None:
    file = tmp_path / "slope.xml"
    file.write_text(contact_model(on_slope(0.5), SceneSetting(Variant("mujoco", "contact", "default").preset, STEP)))
    (box,) = measured(capsys, file)["held"]
    assert box["load"] == pytest.approx(0.5, rel=1e-2)
    assert box["predicted"] == {}
    for preset, line in (("default", "as it is"), ("recommended", RECIPE)):
        run = SLOPE_HOLD.own_runs(Config("mujoco", "contact", preset))["load 0.5, own step"]
        drift = SLOPE_HOLD.quantities[0].read(run_batch([run])[0], run)
        assert box["drift"][line] == pytest.approx(drift, rel=STEADY)


@pytest.mark.parametrize("preset", ["default", "recommended"])
def test_hinge_under_its_own_weight_creeps_as_the_law_of_its_friction_predicts(capsys, tmp_path, preset) -> None:
    text = joint_model(JointScene(friction=6.0), SceneSetting(Variant("mujoco", "joint", preset).preset, STEP))
    text = text.replace('axis="0 0 1"', 'axis="0 1 0" name="elbow"').replace(
        'gravity="0 0 -0.0"', 'gravity="0 0 -9.81"'
    )
    file = tmp_path / "hinge.xml"
    file.write_text(text.replace('<inertial pos="0 0 0"', '<inertial pos="0.5 0 0"'))
    (hinge,) = measured(capsys, file, "--time", "0.5")["held"]
    assert (hinge["name"], hinge["unit"]) == ("joint elbow", "µrad/s")
    assert hinge["load"] == pytest.approx(0.5 * 9.81 / 6, rel=1e-2)
    assert hinge["drift"] == pytest.approx(hinge["predicted"], rel=STEADY)
    assert hinge["drift"][RECIPE] < 20


def test_first_keyframe_is_watched_with_its_controls(capsys) -> None:
    found = measured(capsys, MODELS / "grip.xml", "--time", "1")
    creeps = {each["name"]: each["drift"] for each in found["held"]}
    fingers = {"left / cube": 3679, "right / cube": 3679}
    assert {name: creep["as it is"] for name, creep in creeps.items()} == pytest.approx(fingers, rel=STEADY)
    assert all(creep[RECIPE] < 1 for creep in creeps.values())
    assert [each["load"] for each in found["held"]] == pytest.approx([0.0564, 0.0564], rel=1e-2)
    assert found["notes"][0].startswith("Start: keyframe ")


def test_cube_that_fingers_do_not_hold_slides_from_the_start_until_it_is_out(capsys, tmp_path) -> None:
    """Fingers of 0.4 N each hold 0.8 N at a coefficient of 1, and the cube weighs 0.98 N."""
    file = tmp_path / "weak.xml"
    file.write_text((MODELS / "grip.xml").read_text().replace('ctrl=".035 .035"', 'ctrl=".0254 .0254"'))
    found = measured(capsys, file, "--time", "0.2")
    assert set(found["slides"][0]["since"]) == {"as it is", RECIPE}
    for each in found["slides"]:
        assert each["name"] in ("left / cube", "right / cube")
        assert each["apart"] == {"as it is": True, RECIPE: True}
        assert all(10 < way < 50 for way in each["way"].values()), "the fingers are 40 mm high, and so is the cube"
    assert len(found["slides"]) == 2
    assert found["finding"].startswith("Nothing was judged: all that is loaded slides, with the recipe too.")


def test_way_of_a_joint_whose_load_is_above_its_friction_is_that_of_constant_acceleration(capsys, tmp_path) -> None:
    """2 kg against 10 N: 4.81 m/s², from the start on and while it is watched."""
    slider = '<joint name="s" type="slide" axis="0 0 -1" frictionloss="10"/><geom size=".1" mass="2" contype="0"/>'
    file = model(tmp_path, f"<body>{slider}</body>")
    (slide,) = measured(capsys, file, "--time", "0.2", "--settling", "0.1")["slides"]
    assert slide["since"]["as it is"] <= 2 * STEP
    assert slide["way"]["as it is"] == pytest.approx(1e3 * 0.5 * (9.81 - 5) * 0.3**2, rel=0.02)
    assert slide["unit"] == "mm"


def test_controls_hold_from_row_to_row_and_to_the_end(capsys, tmp_path) -> None:
    """A push of 4 N in the last row loads the bound of 5.4 N of 1.1 kg by 0.74."""
    file, ctrl = tmp_path / "push.xml", tmp_path / "ctrl.csv"
    text = (MODELS / "shaker.xml").read_text().replace("0.0001", "0.002")
    text = text.replace('joint="s"', 'site="s" gear="1 0 0 0 0 0"')
    file.write_text(text.replace("<freejoint/>", '<freejoint/><site name="s"/>'))
    ctrl.write_text("time,drive\n0,1\n0.1,4\n")
    found = measured(capsys, file, "--ctrl", str(ctrl), "--time", "0.2", "--settling", "0.5")
    assert found["held"][0]["load"] == pytest.approx(4 / (0.5 * 1.1 * 9.81), rel=0.02)
    assert "The last row, at 0.1 s, holds until the end." in found["notes"]


def test_urdf_that_does_not_load_is_told_the_line_of_the_compiler(capsys, tmp_path) -> None:
    file = tmp_path / "cart.urdf"
    file.write_text((MODELS / "cart.urdf").read_text().replace('ixx=".001"', 'ixx=".1"'))
    line = re.search("with (<mujoco>.*</mujoco>)", refused(capsys, str(file)))[1]
    assert 'balanceinertia="true"' in line
    file.write_text(file.read_text().replace("</robot>", f"{line}</robot>"))
    assert measured(capsys, file, "--time", "0.1")["not_loaded"] == ["joint jl", "joint jr"]
    notes = " ".join(measured(capsys, file, "--time", "0.1")["notes"])
    assert "--free" in notes, "a URDF is welded"


def test_bodies_that_overlap_at_the_start_are_no_creep(capsys, tmp_path) -> None:
    """A pendulum whose bob is 151 mm inside a fixed box."""
    bob = '<joint name="swing" axis="0 1 0" frictionloss="1"/><geom name="bob" pos="0 0 -.5" size=".2"/>'
    wall = '<geom name="wall" type="box" size=".1 1 1" pos=".149 0 .5"/>'
    found = measured(capsys, model(tmp_path, f'<body pos="0 0 1">{bob}</body>{wall}'), "--time", "0.1")
    assert "Bodies overlap by 151 mm at the start: wall / bob." in found["notes"]
    assert found["held"] == []
    assert found["finding"].startswith("Nothing was tested: nothing else has friction.")


def test_model_with_few_iterations_gets_those_that_the_recipe_needs(capsys, tmp_path) -> None:
    file = tmp_path / "pasted.xml"
    pasted = 'iterations="4" noslip_iterations="3" cone="elliptic" impratio="10000"'
    file.write_text((MODELS / "stack20.xml").read_text().replace('iterations="20"', pasted, 1))
    found = measured(capsys, file, "--time", "0.5")
    assert found["unfinished"]["as it is"] > 10
    assert found["unfinished"][RECIPE] == 0
    assert max(each["drift"][RECIPE] for each in found["held"]) <= 0.2


def test_time_in_which_friction_stops_a_joint_is_given_by_line_beside_the_exact_one(capsys, tmp_path) -> None:
    """I / c ln(1 + c ω / T) of a cylinder of 50 mm, 0.2 m and 1000 kg/m³ that is thrown with 20 rad/s."""
    inertia = 0.5 * 1000 * np.pi * 0.05**2 * 0.2 * 0.05**2
    (spin,) = measured(capsys, MODELS / "spin.xml")["stops"]
    assert spin["exact"] == pytest.approx(inertia / 0.02 * np.log(1 + 0.02 * 20 / 0.05), rel=1e-6)
    assert spin["time"][RECIPE] == pytest.approx(spin["exact"], abs=2 * STEP)
    found = measured(capsys, MODELS / "spin_noslip.xml")
    times, expected = found["stops"][0]["time"], {"as it is": 2.274, 'noslip_iterations="0"': 0.092, RECIPE: 0.004}
    assert {line: times[line] for line in expected} == pytest.approx(expected)
    assert list(times)[-2:] == ['recipe but noslip_iterations="0"', RECIPE]
    late, sweeps = found["notes"][1:]
    assert 'with "0.004 1" it would stop later than as it is' in late
    assert sweeps == 'noslip_iterations="10" stops joint h later: write noslip_iterations="0".'
    given = re.search('Give it (solreffriction="[^"]*")', late)[1]
    file = tmp_path / "pasted.xml"
    file.write_text((MODELS / "spin_noslip.xml").read_text().replace('damping="50"', f'damping="50" {given}'))
    pasted = measured(capsys, file)
    assert (pasted["notes"][1:], pasted["stops"][0]["time"]["as it is"]) == ([], pytest.approx(0.006))


@pytest.mark.parametrize("damping", [0.02, 0.9, 7.8, 12.0])
def test_line_for_joints_with_damping_is_given_where_it_stops_them_sooner(capsys, tmp_path, damping) -> None:
    """And that the one of joints without damping is worse than none is said where it is."""
    text = (MODELS / "spin.xml").read_text().replace('damping="0.02"', f'damping="{damping}"')
    recipe = text.replace("damping=", 'solreffriction="0.004 1" solimpfriction="0.9999 0.9999" damping=')
    found = []
    for own in (text, recipe):
        (tmp_path / "spin.xml").write_text(own)
        found.append(measured(capsys, tmp_path / "spin.xml", "--time", "1"))
    notes, (times, undamped) = " ".join(found[0]["notes"]), (own["stops"][0]["time"] for own in found)
    assert ("solreffriction" in notes) == (times[RECIPE] < undamped["as it is"] - STEP) == (damping > 0.5)
    assert ("later than as it is" in notes) == (undamped["as it is"] > times["as it is"])
    assert "later than as it is" not in " ".join(found[1]["notes"])


@pytest.mark.parametrize(("hardness", "count"), [("0.997 0.9999", 0), ("0.998 0.998", 1)])
def test_contacts_that_are_too_hard_for_the_recipe_are_named(capsys, tmp_path, hardness, count) -> None:
    """`tests/engines/test_mujoco_s_contacts.py` has what they do."""
    box = f'<body pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1" solimp="{hardness}"/></body>'
    notes = measured(capsys, model(tmp_path, '<geom type="plane" size="1 1 1"/>' + box), "--time", "0.1")["notes"]
    assert sum(note.startswith("Contacts have a solimp of 0.998") for note in notes) == count


EXPLODES = (
    '<body><joint type="slide" stiffness="1e12" ref="1"/><inertial pos="0 0 0" mass="1e-6" diaginertia="1 1 1"/></body>'
)
SMOOTH = (
    '<geom type="plane" size="1 1 1" condim="1"/>'
    '<body pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1" condim="1"/></body>'
)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (EXPLODES, "explodes after"),
        (SMOOTH, "has no friction to test"),
        ("<sphere/>", "does not load: XML Error: Schema violation"),
    ],
)
def test_model_in_which_there_is_nothing_to_hold_is_refused_in_one_line(capsys, tmp_path, body, message) -> None:
    assert message in refused(capsys, str(model(tmp_path, body)), "--time", "0.1")
    assert [each.name for each in tmp_path.iterdir()] == ["model.xml"]
