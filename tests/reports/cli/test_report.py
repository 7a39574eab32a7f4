"""``multibody-xval report``: what it refuses, what it writes, and its exit code."""

from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.reports.cli.report import app
from multibody_xval.reports.page import sources
from multibody_xval.scenarios.model import Config, Result, Run
from tests.reports.conftest import kept, spoilt

TOML = """\
engines = ["mujoco", "mujoco:joint:default"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.6, 0.7, 1.1]
[chain]
cells = 3
"""


def one_line(capsys: pytest.CaptureFixture[str]) -> str:
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert captured.err.startswith("error: ")
    return captured.err


def refuse(*_arguments: object, **_options: object) -> None:
    raise AssertionError("something was computed")


@pytest.fixture
def no_computation(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sources, "computed", refuse)


@pytest.mark.usefixtures("no_computation")
@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["--no-run", "--store", "nowhere.sqlite"], "nowhere.sqlite is no file"),
        (["--store", "a.sqlite", "--store", "b.sqlite"], "--store is given 2 times"),
        (["--sweep", "{sweep}", "--engine", "mujoco"], "neither --engine nor --quick"),
        (["--data", "{sweep}", "--quick"], "allowed next to it: --out alone"),
        (["--data", "{sweep}"], "the ending '.toml'"),
        (["--no-run", "--quick"], "allowed without it: --quick"),
        (["--sweep", "nowhere.toml"], "nowhere.toml"),
        (["--time-limit", "0"], "time_limit"),
    ],
)
def test_wrong_input_is_refused_and_leaves_no_folder(tmp_path: Path, capsys, arguments, named) -> None:
    file = tmp_path / "sweep.toml"
    file.write_text(TOML)
    asked = [argument.format(sweep=file) for argument in arguments]
    assert run_command(app, [*asked, "--out", str(tmp_path / "out")]) == ExitCode.WRONG_INPUT
    assert named in one_line(capsys)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("factor", "code"), [(1.0, ExitCode.DONE), (1.01, ExitCode.FAILED)])
def test_an_engine_that_is_one_per_cent_off_is_code_1_after_the_page_is_written(
    results: dict[Run, Result], tmp_path: Path, capsys, factor: float, code: ExitCode
) -> None:
    store = kept(spoilt(results, Config("mujoco"), factor), tmp_path / "own.sqlite")
    assert run_command(app, ["--no-run", "--store", str(store), "--out", str(tmp_path / "out")]) == code
    *lines, last = capsys.readouterr().out.splitlines()
    assert last.endswith(f"{tmp_path / 'out' / 'index.html'})")
    assert any(line.startswith("mujoco:joint:tuned: 3 of 3 numbers deviate") for line in lines) == (code == 1)


@pytest.mark.usefixtures("here")
def test_the_report_of_a_sweep_is_whole_and_a_second_one_computes_nothing(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "sweep.toml").write_text(TOML)
    arguments = ["--sweep", str(tmp_path / "sweep.toml"), "--out", str(tmp_path / "out")]
    assert run_command(app, arguments) == ExitCode.DONE
    first = pd.read_csv(tmp_path / "out" / "points.csv")
    assert {"edges.csv", "index.html", "results.sqlite"} <= {file.name for file in (tmp_path / "out").iterdir()}
    monkeypatch.setattr("multibody_xval.scenarios.running.pool.run_batch", refuse)
    assert run_command(app, [*arguments, "--no-run"]) == ExitCode.DONE
    assert run_command(app, arguments) == ExitCode.DONE
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "out" / "points.csv"), first)


@pytest.mark.slow
@pytest.mark.usefixtures("here", "two_points")
def test_the_report_of_an_engine_has_its_three_presets(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--quick", "--engine", "mujoco", "--out", str(tmp_path / "out")]
    assert run_command(app, arguments) == ExitCode.DONE, capsys.readouterr()
    headline = pd.read_csv(tmp_path / "out" / "headline.csv").set_index("title")
    assert list(headline) == ["default options", "recipe", "tuned to the chain"]
    assert headline.loc["MuJoCo, joint"].astype(str).tolist() == ["15", "0.12", "0.12"]
    assert "At one point alone" in (tmp_path / "out" / "index.html").read_text()
