"""Scripts of scenes: they need the engine alone, and print the number that the suite has."""

import pytest

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.variant import GENERAL
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.reproduce import app
from multibody_xval.reports.reproducers.questions import SHOWN
from multibody_xval.reports.reproducers.script import LONGEST_LINE, checked, script
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.model import Config
from reference_lcp.errors import ParameterError
from tests.reports.reproducers.test_reproducers import (
    DIGITS,
    MEANS,
    NUMBER,
    printed_one_by_one,
)

SCENES = {
    name: case.formulation
    for name in SHOWN
    if isinstance(case := next(iter(SCENARIOS[name].cases.values())), SceneMotion)
}

WRITTEN = [
    (f"{name}:{formulation}:{preset}", scenario)
    for name in engine_names()
    for scenario, formulation in SCENES.items()
    if engine(name).scene_gap(formulation) is None
    and not (name in ("box2d", "pymunk") and scenario in ("spin", "pushed-from-rest"))  # in the plane
    and not (scenario == "held-while-shaken" and name == "genesis")  # its adapter pushes none
    for preset in GENERAL
    if preset in engine(name).capabilities.presets[formulation]
]

IN_THE_SPACE = ("mujoco", "pybullet", "rapier", "dart")
IN_THE_PLANE = ("box2d", "pymunk")

MOST_LINES = 104
"""A script of a scene has the lines by which its adapter makes bodies; half of them have at most 68."""


def own_number(name: str, scenario: str, case: str | None = None) -> tuple[str, float]:
    """Give a script, and the suite's number."""
    reason = engine(name.partition(":")[0]).unavailable_reason()
    if reason is not None:
        pytest.skip(reason)
    shown = checked(name, scenario, case)
    number = shown.number(MEANS)
    return script(shown, number), number.value


def check_numbers(places, folder, changed=("", "")) -> None:
    own = [own_number(*place) for place in places]
    assert all(changed[0] in text for text, _ in own)
    texts = [text.replace(*changed) for text, _ in own]
    printed = printed_one_by_one(texts, folder, Config.parse(places[0][0]))
    assert printed == pytest.approx([value for _, value in own], rel=DIGITS, abs=0)


@pytest.mark.parametrize("name", [*IN_THE_SPACE, *IN_THE_PLANE])
def test_scripts_alone_print_friction_time_and_torque_that_the_suite_has(name, tmp_path) -> None:
    scenarios = ["slope-slide", "conveyor", *["spin"] * (name in IN_THE_SPACE)]
    check_numbers([(f"{name}:contact:recommended", scenario) for scenario in scenarios], tmp_path)


@pytest.mark.parametrize("name", [*IN_THE_SPACE, "sapien", "ode", *IN_THE_PLANE])
def test_scripts_alone_print_how_far_a_pushed_box_goes(name, tmp_path) -> None:
    angle = 0 if name in IN_THE_PLANE else 45
    places = [(f"{name}:contact:{preset}", "pushed-from-rest", f"{load} μmg, {angle}°")
              for preset, load in zip(GENERAL, (1.2, 1.06), strict=True)]  # fmt: skip
    check_numbers(places, tmp_path)


@pytest.mark.parametrize("name", ["rapier", "dart", *IN_THE_PLANE])
def test_scripts_alone_print_the_drift_of_a_grip_and_what_joints_do_that_the_suite_has(name, tmp_path) -> None:
    joints = [(f"{name}:joint:recommended", scenario) for scenario in ("joint-hold", "arm-hold", "joint-stop")]
    check_numbers([(f"{name}:contact:recommended", "grip"), *joints], tmp_path)


@pytest.mark.parametrize("places", [
    [("ode:contact:recommended", "grip"), ("ode:contact:recommended", "spin")],
    [("ode:joint:default", "arm-hold"), ("ode:joint:default", "joint-stop")],
    [("siconos:contact:default", "grip"), ("siconos:contact:default", "conveyor")],
    [(f"exudyn-{name}:joint:{preset}", "arm-hold") for name in ("bristle", "regularised") for preset in GENERAL],
    [(f"exudyn-{name}:joint:default", "joint-stop") for name in ("bristle", "regularised")],
], ids=["ode", "ode's joints", "siconos", "exudyn", "exudyn, thrown"])  # fmt: skip
def test_scripts_of_servers_and_of_solvers_alone_print_the_numbers_that_the_suite_has(places, tmp_path) -> None:
    check_numbers(places, tmp_path)


