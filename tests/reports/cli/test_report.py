"""``multibody-xval report``: what it writes, and its exit code."""

from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.reports.cli.report import app
from multibody_xval.scenarios.model import Config
from tests.reports.conftest import kept, spoilt

TOML = """\
engines = ["mujoco", "mujoco:joint:default"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.6, 0.7, 1.1]
[chain]
cells = 3
"""


def test_an_engine_that_is_one_per_cent_off_is_code_1_after_the_page_is_written(
    results, tmp_path: Path, capsys
) -> None:
    store = kept(spoilt(results, Config("mujoco"), 1.01), tmp_path / "own.sqlite")
    assert run_command(app, ["--no-run", "--store", str(store), "--out", str(tmp_path / "out")]) == ExitCode.FAILED
    *lines, last = capsys.readouterr().out.splitlines()
    assert last.endswith(f"{tmp_path / 'out' / 'index.html'})")
    assert any(line.startswith("mujoco:joint:tuned: 3 of 3 numbers deviate") for line in lines)


@pytest.mark.usefixtures("here")
def test_the_report_of_a_sweep_is_whole_and_a_second_one_computes_nothing(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "sweep.toml").write_text(TOML)
    arguments = ["--sweep", str(tmp_path / "sweep.toml"), "--out", str(tmp_path / "out")]
    assert run_command(app, arguments) == ExitCode.DONE
    first = pd.read_csv(tmp_path / "out" / "points.csv")
    assert {"edges.csv", "index.html", "results.sqlite"} <= {file.name for file in (tmp_path / "out").iterdir()}
    monkeypatch.setattr("multibody_xval.scenarios.running.pool.run_batch", lambda _: pytest.fail("a known run is run"))
    assert run_command(app, [*arguments, "--no-run"]) == ExitCode.DONE
    assert run_command(app, arguments) == ExitCode.DONE
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "out" / "points.csv"), first)
