"""Scripts of scenes: they need the engine alone, and print the number that the suite has."""

import pytest

from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.variant import GENERAL
from multibody_xval.reports.reproducers.questions import SHOWN
from multibody_xval.reports.reproducers.script import checked, script
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.model import Config
from reference_lcp.errors import ParameterError
from tests.installed import each_engine
from tests.reports.reproducers.test_reproducers import DIGITS, MEANS, NUMBER, check_size, printed_one_by_one

SCENES = {
    name: case.formulation
    for name in SHOWN
    if isinstance(case := next(iter(SCENARIOS[name].cases.values())), SceneMotion)
}

IN_THE_PLANE = ("box2d3", "pymunk")

WRITTEN = [
    (f"{name}:{formulation}:{preset}", scenario)
    for name in engine_names()
    for scenario, formulation in SCENES.items()
    if engine(name).scene_gap(formulation) is None
    and not (name in IN_THE_PLANE and scenario in ("spin", "pushed-from-rest"))  # in the plane
    and not (scenario == "held-while-shaken" and name == "genesis")  # its adapter pushes none
    for preset in GENERAL
    if preset in engine(name).capabilities.presets[formulation]
]

MOST_LINES = 104
"""A script of a scene has the lines by which its adapter makes bodies; half of them have at most 68."""


def own_number(name: str, scenario: str, case: str | None = None) -> tuple[str, float]:
    """Give a script, and the suite's number."""
    shown = checked(name, scenario, case)
    number = shown.number(MEANS)
    return script(shown, number), number.value


def check_numbers(places, folder, changed=("", "")) -> None:
    """Run scripts of an engine, of which a text is changed, and compare what they print with the suite's numbers."""
    own = [own_number(*place) for place in places]
    texts = [text.replace(*changed) for text, _ in own]
    assert changed == ("", "") or texts != [text for text, _ in own]
    check_size(texts, MOST_LINES)
    printed = printed_one_by_one(texts, folder, Config.parse(places[0][0]))
    assert printed == pytest.approx([value for _, value in own], rel=DIGITS, abs=0)


@pytest.mark.parametrize("name", each_engine(["mujoco", "pybullet"]))
def test_scripts_alone_print_friction_time_torque_and_drift_that_the_suite_has(name, tmp_path) -> None:
    """Of two engines; those of all are in the next test."""
    recipes = [(f"{name}:contact:recommended", own) for own in ("slope-slide", "conveyor", "spin", "slope-hold")]
    check_numbers([*recipes, (f"{name}:contact:default", "slope-hold")], tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", each_engine(["mujoco", "pybullet", "rapier", "dart", "sapien", "ode", *IN_THE_PLANE]))
def test_scripts_alone_print_how_far_a_pushed_box_goes(name, tmp_path) -> None:
    angle = 0 if name in IN_THE_PLANE else 45
    places = [(f"{name}:contact:{preset}", "pushed-from-rest", f"{load} μmg, {angle}°")
              for preset, load in zip(GENERAL, (1.2, 1.06), strict=True)]  # fmt: skip
    check_numbers(places, tmp_path)


@pytest.mark.parametrize("name", each_engine(["mujoco", "pybullet"]))
def test_scripts_alone_print_when_a_joint_stops_as_the_suite_has_it(name, tmp_path) -> None:
    places = [(f"{name}:joint:{preset}", "joint-stop") for preset in GENERAL]
    check_numbers(places, tmp_path)
    with pytest.raises(AssertionError, match="comparison failed"):
        check_numbers(places, tmp_path, ("20.0", "40.0"))


@pytest.mark.slow
@pytest.mark.parametrize("formulation", dict.fromkeys(name.rpartition(":")[0] for name, _ in WRITTEN))
def test_scripts_alone_print_the_numbers_that_the_suite_has(formulation, tmp_path) -> None:
    """Those of all presets and scenes, one after the other."""
    missing = engine(formulation.partition(":")[0]).unavailable_reason()
    if missing is not None:
        pytest.skip(missing)
    check_numbers([place for place in WRITTEN if place[0].startswith(f"{formulation}:")], tmp_path)


CHANGED = [
    ("pybullet:contact:default", "slide-to-stop", "rub = 0.5", "rub = 0.495"),
    ("mujoco:contact:recommended", "slope-hold", 'impratio="10000.0"', ""),
]


@pytest.mark.parametrize(
    ("name", "scenario", "old", "new"),
    [pytest.param(*own, marks=pytest.mark.needs(own[0].partition(":")[0])) for own in CHANGED],
)
def test_script_with_less_friction_or_without_its_recipe_prints_another_number(
    name, scenario, old, new, tmp_path
) -> None:
    with pytest.raises(AssertionError, match="comparison failed"):
        check_numbers([(name, scenario)], tmp_path, (old, new))


@pytest.mark.parametrize("name", dict.fromkeys(name.partition(":")[0] for name, _ in WRITTEN))
def test_scripts_of_an_engine_are_short_enough_for_a_tracker(name: str) -> None:
    """Those of one case of every scene, with one preset."""
    presets = {(own.rpartition(":")[0], scene): own for own, scene in WRITTEN if own.startswith(f"{name}:")}
    check_size([script(checked(own, scene), NUMBER) for (_, scene), own in presets.items()], MOST_LINES)


def test_a_box_that_is_turned_is_refused_in_two_dimensions() -> None:
    with pytest.raises(ParameterError, match=r"turn = 0\.5 of a box on its plane; allowed in two dimensions: 0"):
        checked("box2d3:contact:default", "slope-hold", "load 0.5, turned")


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


def test_a_server_s_scene_is_read_without_its_engine() -> None:
    text = script(checked("siconos:contact:default", "conveyor"), NUMBER)
    assert "import siconos.kernel as kernel" in text
    assert "apt install python3-siconos" in " ".join(text.split())
