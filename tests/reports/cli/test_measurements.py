"""``multibody-xval run``, as it is typed."""

import csv
from pathlib import Path

import pytest

from reference_lcp.process import run_command
from reports.cli.console_script import app
from scenarios.runs.executor import InProcessExecutor
from scenarios.studies import cost as module


def test_experiments_are_listed_with_their_questions(capsys) -> None:
    assert run_command(app, ["run"]) == 0
    printed = capsys.readouterr().out
    assert "accuracy" in printed
    assert "cost" in printed


def test_cost_of_a_step_is_shared_by_the_lanes_of_a_batch(tmp_path: Path) -> None:
    out = tmp_path / "batches.csv"
    lanes = [f"--lanes={count}" for count in (1, 16)]
    assert run_command(app, ["run", "cost", "--engine", "reference:joint:tuned", *lanes, "--out", str(out)]) == 0
    with out.open() as file:
        alone, shared = csv.DictReader(file)
    assert (alone["lanes"], shared["lanes"]) == ("1", "16")
    # Without a kernel of its own for many chains, each would cost what one costs: here it is a tenth.
    assert 0 < float(shared["advance [µs]"]) < float(alone["advance [µs]"])


def test_cost_is_that_of_steps_and_of_steady_states_beside_the_reference(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "executor_for", lambda _workers: InProcessExecutor())
    out = tmp_path / "cost.csv"
    assert run_command(app, ["run", "cost", "--engine", "mujoco:joint", "--seconds", "0.1", "--out", str(out)]) == 0
    row = {
        name: value for name, value in next(csv.DictReader(out.read_text().splitlines())).items() if name != "variant"
    }
    cost = {name: float(value) for name, value in row.items()}
    assert min(cost.values()) > 0
    assert cost["advance / bare"] == pytest.approx(cost["advance [µs]"] / cost["bare [µs]"])
    assert cost["cell-step [ns]"] == pytest.approx(1000 * cost["advance [µs]"] / 7)
    assert cost["speed-up"] == pytest.approx(cost["point [ms]"] / cost["two workers [ms]"])
    assert cost["certified"] == cost["points"] >= 4
    # a point takes its periods' steps, and no engine's step is as cheap as the reference's in SIMD lanes
    assert cost["point [ms]"] > 0.5e-3 * cost["periods"] * 400 * cost["advance [µs]"]
    assert cost["step / reference"] > 1


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
    assert run_command(app, ["run", "accuracy", "--engine", "reference:all:all", "--out", str(out), "--no-cost"]) == 0
    tuned, converged = csv.DictReader(out.read_text().splitlines())
    assert float(tuned["points_400_db"]) < 0.01
    assert 0.8 < float(tuned["order"]) < 1.3
    assert int(tuned["missed"]) == int(converged["missed"]) == int(converged["spurious"]) == 0
    assert float(converged["map_db"]) < 0.01 < float(tuned["map_db"])
