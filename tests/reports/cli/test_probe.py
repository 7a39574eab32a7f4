"""``multibody-xval probe``: creep in a model of one's own."""

import json
from pathlib import Path

import pytest

from multibody_xval.engines.interface.scene import JointScene, SceneSetting
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.mujoco.presets import JOINT_DEFAULT, JOINT_RECOMMENDED
from multibody_xval.engines.mujoco.scene import contact_model, joint_model
from multibody_xval.reports.cli.probe import app
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.scenes.hold import on_slope
from multibody_xval.scenarios.runs.store import opened_store
from reference_lcp.process import run_command
from tests.scenarios.in_process import evaluator

pytestmark = pytest.mark.needs("mujoco")

STEP = 0.002

STEADY = 1e-3
"""Relative: velocities at the beginnings of steps against those at their ends, and what still settles."""

MASS = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
FREE = '<body pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1" {friction}/></body>'


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


@pytest.mark.slow
def test_box_on_a_slope_creeps_as_in_the_scene_as_it_is_and_with_the_recipe(capsys, tmp_path) -> None:
    file = tmp_path / "slope.xml"
    file.write_text(contact_model(on_slope(0.5), SceneSetting(Variant("mujoco", "contact", "default").preset, STEP)))
    (box,) = measured(capsys, file)["held"]
    assert box["load"] == pytest.approx(0.5, rel=1e-2)
    assert box["law"] == {}
    scenario = CATALOGUE["slope-hold"]
    for preset, line in (("default", "as it is"), ("recommended", "all")):
        with opened_store(None) as store, evaluator(store) as running:
            findings = scenario.judged([Variant("mujoco", "contact", preset)], scenario.cases[1:2], running)
        assert box["creep"][line] == pytest.approx(findings[0].value, rel=STEADY)


@pytest.mark.parametrize("preset", [JOINT_DEFAULT, JOINT_RECOMMENDED])
def test_hinge_under_its_own_weight_creeps_as_the_law_of_its_friction_predicts(capsys, tmp_path, preset) -> None:
    text = joint_model(JointScene(friction=6.0), SceneSetting(preset, STEP))
    weight = '<inertial pos="0.5 0 0"'
    file = tmp_path / "hinge.xml"
    file.write_text(text.replace('<inertial pos="0 0 0"', weight).replace('axis="0 0 1"', 'axis="0 1 0" name="elbow"')
                    .replace('gravity="0 0 -0.0"', 'gravity="0 0 -9.81"'))  # fmt: skip
    (hinge,) = measured(capsys, file, "--time", "0.5")["held"]
    assert (hinge["name"], hinge["unit"]) == ("joint elbow", "µrad/s")
    assert hinge["load"] == pytest.approx(0.5 * 9.81 / 6, rel=1e-2)
    assert hinge["law"].keys() == hinge["creep"].keys()
    for line, creep in hinge["creep"].items():
        assert creep == pytest.approx(hinge["law"][line], rel=STEADY)
    assert hinge["creep"]["all"] < 20


def test_what_slides_is_left_out_beside_what_is_held(capsys, tmp_path) -> None:
    slide = '<body name="{0}"><joint name="{0}" axis="0 0 1" type="slide" frictionloss="{1}"/>{2}</body>'
    file = model(tmp_path, slide.format("falls", 9, MASS) + slide.format("hangs", 11, MASS))
    found = measured(capsys, file, "--time", "0.1")
    assert [each["name"] for each in found["held"]] == ["joint hangs"]
    assert found["cost"]["as it is"] == 1
    assert all(0 < cost < 100 for cost in found["cost"].values())


def test_tables_name_bodies_and_the_lines_of_the_recipe(capsys, tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    plane = '<geom name="floor" type="plane" size="1 1 1"/>'
    assert run_command(app, [str(model(tmp_path, plane + FREE.format(friction=""))), "--time", "0.1"]) == 0
    printed = capsys.readouterr().out
    assert "floor / geom 1 of body 1" in printed
    assert 'cone="elliptic"' in printed


EXPLODES = '<body><joint type="slide" stiffness="1e12"/><inertial pos="0 0 0" mass="1e-6" diaginertia="1 1 1"/></body>'
SMOOTH = '<geom type="plane" size="1 1 1" condim="1"/>' + FREE.format(friction='condim="1"')
FALLS = f'<body><joint axis="0 0 1" type="slide" frictionloss="9"/>{MASS}</body>'


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (EXPLODES.replace("/><inertial", ' ref="1"/><inertial'), "explodes after"),
        ('<body><joint/><geom size="1"/></body>', "has no friction"),
        (SMOOTH, "has no friction"),
        (FALLS, "does not rest"),
        ("<sphere/>", "does not load: XML Error: Schema violation"),
    ],
)
def test_model_in_which_there_is_nothing_to_hold_is_refused_in_one_line(
    capsys, tmp_path, monkeypatch, body, message
) -> None:
    file = model(tmp_path, body)
    monkeypatch.chdir(tmp_path)
    assert run_command(app, [str(file), "--time", "0.1"]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert message in printed.err
    assert printed.err.startswith("error: MODEL = ")
    assert printed.err.count("\n") == 1
    assert [each.name for each in tmp_path.iterdir()] == ["model.xml"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.xml"], "MODEL = 'none.xml' does not load"),
        (["none.xml", "--time", "0"], "time = 0 is outside its range; allowed: > 0"),
        (["none.xml", "--time", "nan"], "time = nan"),
        (["none.xml", "--settling", "-1"], "settling = -1 is outside its range; allowed: >= 0"),
    ],
)
def test_wrong_input_is_one_line(capsys, tmp_path, monkeypatch, arguments, message) -> None:
    monkeypatch.chdir(tmp_path)
    assert run_command(app, arguments) == 2
    printed = capsys.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
