"""Scripts for engines' trackers: they need the engine alone, and print the number that the suite has."""

import ast
import math
import re
import subprocess
import sys
from collections.abc import Sequence
from datetime import date
from pathlib import Path

import pytest

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.scene import SceneSetting
from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.interface.variant import variants_of
from multibody_xval.engines.isolated.out_of_process import OutOfProcessEngine
from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.reports.reproducers import questions
from multibody_xval.reports.reproducers.questions import SHOWN, Number, Reproduction, reproduction
from multibody_xval.reports.reproducers.script import LONGEST_LINE, checked, script
from multibody_xval.reports.reproducers.specialise import specialised
from multibody_xval.scenarios.cases.motions import Motion
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.scenario import largest
from multibody_xval.scenarios.model import Config, failed
from multibody_xval.scenarios.running.evaluate import Means
from multibody_xval.scenarios.store import Stored
from reference_lcp.errors import ParameterError
from tests.scenarios.in_this_process import result_of

ALONE = """
import ast, importlib, os, runpy, sys
for script in sys.argv[1:]:
    _, *lines = ast.parse(open(script).read()).body
    for line in lines:
        if not isinstance(line, (ast.Import, ast.ImportFrom)):
            break  # what is set before an import, or the model
        if isinstance(line, ast.Import):
            for module in line.names:
                importlib.import_module(module.name)
    sys.stdout.flush()
    if os.fork() == 0:
        runpy.run_path(script, run_name="__main__")
        suite = {"reference_lcp", "multibody_xval"} & {name.partition(".")[0] for name in sys.modules}
        assert not suite, suite
        break
    assert os.waitstatus_to_exitcode(os.wait()[1]) == 0
    print("end of a script")
"""
"""Runs scripts, each in a process that has imported what it imports, and looks at what it imported beside that."""

CODE = 'x"""\nimport os; os.system("touch run")\n"""\\'
"""A version that leaves the docstring of a script."""


@pytest.fixture(autouse=True)
def computes_here(monkeypatch) -> None:
    """Compute numbers of scripts in this process."""
    monkeypatch.setattr(questions, "computed", lambda runs, *_: [Stored(run, "1", result_of(run)) for run in runs])


SCENES = {
    name: case.formulation
    for name in SHOWN
    if isinstance(case := next(iter(SCENARIOS[name].cases.values())), SceneMotion)
}
"""Scenarios of scenes; the others are of chains and blocks."""

STATIC = "static-above-kinetic"

Place = tuple[Config, str, str | None]
"""A configuration, a scenario, and one of its cases instead of the one that is shown."""

WITHOUT = {("box2d3", "spin"), ("pymunk", "spin")}
"""Scenes that are not in the plane."""

CASES = dict.fromkeys([("box2d3", "pushed-from-rest"), ("pymunk", "pushed-from-rest")], "1.2 μmg, 0°")
"""Cases in the plane."""


def has_script(config: Config, scenario: str) -> bool:
    """Tell whether there is a script of a scenario."""
    own, formulation = engine(config.engine), Formulation(config.formulation)
    if scenario not in SCENES:
        every = formulation in own.reproducers and not config.preset.optional and not config.preset.scenes_only
        return every and (scenario != STATIC or config.preset.static_friction)
    is_scene = formulation == SCENES[scenario] and config.runs_scenes and own.scene_gap(formulation) is None
    return is_scene and (config.engine, scenario) not in WITHOUT


PLACES: dict[str, list[Place]] = {
    name: [
        (config, scenario, CASES.get((name, scenario)))
        for config in variants_of(name, optional=True, scenes_only=True)
        for scenario in SHOWN if has_script(config, scenario)
    ]
    for name in engine_names()
}  # fmt: skip

MEANS, NUMBER = Means(workers=1), Number(0.5, 1.0)

MOST_LINES, MOST_LINES_OF_SCENES = 61, 109
"""A script stays readable in a tracker; that of a scene has the lines by which its adapter makes bodies."""

DIGITS = 1e-11
"""The script prints twelve digits."""

ROUNDINGS = 16
"""Of a position in a step, at most: the same additions in other units, and in another order."""

PARTS_LEFT = {"drake:contact:sap": 1e-6}
"""Part of a motion that a solver leaves, where it stops elsewhere in other units: Drake's stops at 1e-6 of momenta. The
preset itself in SI units prints the number of the script to all digits."""

VALUE_LEFT = {"exudyn-bristle": 1e-8, "exudyn-regularised": 2e-7, "siconos:contact:default": 1e-5}
"""Part of a published value that a solver leaves, where it stops elsewhere in other units: Exudyn's Newton iteration at
1e-10 of the first residual of each of some thousand substeps, Siconos' solver at its own tolerance of 1e-4."""

OF_THE_STEP = 5e-3
"""[dB] What 400 steps a period err by, of first order: 2e-3. The steady state is 0.4 dB away."""

