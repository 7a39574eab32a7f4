"""``multibody-xval truth check``: what is printed of a motion that deviates."""

from pathlib import Path

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.scenarios.truth import problem_named
from reference_lcp.errors import ExitCode

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
