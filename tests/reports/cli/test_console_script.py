"""One name for the commands of the packages; the short ones, `engines` and `truth check`."""

import json
import os
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

from multibody_xval.engines.interface.registry import engine_names
from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.engines.pybullet import PyBullet
from multibody_xval.reports.cli.console_script import COMMANDS, app, loaded
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.truth import problem_named


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_is_the_one_of_its_name(name: str) -> None:
    assert loaded(name).name in {name, f"multibody-xval {name}"}


def test_files_of_the_working_folder_do_not_shadow_the_packages(tmp_path: Path) -> None:
    for name in ("multibody_xval", "reference_lcp"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('the file of the working folder')\n")
    script = Path(sys.executable).with_name("multibody-xval")
    found = subprocess.run([script, "engines"], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert found.returncode == 0, found.stderr
    assert "reference" in found.stdout


def test_a_shell_completes_scenarios_and_engines() -> None:
    words = "run unit-cell --engine exudyn"
    variables = {
        "_MULTIBODY_XVAL_COMPLETE": "complete_bash",
        "COMP_WORDS": f"multibody-xval {words}",
        "COMP_CWORD": "4",
    }
    script = Path(sys.executable).with_name("multibody-xval")
    done = subprocess.run([script], capture_output=True, text=True, check=False, env={**os.environ, **variables})
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.split() == ["exudyn-bristle", "exudyn-regularised"]


def test_version_is_that_of_the_distribution(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(app, ["--version"]) == 0
    assert capsys.readouterr().out == f"multibody-xval {metadata.version('multibody-xval')}\n"


def test_json_describes_every_registered_engine(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(app, ["engines", "--json"]) == 0
    rows = {row["engine"]: row for row in json.loads(capsys.readouterr().out)}
    assert list(rows) == engine_names()
    for row in rows.values():
        assert (row["version"] is None) == (row["missing"] is not None)
        assert "tuned" in row["presets"]["joint"]
        assert row["licence"]
    assert rows["mujoco"]["normal_force"]["joint"]["tuned"] == "modulated"
    assert rows["mujoco"]["normal_force"]["contact"]["tuned"] == "modulated until contacts open"


def test_texts_of_a_plugin_neither_colour_nor_move_the_table(capsys, monkeypatch) -> None:
    monkeypatch.setattr(PyBullet, "version", lambda _self: "[red]3\x1b[2J")
    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _self: "no\x1b[2J wheel")
    assert run_command(app, ["engines"]) == 0
    printed = capsys.readouterr().out
    assert "\x1b" not in printed
    assert "[red]3" in printed
    assert r"mujoco: no\x1b[2J wheel" in printed


OFF = 1.23449e-3


def test_what_a_motion_is_off_is_printed_in_four_digits_within_80_columns(tmp_path: Path, monkeypatch, capsys) -> None:
    """A block that is held is off by as much as it is said to have moved."""
    monkeypatch.setenv("COLUMNS", "80")
    problem, file = problem_named("block-held"), tmp_path / "motion.csv"
    rows = [(time, 0.0, 2 * OFF) for time in problem.times[:-1]] + [(problem.times[-1], OFF, 0.0)]
    file.write_text("time,x0,v0\n" + "\n".join(",".join(map(str, row)) for row in rows), encoding="utf-8")
    assert run_command(app, ["truth", "check", "block-held", str(file)]) == ExitCode.FAILED
    printed = capsys.readouterr().out
    assert "0.001234 m " in printed
    assert "0.002469 m/s" in printed
    assert max(map(len, printed.splitlines())) <= 80
