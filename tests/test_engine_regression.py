"""The workflow that guards an engine: its steps are a script, which runs here as the service would run it."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from engines.interface.registry import engine
from engines.interface.variant import Variant
from scenarios.runs.result import Result
from scenarios.runs.store import ResultStore
from scenarios.runs.task import SteadyStateTask
from scenarios.verdicts.steady_case import EXACT
from tests.junit import checked_junit

ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / ".ci/engine_regression"
WORKFLOW = yaml.safe_load((ROOT / ".github/workflows/engine_regression.yml").read_text())
(JOB,) = WORKFLOW["jobs"].values()
INPUTS = WORKFLOW[True]["workflow_call"]["inputs"]  # YAML 1.1 reads the key `on` as true

TWO_POINTS = "[grid]\nfriction_ratio = [0.3]\nfrequency_ratio = [0.6, 0.9]\n"


def run_step(command: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a step as the service does: with bash, which ends at the first error."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    own = {**os.environ, "PATH": path, "OUT": "regression", **environment}
    return subprocess.run(
        ["bash", "-e", "-c", command], cwd=folder, env=own, capture_output=True, text=True, check=False
    )


def script(folder: Path, *steps: str, **environment: str) -> int:
    done = run_step(" ".join([str(SCRIPT), *steps]), folder, **environment)
    print(done.stdout, done.stderr)
    return done.returncode


def shown(folder: Path) -> str:
    """What a pull request shows."""
    return (folder / "regression/changes.md").read_text()


def test_actions_are_pinned_by_their_major_version() -> None:
    used = [step["uses"] for step in JOB["steps"] if "uses" in step]
    assert used
    assert all(re.fullmatch(r"actions/[a-z-]+@v\d+", action) for action in used)


def test_inputs_reach_the_script_by_the_environment_only() -> None:
    """An input that stood in a command would be run as one."""
    commands = [step["run"] for step in JOB["steps"] if "run" in step]
    assert not any("${{" in command for command in commands)
    read = set(re.findall(r"^# ([A-Z, ]+?)  ", SCRIPT.read_text(), flags=re.MULTILINE))
    variables = {name for names in read for name in names.split(", ")}
    assert set(JOB["env"]) == variables
    used = re.findall(r"inputs\.([a-z-]+)", yaml.safe_dump(JOB))
    assert set(used) == set(INPUTS)
    assert all(INPUTS[name].get("required") or "default" in INPUTS[name] for name in INPUTS)


def test_steps_of_the_workflow_are_those_of_the_script() -> None:
    run = [step["run"] for step in JOB["steps"] if ".ci/engine_regression" in step.get("run", "")]
    assert [command.split()[-1] for command in run] == ["install", "before", "now", "compare"]
    assert SCRIPT.stat().st_mode & 0o100


def write_store(file: Path, results: Mapping[float, Result]) -> None:
    file.parent.mkdir(exist_ok=True)
    exact = Result(status="converged", transmittance_db=-5.0, period=1.0)
    with ResultStore(file) as store:
        for eta, result in results.items():
            task = SteadyStateTask(variant=Variant("mujoco"), friction_ratio=0.3, frequency_ratio=eta)
            store.keep([(task, result), (replace(task, variant=EXACT), exact)])


def at(transmittance_db: float) -> Result:
    return Result(status="converged", transmittance_db=transmittance_db, period=1.0)


CRASHED = Result.blocked("crashed in mj_step()", by_engine=True)


@pytest.mark.parametrize(
    ("before", "now", "code", "says"),
    [
        (at(-9.5), at(-8.7), 1, "## Engine regression: fails\n\n4 points: 1 regressed; 1 fail."),
        (at(-8.7), at(-9.5), 0, "## Engine regression: passes\n\n4 points: 1 improved; 0 fail."),
        (at(-9.5), CRASHED, 1, "converged before, blocked now: crashed in mj_step()"),
        (at(-9.5), None, 1, "converged before, missing now"),
    ],
    ids=["worse", "better", "crashes", "lost"],
)
def test_a_comparison_fails_for_the_worse_and_shows_it(tmp_path, before, now, code, says) -> None:
    """The proven level at η_r = 0.9 is -9.56 dB, whatever the store holds."""
    same = {0.6: at(-5.0)}
    write_store(tmp_path / "regression/before.sqlite", {0.9: before, **same})
    write_store(tmp_path / "regression/now.sqlite", same if now is None else {0.9: now, **same})
    assert script(tmp_path, "compare", ENGINE="mujoco") == code
    assert says in shown(tmp_path)
    assert run_step(f"{SCRIPT} compare", tmp_path, ENGINE="mujoco", STRICT="true").returncode == 1
    checked_junit(tmp_path / "regression/changes.xml", tests=4, failures=2 if now is None else 1)


@pytest.mark.parametrize("step", ["install", "before"])
def test_an_engine_that_cannot_be_had_is_said(tmp_path, step) -> None:
    """Without the installation of the suite itself, which takes long."""
    stand_in = tmp_path / "bin"
    stand_in.mkdir()
    (stand_in / "python").write_text("#!/bin/sh\n")
    (stand_in / "python").chmod(0o700)
    path = os.pathsep.join([str(stand_in), str(Path(sys.executable).parent), os.environ["PATH"]])
    assert script(tmp_path, step, ENGINE="mujoco", BEFORE="99", PATH=path) == 2
    document = shown(tmp_path)
    assert document.startswith("## Engine regression: not compared\n")
    assert "ended with exit code 2" in document
    assert "engine = 'mujoco@99': its adapter does not take that; allowed: mujoco >=3.3.7,<5" in document


def test_a_step_that_there_is_not_is_refused(tmp_path) -> None:
    assert script(tmp_path, "compile", ENGINE="mujoco") == 2
    assert script(tmp_path) == 1  # ENGINE is missing


@pytest.mark.slow
def test_all_formulations_and_presets_are_run_where_none_is_named(tmp_path) -> None:
    (tmp_path / "grid.toml").write_text(TWO_POINTS)
    assert script(tmp_path, "now", ENGINE="mujoco", GRID="grid.toml", VARIANTS="") == 0
    assert 'engines = ["mujoco:all:all", ]' in (tmp_path / "regression/now.toml").read_text()
    with ResultStore(tmp_path / "regression/now.sqlite") as store:
        tasks = [json.loads(content)["task"] for content, _ in store.all_results()]
    assert {task["variant"]["formulation"] for task in tasks} == {"joint", "contact"}
    assert any("block" in task for task in tasks), "a block breaks away too"
    assert script(tmp_path, "now", ENGINE="mujoco", GRID="grid.toml", VARIANTS="joint", SCENARIOS="nowhere") == 2
    assert "No such command 'nowhere'" in shown(tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("before", "now", "code", "direction"),
    [
        ("bound@0.01", "bound@0.2", 1, ": 14 regressed;"),
        ("bound@0.2", "bound@0.01", 0, ": 14 improved;"),
    ],
    ids=["worse", "better"],
)
def test_two_versions_of_an_engine_are_compared_step_by_step(tmp_path, install, before, now, code, direction) -> None:
    """Versions of the reference whose friction bound is 1 % and 20 % too high: two points, twelve pulls on a block."""
    (tmp_path / "grid.toml").write_text(TWO_POINTS)
    (tmp_path / "multibody-xval").symlink_to(ROOT)
    given = {"ENGINE": "mutant", "BEFORE": before, "NOW": now, "GRID": "grid.toml", "VARIANTS": "joint:tuned"}
    given |= {"GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md")}
    given |= {"PYTHONPATH": install("mutations").environment["PYTHONPATH"]}
    steps = [step["run"] for step in JOB["steps"] if "run" in step and not step["run"].endswith("install")]
    codes = [run_step(step, tmp_path, **given).returncode for step in steps]
    assert codes == [0, 0, code, 0]
    assert direction in (tmp_path / "summary.md").read_text()


@pytest.mark.slow
def test_an_older_mujoco_is_compared_with_the_one_beside_the_suite(tmp_path) -> None:
    if engine("mujoco@3.3.7").unavailable_reason() is not None:
        pytest.skip("no environment of mujoco@3.3.7")
    (tmp_path / "grid.toml").write_text(TWO_POINTS)
    given = {"ENGINE": "mujoco", "BEFORE": "3.3.7", "GRID": "grid.toml", "VARIANTS": "joint:tuned joint:default"}
    assert script(tmp_path, "before", "now", "compare", **given) == 0
    assert re.search(r"\n\d+ points: none changed; 0 fail", shown(tmp_path))
    assert re.search(r"\n\| mujoco +\| 14 ", shown(tmp_path)), "two steady states and twelve pulls on a block"
    assert "- mujoco: engine mujoco@3.3.7 → mujoco" in shown(tmp_path)
