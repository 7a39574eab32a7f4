"""The action that guards an engine: its steps are a script, which runs here as the service would run it."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from tests.scenarios.stores import CASE, with_bound, write_store

ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / ".ci/engine_regression"
ACTION = yaml.safe_load((ROOT / "action.yml").read_text())
STEPS = ACTION["runs"]["steps"]
INPUTS = ACTION["inputs"]


def script(folder: Path, *steps: str, **environment: str) -> int:
    """Run steps as the service does: with bash, which ends at the first error; environments are this one."""
    for name in ("before", "now"):
        version = folder / "regression-environments" / name
        version.parent.mkdir(exist_ok=True)
        if not version.is_symlink():
            version.symlink_to(Path(sys.executable).parents[1])
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    own = {**os.environ, "PATH": path, "OUT": "regression", **environment}
    words = ["bash", "-e", "-c", " ".join([str(SCRIPT), *steps])]
    return subprocess.run(words, cwd=folder, env=own, check=False).returncode


def shown(folder: Path) -> str:
    """What a pull request shows."""
    return (folder / "regression/changes.md").read_text()


def test_inputs_reach_the_script_by_the_environment_only() -> None:
    """An input that stood in a command would be run as one."""
    commands = [step for step in STEPS if "run" in step]
    assert not any("${{" in step["run"] for step in commands)
    read = re.findall(r"^# ([A-Z, ]+?)  ", SCRIPT.read_text(), flags=re.MULTILINE)
    assert set().union(*(step["env"] for step in commands)) == {"GH_TOKEN", *", ".join(read).split(", ")}
    assert set(re.findall(r"inputs\.([a-z-]+)", yaml.safe_dump(STEPS))) == set(INPUTS)
    assert all(given.get("required") or "default" in given for given in INPUTS.values())


TOOLS = {
    "gh": '#!/bin/sh\necho "$@" >> calls.txt\ncase "$*" in *--jq*) cat known.txt ;; esac\n',
    "uv": '#!/bin/sh\ncase "$1" in pip) echo "error: No solution found for $*" >&2; exit 1 ;; esac\n',
}
"""Stand for GitHub's program, with the comments that are known and its calls, and for uv without a version."""


def with_tool(folder: Path, name: str) -> str:
    """Write a program, and give the path on which it is found first."""
    (folder / "bin").mkdir()
    (folder / "bin" / name).write_text(TOOLS[name])
    (folder / "bin" / name).chmod(0o700)
    return os.pathsep.join([str(folder / "bin"), os.environ["PATH"]])


@pytest.mark.parametrize(
    ("known", "written"),
    [
        ("", "api repos/a/b/issues/7/comments --field body=@regression/comment.md"),
        ("12\n15\n", "api --method PATCH repos/a/b/issues/comments/12 --field body=@regression/comment.md"),
    ],
    ids=["first", "again"],
)
def test_a_pull_request_has_one_comment_an_engine(tmp_path, known, written) -> None:
    (tmp_path / "known.txt").write_text(known)
    (tmp_path / "regression").mkdir()
    (tmp_path / "regression/changes.md").write_text("## Comparison: the second is not worse\n")
    given = {"ENGINE": "mujoco", "REPOSITORY": "a/b", "REQUEST": "7", "PATH": with_tool(tmp_path, "gh")}
    assert script(tmp_path, "comment", **given) == 0
    asked, *rest = (tmp_path / "calls.txt").read_text().splitlines()
    assert asked.startswith("api repos/a/b/issues/7/comments --paginate --jq .[] | select(.body | startswith(")
    assert rest == [written]
    comment = (tmp_path / "regression/comment.md").read_text()
    assert comment == "<!-- friction of mujoco -->\n## Comparison: the second is not worse\n"


@pytest.mark.slow
def test_a_comparison_fails_for_the_worse_shows_it_and_is_none_without_a_baseline(tmp_path) -> None:
    (tmp_path / "regression").mkdir()
    write_store(tmp_path / "regression/now.sqlite", {CASE: with_bound(1.05)})
    assert script(tmp_path, "before", "compare", ENGINE="mujoco") == 0
    assert shown(tmp_path).startswith("## Comparison: nothing to compare with yet\n")
    for bound, code, says in ((1.01, 1, "1 regressed, 4 unchanged: "), (1.1, 0, "1 improved, 4 unchanged: ")):
        kept = write_store(tmp_path / f"{bound}.sqlite", {CASE: with_bound(bound)})
        given = {"ENGINE": "mujoco", "BASELINE": str(kept), "GITHUB_STEP_SUMMARY": str(tmp_path / f"{bound}.md")}
        assert script(tmp_path, "before", "compare", **given) == code
        assert (tmp_path / f"{bound}.md").read_text() == shown(tmp_path)
        assert shown(tmp_path).startswith(f"## Comparison: the second is {'worse' if code else 'not worse'}\n")
        assert says in shown(tmp_path)
    assert script(tmp_path, "compare", ENGINE="mujoco", STRICT="true") == 1


def test_an_engine_that_cannot_be_had_is_said_and_is_no_regression(tmp_path) -> None:
    given = "mujoco==99; touch injected"
    assert script(tmp_path, "install", ENGINE="mujoco", NOW=given, PATH=with_tool(tmp_path, "uv")) == 2
    assert shown(tmp_path).startswith("## Comparison: not possible\n")
    asked = f"pip install --quiet --python regression-environments/now -- {ROOT} {given}\n"
    assert f"error: No solution found for {asked}" in shown(tmp_path)
    assert not (tmp_path / "injected").exists()
