"""Scripts for engines' trackers: they need the engine alone, and print the number that the suite has."""

import ast
import math
import re
import subprocess
import sys
from collections.abc import Sequence

import numpy as np
import pytest

from multibody_xval.engines.exudyn import ExudynRegularised
from multibody_xval.engines.exudyn.reproducer import zone_numbers
from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.reproducer import Reproducer
from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.interface.variant import Variant, variants_of
from multibody_xval.engines.isolated.out_of_process import OutOfProcessEngine
from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.engines.mujoco.reproducer import joint_numbers
from multibody_xval.engines.ode import ODE
from multibody_xval.engines.sapien import Sapien
from multibody_xval.engines.shared.script_units import script_in_si
from multibody_xval.reports.reproducers.questions import QUESTIONS
from multibody_xval.reports.reproducers.script import LONGEST_LINE, checked, script
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.executor import InProcessExecutor
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.runs.task import Task
from multibody_xval.scenarios.runs.transient_task import TransientTask
from reference_lcp.errors import ParameterError
from tests.scenarios.in_process import evaluator

ALONE = """
import ast, importlib, os, runpy, sys
for script in sys.argv[1:]:
    for line in ast.parse(open(script).read()).body:
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
"""A reason that leaves the docstring of a script."""

MOST_LINES = 60
"""A script stays readable in a tracker."""

DIGITS = 1e-11
"""The script prints twelve digits."""

ROUNDINGS = 16
"""Of a position in a step, at most: the same additions in other units, and in another order."""

PARTS_LEFT = {"drake:contact:sap": 1e-6}
"""Part of a motion that a solver leaves, where it stops elsewhere in other units: Drake's stops at 1e-6 of momenta. The
preset itself in SI units prints the number of the script to all digits."""

OF_THE_STEP = 5e-3
"""[dB] What 400 steps a period err by, of first order: 2e-3. The steady state is 0.4 dB away."""

SINGLE_ROUNDINGS = 3
"""Standard deviations of the sum of as many roundings as steps, as in `TRAJECTORY_TOLERANCE` of engines."""


def per_metre(scenario: str, task: TransientTask, value: float) -> float:
    """Give what a metre of a position makes of a number at most."""
    scale = task.base.displacement_scale(task.chain)
    match scenario:
        case "static-hold":  # µm/s, from two slips
            return 2 * 1e6 / (task.steps * task.time_step / 2)
        case "stopping-distance":
            return 2 / scale
        case "figure3":  # dB of an amplitude
            return 20 / math.log(10) / (scale * 10 ** (value / 20))
    return 0.0  # a slip is seen at the end of a step, and does not move by as little as a round-off


WITH_TEMPLATE = [
    variant for name in engine_names() for variant in variants_of(name)
    if Formulation(variant.formulation) in engine(name).reproducers
]  # fmt: skip

needs_mujoco = pytest.mark.needs("mujoco")


def python_of(variant: Variant) -> str:
    """Give the Python that has the engine of a variant."""
    adapter = engine(variant.engine)
    return adapter.interpreter if isinstance(adapter, OutOfProcessEngine) else sys.executable


def printed_by(text: str, folder, variant: Variant) -> float:
    """Run a script in an empty folder, without the paths of the user; gives the number that it prints last."""
    return printed_one_by_one([text], folder, variant)[0]


def printed_one_by_one(texts: Sequence[str], folder, variant: Variant) -> list[float]:
    """Run scripts one after the other; gives the numbers that they print last."""
    files = [folder / f"reproducer-{number}.py" for number in range(len(texts))]
    for file, text in zip(files, texts, strict=True):
        file.write_text(text, encoding="utf-8")
    done = subprocess.run(
        [python_of(variant), "-I", "-X", "utf8", "-c", ALONE, *map(str, files)],
        cwd=folder, capture_output=True, text=True, encoding="utf-8", check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    *outputs, _ = done.stdout.split("end of a script\n")
    lines = [output.splitlines()[-1] for output in outputs]
    return [float(re.fullmatch(r".*: (\S+).* \(exact: \S+\)", line).group(1)) for line in lines]


def own_number(variant: Variant, scenario: str) -> tuple[str, float, float]:
    """Give a script, the suite's number, and how far both may be from each other."""
    shown = checked(str(variant), scenario)
    task = shown.question.task(variant, shown.case)
    with opened_store(None) as store, evaluator(store) as running:
        text = script(shown, running)
        value = shown.question.number(variant, shown.case, running).value
    return text, value, DIGITS * abs(value) + per_metre(scenario, task, value) * position_tolerance(variant, task)


