"""Scripts of scenes: they need the engine alone, and print the number that the suite has."""

import pytest

from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.variant import GENERAL
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.reproduce import app
from multibody_xval.reports.reproducers.scene_script import (
    ON_A_PLANE,
    SCENES,
    checked_scene,
    has_scene_script,
    scene_script,
)
from multibody_xval.reports.reproducers.script import LONGEST_LINE
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.model import Config
from tests.reports.reproducers.test_reproducers import (
    DIGITS,
    MEANS,
    MOST_LINES,
    NUMBER,
    printed_one_by_one,
)

FORMULATIONS = {name: "joint" if name in ("joint-hold", "arm-hold") else "contact" for name in SCENES}

WRITTEN = [
    (f"{name}:{FORMULATIONS[scenario]}:{preset}", scenario)
    for name in engine_names()
    for scenario in SCENES
    if has_scene_script(name, scenario)
    for preset in GENERAL
]


def own_number(name: str, scenario: str) -> tuple[str, float]:
    """Give a script, and the suite's number."""
    reason = engine(name.partition(":")[0]).unavailable_reason()
    if reason is not None:
        pytest.skip(reason)
    shown = checked_scene(name, scenario)
    number = shown.number(MEANS)
    return scene_script(shown, number), number.value


def check_number(name: str, scenario: str, folder, changed=("", "")) -> None:
    text, value = own_number(name, scenario)
    assert changed[0] in text
    (printed,) = printed_one_by_one([text.replace(*changed)], folder, Config.parse(name))
    assert printed == pytest.approx(value, rel=DIGITS, abs=0)


@pytest.mark.parametrize("preset", GENERAL)
@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_script_alone_prints_the_drift_that_the_suite_has(name, preset, tmp_path) -> None:
    check_number(f"{name}:contact:{preset}", "slope-hold", tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("formulation", dict.fromkeys(name.rpartition(":")[0] for name, _ in WRITTEN))
def test_scripts_alone_print_the_numbers_that_the_suite_has(formulation, tmp_path) -> None:
    """Those of all presets and scenes, one after the other."""
    own = {place: own_number(*place) for place in WRITTEN if place[0].startswith(f"{formulation}:")}
    config = Config.parse(next(iter(own))[0])
    printed = printed_one_by_one([text for text, _ in own.values()], tmp_path, config)
    assert printed == pytest.approx([value for _, value in own.values()], rel=DIGITS, abs=0)


def test_script_with_a_hundredth_less_friction_prints_another_distance(tmp_path) -> None:
    less = ("FRICTION, GRAVITY = 0.5", "FRICTION, GRAVITY = 0.495")
    with pytest.raises(AssertionError, match="comparison failed"):
        check_number("pybullet:contact:default", "slide-to-stop", tmp_path, less)


@pytest.mark.parametrize(("name", "scenario"), WRITTEN)
def test_script_of_every_case_is_short_enough_for_a_tracker(name, scenario) -> None:
    for own, case in SCENARIOS[scenario].cases.items():
        if not case.sleeping:
            lines = scene_script(checked_scene(name, scenario, own), NUMBER).splitlines()
            assert len(lines) <= MOST_LINES, own
            assert max(map(len, lines)) <= LONGEST_LINE
            compile("\n".join(lines), "reproducer.py", "exec")


def test_engines_with_scripts_of_scenes() -> None:
    names = ["drake", "mujoco", "newton", "pybullet", "rapier", "sapien"]
    assert [name for name in engine_names() if has_scene_script(name, "slope-hold")] == names
    assert {scenario for name, scenario in WRITTEN if name.startswith("mujoco:")} == set(SCENES)
    assert {scenario for name, scenario in WRITTEN if name.startswith("drake:")} == set(ON_A_PLANE)


@pytest.mark.parametrize(
    ("name", "scenario", "shown"),
    [
        ("mujoco", "stack-hold", "mujoco:contact:recommended"),
        ("mujoco", "joint-hold", "mujoco:joint:recommended"),
        ("mujoco:contact:default", "stack-hold", "mujoco:contact:default"),
    ],
)
def test_a_bare_engine_shows_the_recipe_in_the_formulation_of_the_scene(name, scenario, shown) -> None:
    assert checked_scene(name, scenario).run.config == Config.parse(shown)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["reference", "slope-hold"], "formulation = joint; allowed in this scene: contact"),
        (["mujoco:contact:tuned", "slope-hold"], "preset = tuned is for the chain"),
        (["mujoco:joint:default", "slope-hold"], "formulation = joint; allowed in this scene: contact"),
        (["drake:contact:default", "grip"], "engine = drake has no script of grip; allowed: mujoco"),
        (["mujoco:contact:default", "slope-hold", "load 2"], "case = 'load 2' is unknown; allowed: load 0.1"),
        (["mujoco:contact:default", "slope-holt"], "scenario = 'slope-holt' is unknown"),
        (["dart:contact:default", "slope-hold"], "engine = dart has no script of slope-hold; allowed: drake, mujoco"),
    ],
)
def test_what_cannot_be_shown_is_named_with_what_can(capsys, arguments, message) -> None:
    assert run_command(app, arguments) == 2
    printed = capsys.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1