@pytest.mark.parametrize("preset", GENERAL)
@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_script_alone_prints_the_drift_that_the_suite_has(name, preset, tmp_path) -> None:
    check_numbers([(f"{name}:contact:{preset}", "slope-hold")], tmp_path)


@pytest.mark.parametrize("name", ["mujoco", "pybullet", "sapien"])
def test_scripts_alone_print_when_a_joint_stops_as_the_suite_has_it(name, tmp_path) -> None:
    places = [(f"{name}:joint:{preset}", "joint-stop") for preset in GENERAL]
    check_numbers(places, tmp_path)
    with pytest.raises(AssertionError, match="comparison failed"):
        check_numbers(places, tmp_path, ("20.0", "40.0"))


@pytest.mark.slow
@pytest.mark.parametrize("formulation", dict.fromkeys(name.rpartition(":")[0] for name, _ in WRITTEN))
def test_scripts_alone_print_the_numbers_that_the_suite_has(formulation, tmp_path) -> None:
    """Those of all presets and scenes, one after the other."""
    check_numbers([place for place in WRITTEN if place[0].startswith(f"{formulation}:")], tmp_path)


def test_script_with_a_hundredth_less_friction_prints_another_distance(tmp_path) -> None:
    with pytest.raises(AssertionError, match="comparison failed"):
        check_numbers([("pybullet:contact:default", "slide-to-stop")], tmp_path, ("rub = 0.5", "rub = 0.495"))


def test_script_without_what_the_recipe_changes_prints_another_drift(tmp_path) -> None:
    with pytest.raises(AssertionError, match="comparison failed"):
        check_numbers([("mujoco:contact:recommended", "slope-hold")], tmp_path, ('impratio="10000.0"', ""))


@pytest.mark.parametrize(("name", "scenario"), WRITTEN)
def test_script_of_every_case_is_short_enough_for_a_tracker(name, scenario) -> None:
    for own, case in SCENARIOS[scenario].cases.items():
        if case.sleeping or (name.startswith(("box2d", "pymunk")) and own.endswith(("turned", "off", "5°", "30°"))):
            continue
        if name.startswith("mujoco") or "inside" not in own:
            lines = script(checked(name, scenario, own), NUMBER).splitlines()
            assert len(lines) <= MOST_LINES, own
            assert max(map(len, lines)) <= LONGEST_LINE
            compile("\n".join(lines), "reproducer.py", "exec")


def test_a_box_that_is_turned_is_refused_in_two_dimensions() -> None:
    with pytest.raises(ParameterError, match=r"turn = 0\.5 of a box on its plane; allowed in two dimensions: 0"):
        checked("box2d:contact:default", "slope-hold", "load 0.5, turned")


@pytest.mark.parametrize(
    ("name", "scenario", "shown"),
    [
        ("mujoco", "stack-hold", "mujoco:contact:recommended"),
        ("mujoco", "joint-hold", "mujoco:joint:recommended"),
        ("mujoco:contact:default", "stack-hold", "mujoco:contact:default"),
    ],
)
def test_a_bare_engine_shows_the_recipe_in_the_formulation_of_the_scene(name, scenario, shown) -> None:
    assert checked(name, scenario).run.config == Config.parse(shown)


def test_a_scene_that_a_class_builds_is_refused_with_the_reason(monkeypatch) -> None:
    class World:
        """Of an adapter that keeps what it builds in an object."""

    monkeypatch.setattr(type(engine("mujoco")), "scene_worlds", {Formulation.CONTACT: World})
    with pytest.raises(ParameterError, match=r"default has no script of grip: scene = .*World.* is a class; allowed"):
        checked("mujoco:contact:default", "grip")


def test_a_server_s_scene_is_read_without_its_engine() -> None:
    text = script(checked("siconos:contact:default", "conveyor"), NUMBER)
    assert "import siconos.kernel as kernel" in text
    assert "apt install python3-siconos" in " ".join(text.split())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["reference", "slope-hold"], "formulation = joint; allowed in this scene: contact"),
        (["mujoco:contact:tuned", "slope-hold"], "preset = tuned is for the chain"),
        (["mujoco:joint:default", "slope-hold"], "formulation = joint; allowed in this scene: contact"),
        (["mujoco:contact:default", "slope-hold", "load 2"], "case = 'load 2' is unknown; allowed: load 0.1"),
        (["mujoco:contact:default", "slope-holt"], "scenario = 'slope-holt' is unknown"),
    ],
)
def test_what_cannot_be_shown_is_named_with_what_can(capsys, arguments, message) -> None:
    assert run_command(app, arguments) == 2
    printed = capsys.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1