def position_tolerance(variant: Variant, task: TransientTask) -> float:
    """Give by how much positions may differ [m]: roundings of every step, and what a preset says of runs in parts.

    The suite simulates a motion in parts, and a script in one. In single precision both round the same numbers, and
    differ where double precision rounds one of them to its other neighbour.
    """
    scale = task.base.displacement_scale(task.chain)
    largest = max(scale, float(np.max(np.abs(task.initial_state().positions))))
    left = variant.preset.split_tolerance + PARTS_LEFT.get(str(variant), 0.0)
    roundings = ROUNDINGS * task.steps * 2.0**-53
    if engine(variant.engine).capabilities.precision == "single":
        roundings = SINGLE_ROUNDINGS * math.sqrt(task.steps) * SINGLE
    return roundings * largest + left * scale


def check_number(variant: Variant, scenario: str, folder) -> None:
    missing = engine(variant.engine).unavailable_reason()
    if missing is not None:
        pytest.skip(missing)
    text, value, allowed = own_number(variant, scenario)
    assert printed_by(text, folder, variant) == pytest.approx(value, rel=0, abs=allowed, nan_ok=True)


@pytest.mark.slow
@pytest.mark.parametrize("template", dict.fromkeys(f"{each.engine}:{each.formulation}" for each in WITH_TEMPLATE))
def test_scripts_alone_print_the_numbers_that_the_suite_has(template, tmp_path) -> None:
    """Those of all presets and questions, one after the other."""
    missing = engine(template.partition(":")[0]).unavailable_reason()
    if missing is not None:
        pytest.skip(missing)
    variants = [variant for variant in WITH_TEMPLATE if f"{variant.engine}:{variant.formulation}" == template]
    own = {(str(variant), name): own_number(variant, name) for variant in variants for name in QUESTIONS}
    printed = printed_one_by_one([text for text, *_ in own.values()], tmp_path, variants[0])
    numbers = dict(zip(own, printed, strict=True))
    off = {
        place: (numbers[place], value)
        for place, (_, value, allowed) in own.items()
        if numbers[place] != pytest.approx(value, rel=0, abs=allowed, nan_ok=True)
    }
    assert off == {}


@needs_mujoco
def test_script_without_the_no_slip_sweep_of_its_preset_prints_another_creep(tmp_path, monkeypatch) -> None:
    def without(lane, preset, start):
        numbers = joint_numbers(lane, preset, start)
        return {**numbers, "option": numbers["option"].replace(' noslip_iterations="1"', "")}

    spoilt = Reproducer("reproducer_joint.py.jinja", without)
    monkeypatch.setattr(MuJoCo, "reproducers", {Formulation.JOINT: spoilt})
    with pytest.raises(AssertionError, match="comparison failed"):
        check_number(Variant("mujoco"), "static-hold", tmp_path)


@pytest.mark.needs("exudyn-regularised")
def test_script_whose_zone_is_a_hundredth_too_wide_prints_another_creep(tmp_path, monkeypatch) -> None:
    def wider(lane, preset, start):
        numbers = zone_numbers(lane, preset, start)
        return {**numbers, "zone": 1.01 * numbers["zone"]}

    spoilt = Reproducer("reproducer_joint.py.jinja", wider)
    monkeypatch.setattr(ExudynRegularised, "reproducers", {Formulation.JOINT: spoilt})
    with pytest.raises(AssertionError, match="comparison failed"):
        check_number(Variant("exudyn-regularised", "joint", "default"), "static-hold", tmp_path)


@pytest.mark.needs("ode")
def test_script_with_the_softness_that_its_preset_takes_away_prints_another_creep(tmp_path, monkeypatch) -> None:
    spoilt = script_in_si("reproducer_joint.py.jinja", lambda *_: {"changed": lambda _name: False})
    monkeypatch.setattr(ODE, "reproducers", {Formulation.JOINT: spoilt})
    with pytest.raises(AssertionError, match="comparison failed"):
        check_number(Variant("ode"), "static-hold", tmp_path)


@pytest.mark.needs("sapien")
def test_script_with_the_other_solver_of_contacts_prints_another_creep(tmp_path, monkeypatch) -> None:
    written = Sapien.reproducers[Formulation.CONTACT].numbers

    def projected(lane, preset, start):
        return written(lane, Sapien().preset("contact", "default:enable_tgs=false"), start)

    spoilt = Reproducer("reproducer_contact.py.jinja", projected, own_units=True)
    monkeypatch.setattr(Sapien, "reproducers", {Formulation.CONTACT: spoilt})
    with pytest.raises(AssertionError, match="comparison failed"):
        check_number(Variant("sapien", "contact", "default"), "static-hold", tmp_path)