SINGLE_ROUNDINGS = 3
"""Standard deviations of the sum of as many roundings as steps, as in `TRAJECTORY_TOLERANCE` of engines."""


def per_metre(shown: Reproduction, value: float) -> float:
    """Give what a metre of a position makes of a number at most."""
    case = shown.run.of(Motion)
    match shown.quantity.name:
        case "drift":  # µm/s, from two slips
            return 2 * 1e6 / (case.time / 2)
        case "distance":
            return 2 / case.scale
        case "transmittance":  # dB of an amplitude
            return 20 / math.log(10) / (case.scale * 10 ** (value / 20))
        case "value":  # of a mean velocity, in which roundings of the clock add up
            return 1e2
    return 0.0  # a slip is seen at the end of a step, and does not move by as little as a round-off


def check_size(text: str, scenario: str) -> None:
    """Look at the size of a script, and whether it is Python."""
    lines = text.splitlines()
    assert len(lines) <= (MOST_LINES_OF_SCENES if scenario in SCENES else MOST_LINES)
    assert max(map(len, lines)) <= LONGEST_LINE
    compile(text, "reproducer.py", "exec")


def python_of(config: Config) -> str:
    """Give the Python that has the engine of a configuration."""
    adapter = engine(config.engine)
    return adapter.interpreter if isinstance(adapter, OutOfProcessEngine) else sys.executable


def printed_one_by_one(texts: Sequence[str], folder, config: Config) -> list[float]:
    """Run scripts in an empty folder, without the paths of the user; gives the numbers that they print last."""
    files = [folder / f"reproducer-{number}.py" for number in range(len(texts))]
    for file, text in zip(files, texts, strict=True):
        file.write_text(text, encoding="utf-8")
    done = subprocess.run(
        [python_of(config), "-I", "-X", "utf8", "-c", ALONE, *map(str, files)],
        cwd=folder, capture_output=True, text=True, encoding="utf-8", check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    *outputs, _ = done.stdout.split("end of a script\n")
    lines = [output.splitlines()[-1] for output in outputs]
    return [float(re.fullmatch(r".*: (\S+).* \(exact: \S+\)", line).group(1)) for line in lines]


def own_number(place: Place) -> tuple[str, float, float]:
    """Give a script, the suite's number, and how far both may be from each other."""
    config, scenario, case = place
    shown = checked(str(config), scenario, case)
    number = shown.number(MEANS)
    text, allowed = script(shown, number), DIGITS * abs(number.value)
    check_size(text, scenario)
    if scenario not in SCENES:
        left = VALUE_LEFT.get(str(config), 0.0) if shown.quantity.name == "value" else 0.0
        allowed += left * abs(number.value) + per_metre(shown, number.value) * position_tolerance(shown)
    return text, number.value, allowed


def position_tolerance(shown: Reproduction) -> float:
    """Give by how much positions may differ [m]: roundings of every step, and what a preset says of runs in parts.

    The suite simulates a motion in parts, and a script in one. In single precision both round the same numbers, and
    differ where double precision rounds one of them to its other neighbour.
    """
    config, steps, case = shown.run.config, shown.run.steps, shown.run.of(Motion)
    left = config.preset.split_tolerance + PARTS_LEFT.get(str(config), 0.0)
    roundings = ROUNDINGS * steps * 2.0**-53
    if config.capabilities.precision == "single":
        roundings = SINGLE_ROUNDINGS * math.sqrt(steps) * SINGLE
    return roundings * max(case.scale, largest(case.initial_state().positions)) + left * case.scale


SPOILT = [
    ("mujoco", "static-hold", ' noslip_iterations="1"', ""),
    ("exudyn-bristle:joint:default", STATIC, "Force=offset[i]", "Force=0.0"),
    ("exudyn-regularised:joint:default", "static-hold", "zone = [0.001]", "zone = [0.00101]"),
    ("ode", "static-hold", "world.setCFM(0.0)", ""),
    ("sapien:contact:default", "static-hold", "enable_tgs=True", "enable_tgs=False"),
    ("mujoco:contact:recommended", "slope-hold", 'impratio="10000"', ""),
    ("mujoco:contact:recommended", "spin", "20.0", "40.0"),
    ("mujoco:joint:default", "joint-stop", "20.0", "40.0"),
    ("pybullet:contact:default", "slide-to-stop", "rub = 0.5", "rub = 0.495"),
    ("pybullet:contact:recommended", "conveyor", "rub = 0.5", "rub = 0.495"),
    ("pybullet:joint:recommended", "joint-stop", "20.0", "40.0"),
]
"""Scripts, and what they have of a preset or a scene: a sweep, friction at rest, a zone, softness, a speed."""


@pytest.mark.parametrize(
    ("name", "scenario", "old", "new"),
    [
        pytest.param(
            *own, marks=[pytest.mark.needs(own[0].partition(":")[0]), *[pytest.mark.slow] * (own[1] == STATIC)]
        )
        for own in SPOILT
    ],
)
def test_script_prints_the_number_that_the_suite_has_and_another_where_it_is_changed(
    name: str, scenario: str, old: str, new: str, tmp_path: Path
) -> None:
    config = Config.parse(name)
    text, value, allowed = own_number((config, scenario, None))
    assert old in text
    printed, spoilt = printed_one_by_one([text, text.replace(old, new)], tmp_path, config)
    assert printed == pytest.approx(value, rel=0, abs=allowed)
    assert spoilt != pytest.approx(value, rel=0, abs=2 * allowed)


def todays(places: Sequence[Place]) -> list[Place]:
    """Give half of the places of some presets, the other half tomorrow: each scenario with every second preset.

    The options of a preset stand in lines of their own, which are the same in every scenario.
    """
    today, by_scenario = date.today().toordinal(), dict[str, list[Place]]()
    for own in places:
        by_scenario.setdefault(own[1], []).append(own)
    every = enumerate(by_scenario.values(), today)
    return [own for number, presets in every for own in (presets[number % 2 :: 2] or presets)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "formulation"), sorted({(name, own[0].formulation) for name, every in PLACES.items() for own in every})
)
def test_scripts_alone_print_the_numbers_that_the_suite_has(name: str, formulation: str, tmp_path: Path) -> None:
    """Those of chains one after the other, and those of scenes, which import another build of Exudyn."""
    missing = engine(name).unavailable_reason()
    if missing is not None:
        pytest.skip(missing)
    asked = todays([own for own in PLACES[name] if own[0].formulation == formulation])
    off = {}
    for kind in (False, True):
        places = [own for own in asked if (own[1] in SCENES) == kind]
        if not places:
            continue
        texts, values, allowed = zip(*map(own_number, places), strict=True)
        printed = printed_one_by_one(texts, tmp_path, places[0][0])
        off |= {
            (str(place[0]), place[1]): (own, value)
            for place, own, value, most in zip(places, printed, values, allowed, strict=True)
            if own != pytest.approx(value, rel=0, abs=most, nan_ok=True)
        }
    assert off == {}


