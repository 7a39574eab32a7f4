"""What a probe says in its last line, and what it prints."""

import math
from dataclasses import replace

import pytest

from multibody_xval.engines.mujoco.probe import Held, Probe
from multibody_xval.engines.mujoco.probe.lines import AS_IT_IS, RECIPE
from multibody_xval.engines.mujoco.probe.slides import Slide
from multibody_xval.engines.mujoco.probe.stops import Stop
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.probe import app
from multibody_xval.reports.cli.probe_finding import finding
from multibody_xval.reports.cli.shown import cost_line

pytestmark = pytest.mark.needs("mujoco")


def found(*drifts: tuple[float, float], cost: float = 1.0) -> Probe:
    """Give what was measured of pairs that drift as it is and with the recipe, in millionths."""
    held = [
        Held(
            f"box {n}",
            unit,
            0.5,
            {AS_IT_IS: True, RECIPE: True},
            {AS_IT_IS: 1e-6 * own, RECIPE: 1e-6 * recipe},
            {},
            {},
        )
        for n, ((own, recipe), unit) in enumerate(zip(drifts, ("µm/s", "µrad/s"), strict=False))
    ]
    return Probe({AS_IT_IS: 1.0, RECIPE: cost}, tuple(held), (), {}, (), (), {}, 1000, ())


@pytest.mark.parametrize(
    ("drifts", "text"),
    [
        ([(3679, 0.18)], "The recipe helps: 3,679 → 0.18 µm/s."),
        ([(math.inf, 0.18)], "The recipe helps: not held → 0.18 µm/s."),
        (
            [(0.002, 41)],
            "Leave the model as it is: nothing drifts (< 0.01 µm/s), and the recipe makes it worse (41 µm/s).",
        ),
        ([(5, math.inf)], "Leave the model as it is: the recipe makes it worse: 5 µm/s → not held."),
        ([(0.002, 0.9)], "Nothing drifts noticeably, with or without the recipe: < 0.01 → 0.9 µm/s."),
        ([(100, 95)], "The recipe changes little: 100 → 95 µm/s."),
        ([(100, 0.1), (5, 90)], "The recipe helps some and makes others worse: 100 → 0.1 µm/s; 5 → 90 µrad/s."),
        ([(100, 0.1), (0, 0)], "The recipe helps: 100 → 0.1 µm/s; < 0.01 → < 0.01 µrad/s."),
        ([(math.nan, 5)], "What touches at times only is not compared: – → 5 µm/s."),
    ],
)  # fmt: skip
def test_last_line_says_whether_the_recipe_helps(drifts, text) -> None:
    assert finding(found(*drifts)) == text


@pytest.mark.parametrize(
    ("exact", "own", "recipe", "text"),
    [
        (
            0.216,
            0.262,
            0.218,
            "The recipe helps: time until friction stops joint h: 0.262 s → 0.218 s (exact: 0.216 s).",
        ),
        (0.216, 0.22, 0.1, "The recipe harms: time until friction stops joint h: 0.22 s → 0.1 s (exact: 0.216 s)."),
        (math.nan, 1.0, 1.0, "The recipe changes little: time until friction stops joint h: 1 s → 1 s."),
        (math.nan, math.inf, 1.0, "The recipe helps: time until friction stops joint h: never → 1 s."),
    ],
)
def test_last_line_says_whether_the_recipe_stops_a_joint_in_time(exact, own, recipe, text) -> None:
    stop = Stop("joint h", exact, {AS_IT_IS: own, RECIPE: recipe})
    assert finding(replace(found(), stops=(stop,))) == text


def test_recipe_with_which_a_model_explodes_is_not_recommended() -> None:
    assert finding(found((100, math.nan), cost=math.nan)).startswith("Leave the model as it is")


def test_overloaded_friction_is_told_apart_from_friction_that_nothing_loads() -> None:
    slide = Slide("µm/s", 1.02, 1.1, 0.0121)
    for lines, words in (((AS_IT_IS, RECIPE), "with the recipe too"), ((AS_IT_IS,), "as it is")):
        text = finding(replace(found(), slides={"finger / cup": dict.fromkeys(lines, slide)}))
        assert text.startswith(f"Nothing was judged: all that is loaded slides, {words}. Its load is above")


@pytest.mark.parametrize(
    ("cost", "text"), [(1.4, ""), (0.7, ""), (2.0, "A step takes 2 times as long with the recipe.")]
)
def test_cost_is_printed_where_it_is_more_than_other_programs_make(cost, text) -> None:
    assert cost_line(cost) == text


def printed(capsys: pytest.CaptureFixture[str], tmp_path, text: str) -> list[str]:
    (tmp_path / "model.xml").write_text(f"<mujoco>{text}</mujoco>", encoding="utf-8")
    assert run_command(app, [str(tmp_path / "model.xml")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    return lines


def test_joint_that_gives_way_until_its_servo_carries_it_is_held_with_the_recipe_alone(capsys, tmp_path) -> None:
    """Friction of 60 N m would hold 3 N m at once: as it is the servo has the load after a second, and all is still."""
    arm = (
        '<worldbody><body><joint name="elbow" axis="0 1 0" frictionloss="60"/>'
        '<geom name="link" type="capsule" size=".03" fromto="0 0 0 .3 0 0" mass="2" contype="0"/></body></worldbody>'
        '<actuator><position joint="elbow" kp="1500"/></actuator><keyframe><key qpos="0"/></keyframe>'
    )
    *lines, last = printed(capsys, tmp_path, arm)
    assert last == "To write it: multibody-xval recipe mujoco --no-run"
    assert not any("cone=" in line for line in lines), "nothing touches"
    last = " ".join(line.strip() for line in lines[-3:])
    assert "The recipe helps: before it is watched, joint elbow moves by" in last
    assert "as it is, until something else carries its load" in last


def test_lines_are_not_tried_where_nothing_loads_friction(capsys, tmp_path) -> None:
    box = (
        '<worldbody><geom name="floor" type="plane" size="1 1 1"/>'
        '<body pos="0 0 .1"><freejoint/><geom name="box" type="box" size=".1 .1 .1"/></body></worldbody>'
    )
    lines = printed(capsys, tmp_path, box)
    assert "Not tested, since less than 0.001 of the friction is used: floor / box." in lines
    assert "Nothing was tested: nothing loads the friction of this model. Ways to load it: tilt gravity" in " ".join(
        lines
    )
    assert "--ctrl" not in " ".join(lines), "the model has no actuators"
    assert not any("cone=" in line for line in lines)
