"""Scripts for engines' trackers: they need the engine alone, and print the number that the suite has."""

import ast
import math
import re
import subprocess
import sys
from collections.abc import Sequence

import pytest

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.interface.variant import variants_of
from multibody_xval.engines.isolated.out_of_process import OutOfProcessEngine
from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.reports.reproducers import questions
from multibody_xval.reports.reproducers.questions import SHOWN, Number, Reproduction, reproduction
from multibody_xval.reports.reproducers.script import LONGEST_LINE, checked, header, script
from multibody_xval.scenarios.cases.motions import Motion
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.scenario import largest
from multibody_xval.scenarios.model import Config, failed
from multibody_xval.scenarios.running.evaluate import Means
from multibody_xval.scenarios.store import Stored
from reference_lcp.errors import ParameterError

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

LANES = [name for name in SHOWN if not isinstance(next(iter(SCENARIOS[name].cases.values())), SceneMotion)]
"""Scenarios of chains and blocks."""

STATIC = "static-above-kinetic"


def lanes_of(config: Config) -> list[str]:
    """Give those that an engine can represent."""
    return [name for name in LANES if name != STATIC or config.preset.static_friction]


MEANS, NUMBER = Means(workers=1), Number(0.5, 1.0)

MOST_LINES = 61
"""A script stays readable in a tracker."""

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


WITH_TEMPLATE = [
    config for name in engine_names() for config in variants_of(name)
    if Formulation(config.formulation) in engine(name).reproducers
]  # fmt: skip

TEMPLATES = list(dict.fromkeys(f"{each.engine}:{each.formulation}" for each in WITH_TEMPLATE))


def check_size(texts: Sequence[str], most_lines: int) -> None:
    """Look at the size of scripts, and whether they are Python."""
    for text in texts:
        lines = text.splitlines()
        assert len(lines) <= most_lines
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


def own_number(config: Config, scenario: str) -> tuple[str, float, float]:
    """Give a script, the suite's number, and how far both may be from each other."""
    shown = checked(str(config), scenario)
    number = shown.number(MEANS)
    left = VALUE_LEFT.get(str(config), 0.0) if shown.quantity.name == "value" else 0.0
    allowed = (DIGITS + left) * abs(number.value) + per_metre(shown, number.value) * position_tolerance(shown)
    return script(shown, number), number.value, allowed


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
]
"""Scripts, and what is an option of their preset: a sweep, friction at rest, a zone, softness, a solver."""


@pytest.mark.parametrize(
    ("name", "scenario", "old", "new"),
    [pytest.param(*own, marks=pytest.mark.needs(own[0].partition(":")[0])) for own in SPOILT],
)
def test_script_prints_the_number_that_the_suite_has_and_another_without_an_option(
    name: str, scenario: str, old: str, new: str, tmp_path
) -> None:
    config = Config.parse(name)
    text, value, allowed = own_number(config, scenario)
    assert old in text
    printed, spoilt = printed_one_by_one([text, text.replace(old, new)], tmp_path, config)
    assert printed == pytest.approx(value, rel=0, abs=allowed)
    assert spoilt != pytest.approx(value, rel=0, abs=2 * allowed)


@pytest.mark.slow
@pytest.mark.parametrize("template", TEMPLATES)
def test_scripts_alone_print_the_numbers_that_the_suite_has(template, tmp_path) -> None:
    """Those of all presets and scenarios, one after the other."""
    missing = engine(template.partition(":")[0]).unavailable_reason()
    if missing is not None:
        pytest.skip(missing)
    configs = [config for config in WITH_TEMPLATE if f"{config.engine}:{config.formulation}" == template]
    own = {(str(config), name): own_number(config, name) for config in configs for name in lanes_of(config)}
    texts = [text for text, *_ in own.values()]
    check_size(texts, MOST_LINES)
    printed = printed_one_by_one(texts, tmp_path, configs[0])
    numbers = dict(zip(own, printed, strict=True))
    off = {
        place: (numbers[place], value)
        for place, (_, value, allowed) in own.items()
        if numbers[place] != pytest.approx(value, rel=0, abs=allowed, nan_ok=True)
    }
    assert off == {}


@pytest.mark.parametrize("template", TEMPLATES)
def test_script_is_short_enough_for_a_tracker(template: str) -> None:
    """That of every scenario, with one preset; the test above has all of them."""
    config = next(config for config in WITH_TEMPLATE if f"{config.engine}:{config.formulation}" == template)
    check_size([script(checked(str(config), name), NUMBER) for name in lanes_of(config)], MOST_LINES)


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
    assert len(text.splitlines()) <= MOST_LINES


def test_a_number_that_there_is_none_of_has_no_script(monkeypatch) -> None:
    monkeypatch.setattr(questions, "computed", lambda runs, *_: [Stored(run, "1", failed("it hangs")) for run in runs])
    with pytest.raises(ParameterError, match=r"mujoco has no number of '1 kg, load 0\.99': it hangs"):
        checked("mujoco", "static-hold").number(MEANS)


def test_a_block_that_never_slips_has_no_number_in_the_header() -> None:
    text = header(checked("mujoco", "breakaway"), Number(math.nan, 1.0))
    assert text.endswith("breakaway: 1 kg, 2 ms. Exact: 1; the cross-validation suite has no number.")


def test_figure_3_is_asked_from_rest() -> None:
    """The exact transmittance is that of the same periods from rest, and the script says so."""
    number = reproduction("reference", "figure3").number(MEANS)
    assert number.value == pytest.approx(number.exact, rel=0, abs=OF_THE_STEP)
    assert number.value != number.exact
    text = script(checked("mujoco:joint:tuned", "figure3"), NUMBER)
    assert "the last of 30 periods from rest" in " ".join(text.splitlines()[:8])