@pytest.mark.parametrize("name", [name for name, own in PLACES.items() if own])
def test_scripts_of_an_engine_are_short_enough_for_a_tracker(name: str) -> None:
    """Those of every scenario with one preset, whether the engine is installed or not; the test above has all."""
    one_preset = {(config.formulation, scenario): (config, scenario, case) for config, scenario, case in PLACES[name]}
    for config, scenario, case in one_preset.values():
        check_size(script(checked(str(config), scenario, case), NUMBER), scenario)


def statements(text: str) -> list[str]:
    """Give what a script does after its docstring."""
    header, *body = ast.parse(text).body
    assert isinstance(header.value.value, str)
    return list(map(ast.unparse, body))


def test_a_version_that_is_code_stays_a_text_of_the_script(monkeypatch) -> None:
    shown = checked("mujoco", "static-hold")
    expected = statements(script(shown, NUMBER))
    monkeypatch.setattr(MuJoCo, "version", lambda _: CODE + 5000 * "v")
    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _: None)
    text = script(shown, NUMBER)
    assert statements(text) == expected
    assert "touch run" in ast.get_docstring(ast.parse(text))
    check_size(text, "static-hold")


def test_what_has_no_number_or_no_script_is_refused(monkeypatch) -> None:
    with pytest.raises(ParameterError, match=r"turn = 0\.5 of a box on its plane; allowed in two dimensions: 0"):
        checked("box2d3:contact:default", "slope-hold", "load 0.5, turned")
    monkeypatch.setattr(questions, "computed", lambda runs, *_: [Stored(run, "1", failed("it hangs")) for run in runs])
    with pytest.raises(ParameterError, match=r"mujoco has no number of '1 kg, load 0\.99': it hangs"):
        checked("mujoco", "static-hold").number(MEANS)


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


def test_figure_3_is_asked_from_rest() -> None:
    """The exact transmittance is that of the same periods from rest, and the script says so."""
    number = reproduction("reference", "figure3").number(MEANS)
    assert number.value == pytest.approx(number.exact, rel=0, abs=OF_THE_STEP)
    assert number.value != number.exact
    text = script(checked("mujoco:joint:tuned", "figure3"), NUMBER)
    assert "the last of 30 periods from rest" in " ".join(text.splitlines()[:8])


@pytest.mark.parametrize("scenario", ["slope-hold", "joint-hold"])
def test_genesis_is_started_in_its_scripts(scenario: str) -> None:
    """It refuses to make a scene before."""
    case = next(iter(SCENARIOS[scenario].cases.values()))
    assert isinstance(case, SceneMotion)
    setting = SceneSetting(Config("genesis", str(case.formulation), "default").preset, 0.01)
    own = specialised(engine("genesis").scene_worlds[case.formulation], {"scene": case.scene, "setting": setting})
    assert own.starts == {"genesis.init(backend=genesis.cpu, precision='64', logging_level='error')"}
