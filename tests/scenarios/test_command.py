"""``python -m scenarios``, as it is typed."""

import csv
from pathlib import Path

import pytest

from reference_lcp.console import run_command
from scenarios.__main__ import app


def test_experiments_are_listed_with_their_questions(capsys) -> None:
    assert run_command(app, []) == 0
    printed = capsys.readouterr().out
    assert "accuracy" in printed
    assert "cost" in printed


def test_cost_names_adapter_and_bare_loop(capsys) -> None:
    assert run_command(app, ["run", "cost", "--engine", "mujoco:joint"]) == 0
    row = next(line for line in capsys.readouterr().out.splitlines() if line.strip().startswith("mujoco"))
    advance, run, bare, ratio, _ = (float(cell) for cell in row.split()[1:])
    assert ratio == pytest.approx(advance / bare, rel=0.02)
    assert min(advance, run, bare) > 0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--engine", "mujocko"], "engine = 'mujocko' is unknown"),
        (["--engine", "mujoco:glue"], "formulation of mujoco = 'glue' is unknown"),
        (["--out", "table.txt"], "--out = table.txt has the ending '.txt'; allowed: .md or .csv"),
        (["--out", "missing/table.md"], "the folder missing does not exist"),
        (["--workers", "0"], "workers = 0"),
        (["--time-limit", "-1"], "time_limit = -1"),
    ],
)
def test_wrong_input_is_refused_before_any_work(capsys, options, message) -> None:
    assert run_command(app, ["run", "accuracy", *options]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
def test_accuracy_of_the_reference_is_that_of_its_scheme(tmp_path: Path) -> None:
    """First order; below 0.01 dB at the six points, an error that the converged preset does not have."""
    out = tmp_path / "accuracy.csv"
    assert run_command(app, ["run", "accuracy", "--engine", "reference", "--out", str(out), "--no-cost"]) == 0
    tuned, converged = csv.DictReader(out.read_text().splitlines())
    assert float(tuned["points_400_db"]) < 0.01
    assert 0.8 < float(tuned["order"]) < 1.3
    assert int(tuned["missed"]) == int(converged["missed"]) == int(converged["spurious"]) == 0
    assert float(converged["map_db"]) < 0.01 < float(tuned["map_db"])