class WithoutEngines(Evaluator):
    """Runs the reference alone: headers then say that there is no number."""

    def evaluate(self, tasks: Sequence[Task]) -> list[Result]:
        asked = [task for task in tasks if task.variant.engine == "reference"]
        results = dict(zip(asked, super().evaluate(asked), strict=True))
        return [results.get(task, Result.missing()) for task in tasks]


class Hostile(Evaluator):
    """Has what a stranger's store may have for every motion: blocked, for a reason that is code."""

    status = ResultStatus.BLOCKED

    def evaluate(self, tasks: Sequence[Task]) -> list[Result]:
        return [Result(status=self.status, reason=CODE) for _ in tasks]


class HostileMissing(Hostile):
    status = ResultStatus.MISSING


@pytest.fixture(scope="module")
def reference_alone():
    with opened_store(None) as store, WithoutEngines(store, InProcessExecutor()) as results:
        yield results


@pytest.mark.parametrize("scenario", QUESTIONS)
@pytest.mark.parametrize("variant", WITH_TEMPLATE, ids=str)
def test_script_is_short_enough_for_a_tracker(variant, scenario, reference_alone) -> None:
    lines = script(checked(str(variant), scenario), reference_alone).splitlines()
    assert len(lines) <= MOST_LINES
    assert max(map(len, lines)) <= LONGEST_LINE
    compile("\n".join(lines), "reproducer.py", "exec")


def statements(text: str) -> list[str]:
    """Give what a script does after its docstring."""
    header, *body = ast.parse(text).body
    assert isinstance(header.value.value, str)
    return list(map(ast.unparse, body))


def test_a_reason_of_a_strangers_store_stays_a_text_of_the_script(monkeypatch, reference_alone) -> None:
    shown = checked("mujoco", "static-hold")
    expected = statements(script(shown, reference_alone))
    with opened_store(None) as store:
        text = script(shown, HostileMissing(store, InProcessExecutor()))
    assert statements(text) == expected
    assert "touch run" in ast.get_docstring(ast.parse(text))
    monkeypatch.setattr(MuJoCo, "version", lambda _: CODE + 5000 * "v")
    text = script(shown, reference_alone)
    assert statements(text) == expected
    assert len(text.splitlines()) <= MOST_LINES


def test_a_blocked_number_has_no_script() -> None:
    with opened_store(None) as store, pytest.raises(ParameterError, match="mujoco has no number of '1 kg, load"):
        script(checked("mujoco", "static-hold"), Hostile(store, InProcessExecutor()))


def test_exact_transmittance_is_that_of_the_same_periods_from_rest() -> None:
    question, variant = QUESTIONS["figure3"], Variant("reference")
    with opened_store(None) as store, evaluator(store) as running:
        number = question.number(variant, question.case, running)
    assert number.value == pytest.approx(number.exact, rel=0, abs=OF_THE_STEP)
    assert number.value != number.exact


def test_header_of_figure_3_says_that_it_begins_at_rest(reference_alone) -> None:
    text = script(checked("mujoco:joint:tuned", "figure3"), reference_alone)
    assert "the last of 30 periods from rest" in " ".join(text.splitlines()[:8])


def test_an_engine_without_a_template_is_refused_with_those_that_have_one() -> None:
    with pytest.raises(ParameterError, match=r"reference has no reproducer; allowed: .*mujoco:joint.*pybullet:contact"):
        checked("reference", "static-hold")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("mujoco", "unit-cell"), "scenario = 'unit-cell'.*static-hold"),
        (("mujoco", "static-hold", "2 kg"), "case = '2 kg'.*1 kg, load 0.99"),
        (("mujoko", "static-hold"), "mujoko"),
        (("rapier:joint:native", "static-hold"), "rapier:joint:native has no reproducer"),
        (("mujoco:noslip_iterations=3", "static-hold"), "mujoco:noslip_iterations=3 has no reproducer"),
    ],
)
def test_what_cannot_be_shown_is_named_with_what_can(arguments, message) -> None:
    with pytest.raises(ParameterError, match=message):
        checked(*arguments)


def test_command_of_another_case_names_it() -> None:
    shown = checked("mujoco:joint:default", "static-hold", "1 kg, load 0.5")
    assert shown.command == 'multibody-xval reproduce mujoco:joint:default static-hold "1 kg, load 0.5"'
