"""The action that guards an engine: its steps are a script, which runs here as the service would run it."""

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

ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / ".ci/engine_regression"
ACTION = yaml.safe_load((ROOT / "action.yml").read_text())
STEPS = ACTION["runs"]["steps"]
INPUTS = ACTION["inputs"]

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
    used = [step["uses"] for step in STEPS if "uses" in step]
    assert used
    assert all(re.fullmatch(r"actions/[a-z-]+(/[a-z]+)?@v\d+", action) for action in used)


def test_inputs_reach_the_script_by_the_environment_only() -> None:
    """An input that stood in a command would be run as one."""
    commands = [step for step in STEPS if "run" in step]
    assert not any("${{" in step["run"] for step in commands)
    read = set(re.findall(r"^# ([A-Z, ]+?)  ", SCRIPT.read_text(), flags=re.MULTILINE))
    variables = {name for names in read for name in names.split(", ")}
    assert set().union(*(step["env"] for step in commands)) == variables | {"GH_TOKEN"}
    used = re.findall(r"inputs\.([a-z-]+)", yaml.safe_dump(STEPS))
    assert set(used) == set(INPUTS)
    assert all(given.get("required") or "default" in given for given in INPUTS.values())


def test_steps_of_the_action_are_those_of_the_script() -> None:
    run = [step["run"] for step in STEPS if "run" in step]
    assert run == ['"$GITHUB_ACTION_PATH/.ci/engine_regression"', '"$GITHUB_ACTION_PATH/.ci/engine_regression" comment']
    assert all(step["shell"] == "bash" for step in STEPS if "run" in step)
    assert SCRIPT.stat().st_mode & 0o100


GH = """#!/bin/sh
echo "$@" >> calls.txt
case "$*" in *--jq*) cat known.txt ;; esac
"""
"""Stands for GitHub's own program: the comments that are known, and a list of its calls."""


def commented(folder: Path, known: str) -> list[str]:
    """Run the step `comment`; give what the service was asked, and write what it was told."""
    (folder / "bin").mkdir()
    (folder / "bin/gh").write_text(GH)
    (folder / "bin/gh").chmod(0o700)
    (folder / "known.txt").write_text(known)
    (folder / "regression").mkdir()
    (folder / "regression/changes.md").write_text("## Engine regression: passes\n")
    path = os.pathsep.join([str(folder / "bin"), os.environ["PATH"]])
    assert script(folder, "comment", ENGINE="mujoco", REPOSITORY="a/b", REQUEST="7", PATH=path) == 0
    return (folder / "calls.txt").read_text().splitlines()


@pytest.mark.parametrize(
    ("known", "written"),
    [
        ("", "api repos/a/b/issues/7/comments --field body=@regression/comment.md"),
        ("12\n15\n", "api --method PATCH repos/a/b/issues/comments/12 --field body=@regression/comment.md"),
    ],
    ids=["first", "again"],
)
def test_a_pull_request_has_one_comment_an_engine(tmp_path, known, written) -> None:
    asked, *rest = commented(tmp_path, known)
    assert asked.startswith("api repos/a/b/issues/7/comments --paginate --jq .[] | select(.body | startswith(")
    assert rest == [written]
    comment = (tmp_path / "regression/comment.md").read_text()
    assert comment == "<!-- friction of mujoco -->\n## Engine regression: passes\n"


def test_the_first_run_on_the_default_branch_has_no_baseline_and_passes(tmp_path) -> None:
    write_store(tmp_path / "regression/now.sqlite", {0.9: at(-9.5)})
    assert script(tmp_path, "before", "compare", ENGINE="mujoco") == 0
    assert shown(tmp_path).startswith("## Engine regression: no baseline yet\n")


@pytest.mark.slow
@pytest.mark.parametrize("baseline", ["main", "kept.sqlite"])
def test_a_store_is_a_baseline(tmp_path, baseline) -> None:
    kept = tmp_path / ("regression/main.sqlite" if baseline == "main" else baseline)
    kept.parent.mkdir(exist_ok=True)
    write_store(kept, {0.9: at(-9.5)})
    write_store(tmp_path / "regression/now.sqlite", {0.9: at(-8.7)})
    summary = tmp_path / "summary.md"
    given = {"ENGINE": "mujoco", "BASELINE": baseline, "GITHUB_STEP_SUMMARY": str(summary)}
    assert script(tmp_path, "before", "compare", **given) == 1
    assert summary.read_text() == shown(tmp_path)
    assert "1 regressed; 1 fail" in shown(tmp_path)


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


@pytest.mark.slow
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


@pytest.mark.parametrize("step", ["install", "before"])
def test_an_engine_that_cannot_be_had_is_said(tmp_path, step) -> None:
    """Without the installation of the suite itself, which takes long."""
    stand_in = tmp_path / "bin"
    stand_in.mkdir()
    (stand_in / "python").write_text("#!/bin/sh\n")
    (stand_in / "python").chmod(0o700)
    path = os.pathsep.join([str(stand_in), str(Path(sys.executable).parent), os.environ["PATH"]])
    assert script(tmp_path, step, ENGINE="mujoco", BASELINE="99", PATH=path) == 2
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
    given = {"ENGINE": "mutant", "BASELINE": before, "NOW": now, "GRID": "grid.toml", "VARIANTS": "joint:tuned"}
    given |= {"GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md")}
    given |= {"PYTHONPATH": install("mutations").environment["PYTHONPATH"]}
    assert script(tmp_path, "before", "now", "compare", **given) == code
    assert direction in (tmp_path / "summary.md").read_text()


@pytest.mark.slow
def test_two_versions_are_compared_in_one_command(tmp_path, install) -> None:
    given = {"PYTHONPATH": install("mutations").environment["PYTHONPATH"]}
    command = "multibody-xval compare --engine mutant@bound@0.01 --engine mutant@bound@0.2 --out changes.md"
    assert run_step(command, tmp_path, **given).returncode == 1
    assert re.search(r"points: \d+ regressed", (tmp_path / "changes.md").read_text())
    assert "From `mutant@bound@0.01` to `mutant@bound@0.2`" in (tmp_path / "changes.md").read_text()


@pytest.mark.slow
def test_an_older_mujoco_is_compared_with_the_one_beside_the_suite(tmp_path) -> None:
    if engine("mujoco@3.3.7").unavailable_reason() is not None:
        pytest.skip("no environment of mujoco@3.3.7")
    (tmp_path / "grid.toml").write_text(TWO_POINTS)
    given = {"ENGINE": "mujoco", "BASELINE": "3.3.7", "GRID": "grid.toml", "VARIANTS": "joint:tuned joint:default"}
    assert script(tmp_path, "before", "now", "compare", **given) == 0
    assert re.search(r"\n\d+ points: none changed; 0 fail", shown(tmp_path))
    assert re.search(r"\n\| mujoco +\| 14 ", shown(tmp_path)), "two steady states and twelve pulls on a block"
    assert "- mujoco: engine mujoco@3.3.7 → mujoco" in shown(tmp_path)
