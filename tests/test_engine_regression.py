"""The action that guards an engine: its steps are a script, which runs here as the service would run it."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from multibody_xval.scenarios.model import failed
from multibody_xval.scenarios.running.evaluate import stored_results
from tests.scenarios.stores import CASE, OTHER, with_bound, write_store

ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / ".ci/engine_regression"
ACTION = yaml.safe_load((ROOT / "action.yml").read_text())
STEPS = ACTION["runs"]["steps"]
INPUTS = ACTION["inputs"]

TWO_POINTS = "[grid]\nfriction_ratio = [0.3]\nfrequency_ratio = [0.6, 0.9]\n"


def run_step(command: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a step as the service does: with bash, which ends at the first error; environments are this one."""
    for name in ("before", "now"):
        version = folder / "regression-environments" / name
        version.parent.mkdir(exist_ok=True)
        if not version.is_symlink():
            version.symlink_to(Path(sys.executable).parents[1])
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
    (tmp_path / "regression").mkdir()
    write_store(tmp_path / "regression/now.sqlite", {CASE: with_bound(1.0)})
    assert script(tmp_path, "before", "compare", ENGINE="mujoco") == 0
    assert shown(tmp_path).startswith("## Engine regression: no baseline yet\n")


@pytest.mark.slow
@pytest.mark.parametrize("baseline", ["main", "kept.sqlite"])
def test_a_store_is_a_baseline(tmp_path, baseline) -> None:
    kept = tmp_path / ("regression/main.sqlite" if baseline == "main" else baseline)
    (tmp_path / "regression").mkdir()
    write_store(kept, {CASE: with_bound(1.01)})
    write_store(tmp_path / "regression/now.sqlite", {CASE: with_bound(1.05)})
    summary = tmp_path / "summary.md"
    given = {"ENGINE": "mujoco", "BASELINE": baseline, "GITHUB_STEP_SUMMARY": str(summary)}
    assert script(tmp_path, "before", "compare", **given) == 1
    assert summary.read_text() == shown(tmp_path)
    assert ": 1 regressed, 4 unchanged: " in shown(tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("before", "now", "code", "says"),
    [
        (with_bound(1.01), with_bound(1.05), 1, ": 1 regressed, 9 unchanged: "),
        (with_bound(1.05), with_bound(1.01), 0, ": 1 improved, 9 unchanged: "),
        (with_bound(1.0), failed("crashed in mj_step()"), 1, "periodic before, failed now: crashed in mj_step()"),
        (with_bound(1.0), None, 1, "periodic before, not run now"),
    ],
    ids=["worse", "better", "crashes", "lost"],
)
def test_a_comparison_fails_for_the_worse_and_shows_it(tmp_path, before, now, code, says) -> None:
    same = {OTHER: with_bound(1.0, OTHER)}
    (tmp_path / "regression").mkdir()
    write_store(tmp_path / "regression/before.sqlite", {CASE: before, **same})
    write_store(tmp_path / "regression/now.sqlite", same if now is None else {CASE: now, **same})
    assert script(tmp_path, "compare", ENGINE="mujoco") == code
    assert says in shown(tmp_path)
    assert shown(tmp_path).startswith(f"## Engine regression: {'fails' if code else 'passes'}\n")
    assert run_step(f"{SCRIPT} compare", tmp_path, ENGINE="mujoco", STRICT="true").returncode == 1


UV = """#!/bin/sh
case "$1" in pip) echo "error: No solution found for $*" >&2; exit 1 ;; esac
"""
"""Stands for uv, which makes environments and has no such version."""


def test_an_engine_that_cannot_be_had_is_said_and_is_no_regression(tmp_path) -> None:
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/uv").write_text(UV)
    (tmp_path / "bin/uv").chmod(0o700)
    path = os.pathsep.join([str(tmp_path / "bin"), os.environ["PATH"]])
    given = "mujoco==99; touch injected"
    assert script(tmp_path, "install", ENGINE="mujoco", NOW=given, PATH=path) == 2
    assert shown(tmp_path).startswith("## Engine regression: not compared\n")
    asked = f"pip install --quiet --python regression-environments/now -- {ROOT} {given}\n"
    assert f"error: No solution found for {asked}" in shown(tmp_path)
    assert not (tmp_path / "injected").exists()


def test_a_step_that_there_is_not_is_refused(tmp_path) -> None:
    assert script(tmp_path, "compile", ENGINE="mujoco") == 2
    assert script(tmp_path) == 1  # ENGINE is missing


@pytest.mark.slow
def test_all_formulations_and_presets_are_run_where_none_is_named(tmp_path) -> None:
    (tmp_path / "grid.toml").write_text(TWO_POINTS)
    assert script(tmp_path, "now", ENGINE="mujoco", GRID="grid.toml", VARIANTS="") == 0
    assert 'engines = ["mujoco:all:all", ]' in (tmp_path / "regression/now.toml").read_text()
    configs = {row.run.config for row in stored_results(tmp_path / "regression/now.sqlite")}
    assert {config.formulation for config in configs if config.engine == "mujoco"} == {"joint", "contact"}
    assert "motion of a block" in {row.run.case.kind for row in stored_results(tmp_path / "regression/now.sqlite")}
    assert script(tmp_path, "before", "compare", ENGINE="mujoco") == 0
    assert re.search(r"\n\d+ points, from .*: \d+ unchanged: both are as close", shown(tmp_path))
