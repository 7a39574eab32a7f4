"""``multibody-xval run NAME``: verdicts, measurements, files, exit codes."""

import csv
import json
import math
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.cli.console_script import app
from multibody_xval.scenarios.catalogue.base import Scenario
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.verdict_table import (
    FINDING_COLUMNS,
    VERDICT_FORMATS,
    details,
    matrix,
    rows_of,
    unmodelled,
    verdict_document,
    verdict_table,
)
from multibody_xval.scenarios.runs.task import Recorded, SteadyStateTask
from multibody_xval.scenarios.verdicts.finding import Comparison, Finding, Metric, Prediction, Verdict
from reference_lcp.process import run_command

PITCH = Metric("pitch", "Hz", "how high it is")
RIGHT, LAWFUL, MISSING = Variant("reference"), Variant("mujoco", preset_name="default"), Variant("siconos")


def finding(variant, case, verdict, difference=math.nan, tolerance=math.nan) -> Finding:
    comparison = Comparison(verdict, f"{verdict} | by hand", difference, tolerance)
    return Finding(variant, case, PITCH, 440.0 + difference, 440.0, comparison)


PERIOD = SteadyStateTask(recorded=Recorded.LAW, variant=LAWFUL, friction_ratio=0.3, frequency_ratio=0.9)


class ByHand(Scenario):
    name = "by-hand"
    question = "Is the pitch right?"
    source = "a tuning fork"
    expects = "440 Hz"
    metrics = (PITCH,)
    wrong = LAWFUL

    def parameters(self):
        return ["length = 0.12"]

    def period_tasks(self, variant):
        return {"soft": PERIOD, "loud": PERIOD}

    def run(self, variants, evaluator):
        if variants == [LAWFUL.law]:
            return [finding(LAWFUL.law, case, Verdict.DISAGREE, left) for case, left in (("soft", -3.0), ("loud", 9.0))]
        return [
            finding(RIGHT, "soft", Verdict.AGREE, 0.5, 1.0),
            finding(RIGHT, "loud", Verdict.INCONCLUSIVE),
            finding(self.wrong, "soft", Verdict.DISAGREE, -3.0, 1.0),
            finding(self.wrong, "loud", Verdict.DISAGREE, 9.0, 1.0),
            finding(MISSING, "soft", Verdict.BLOCKED),
        ]


class Interrupted(ByHand):
    def run(self, variants, evaluator):
        raise KeyboardInterrupt


HELD = Prediction(value=449.0, difference=0.0, allowed=1.0, distance=0.0, period_bound=1.0)


def predicted(judged: Finding) -> Finding:
    """Give a finding as its law predicts it, where it has one."""
    return replace(judged, prediction=HELD) if judged.variant == LAWFUL else judged


RESULTS = MappingProxyType({ByHand(): [predicted(judged) for judged in ByHand().run((), None)]})


@pytest.fixture
def run(monkeypatch):
    """Run a command in which another scenario has taken the place of one of the catalogue."""

    def ran(scenario, *options) -> int:
        monkeypatch.setattr(type(CATALOGUE["unit-cell"]), "run", lambda _self, *asked: scenario.run(*asked))
        return run_command(app, ["run", "unit-cell", "--engine", "reference", "--workers", "1", *options])

    return ran


def test_catalogue_is_listed_with_questions_and_what_they_are_compared_with(capsys) -> None:
    assert run_command(app, ["run"]) == 0
    printed = capsys.readouterr().out
    for name in (*CATALOGUE, "accuracy", "work-precision"):
        assert name in printed


def test_a_disagreement_is_as_the_law_of_the_engine_predicts_or_unmodelled(run, capsys) -> None:
    assert run(ByHand()) == 0
    printed = capsys.readouterr().out
    assert "as its law predicts, mujoco:joint:default: friction is a soft constraint with a time constant" in printed
    assert "unmodelled" not in printed
    wrong = ByHand()
    wrong.wrong = Variant("mujoco")
    assert run(wrong) == 1
    assert "unmodelled: 2 disagreements, of mujoco" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "kept"), [((), "nothing is kept without --store"), (("--store", "s.sqlite"), "results are kept in ")]
)
def test_an_interrupted_run_says_what_is_kept(run, capsys, tmp_path, monkeypatch, options, kept) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(Interrupted(), *options) == 130
    assert f"interrupted: {kept}" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "unit-sell"], "No such command 'unit-sell'"),
        (["run", "unit-cell", "--engine", "mujocko"], "engine = 'mujocko' is unknown"),
        (["run", "unit-cell", "--out", "verdicts.txt"], "allowed: .md or .json or .csv"),
        (["run", "unit-cell", "--out", "missing/verdicts.md"], "the folder missing does not exist"),
        (["run", "unit-cell", "--workers", "0"], "workers = 0"),
        (["run", "unit-cell", "--no-run"], "--store is missing; allowed where nothing is run: a store"),
        (["run", "all", "--time-limit", "-1"], "time_limit = -1"),
        (["run", "unit-cell", "--time-limit", "-1"], "time_limit = -1"),
        (["repot"], "No such command 'repot'"),
    ],
)
def test_wrong_input_is_refused_before_any_work(capsys, monkeypatch, arguments, message) -> None:
    monkeypatch.setattr("multibody_xval.scenarios.catalogue.base.run_with_predictions", None)
    assert run_command(app, arguments) == 2
    assert message in capsys.readouterr().err


def test_rows_count_verdicts_and_name_the_worst() -> None:
    right, lawful, _ = rows_of(*RESULTS.values())
    ends = verdict_table(*RESULTS.values())[["worst", "what"]].to_numpy().tolist()
    assert [right.count(verdict) for verdict in Verdict] == [1, 0, 0, 1, 0]
    assert right.outcome == "inconclusive 1/2"
    assert ends[0] == ["0.5", "pitch, soft: agree | by hand"]
    assert lawful.outcome == "modelled 2/2"
    assert ends[1] == ["9", "pitch, loud: disagree | by hand"]
    assert ends[2] == ["–", "blocked | by hand"]
    assert unmodelled(*RESULTS.values()) == []


def test_details_have_one_line_a_metric_and_verdict() -> None:
    remarks = dict(details(*RESULTS.values()))
    law = "its law gives 449, +0 left, allowed 1; after a period 0 U0 from its law, allowed 1"
    assert remarks[LAWFUL] == [f"disagree, pitch, loud: disagree | by hand; {law} (and 1 more)"]
    assert remarks[RIGHT] == ["inconclusive, pitch, loud: inconclusive | by hand"]


def test_matrix_has_variants_as_rows_and_scenarios_as_columns() -> None:
    table = matrix(RESULTS)
    assert list(table.columns) == ["engine:formulation:preset", "by-hand"]
    assert table.to_numpy().tolist() == [
        ["reference", "inconclusive 1/2"],
        ["mujoco:joint:default", "modelled 2/2"],
        ["siconos", "blocked 1/1"],
    ]


def test_document_has_how_it_was_made_laws_parameters_and_reasons() -> None:
    text = verdict_document(RESULTS, "multibody-xval run by-hand")
    assert "`multibody-xval run by-hand`" in text
    assert "- mujoco:joint:default: friction is a soft constraint with a time constant" in text
    assert "- length = 0.12" in text
    assert "pitch, soft: agree \\| by hand" in text
    assert "Versions: mujoco" in text


def test_document_says_first_whether_the_run_fails_and_folds_the_scenarios() -> None:
    passes = verdict_document(RESULTS, "command")
    counted = "5 numbers: 1 agree, 2 disagree, 1 inconclusive, 1 blocked; 2 as their law predicts, 0 fail."
    assert passes.startswith(f"## Verdicts: passes\n\n{counted}\n")
    assert passes.index("| mujoco:joint:default | by-hand | loud | pitch | +9 | 1 |") < passes.index("<details>")
    wrong = ByHand()
    wrong.wrong = Variant("mujoco")
    fails = verdict_document({wrong: wrong.run((), None)}, "command")
    assert fails.startswith("## Verdicts: fails\n")
    assert "\n- by-hand: unmodelled: 2 disagreements, of mujoco\n" in fails
    many = verdict_document({wrong: [finding(RIGHT, str(k), Verdict.DISAGREE, k, 1.0) for k in range(99)]}, "command")
    assert "The 10 largest of 99:" in many
    assert [f"| {k} | pitch |" in many.partition("<details>")[0] for k in (98, 89, 88)] == [True, True, False]


def test_csv_and_json_hold_every_finding_in_full() -> None:
    rows = list(csv.DictReader(VERDICT_FORMATS[".csv"](RESULTS, "command").splitlines()))
    assert list(rows[0]) == [column.key for column in FINDING_COLUMNS]
    assert [float(row["difference"]) for row in rows if row["difference"]] == [0.5, -3.0, 9.0]
    content = json.loads(VERDICT_FORMATS[".json"](RESULTS, "command"))
    assert content["passes"] is True
    assert len(content["findings"]) == 5
    assert content["findings"][4]["allowed"] is None
    assert content["findings"][3]["modelled"] is True
    assert content["scenarios"][0]["parameters"] == ["length = 0.12"]
    wrong = ByHand()
    wrong.wrong = Variant("mujoco")
    fails = json.loads(VERDICT_FORMATS[".json"]({wrong: wrong.run((), None)}, "command"))
    assert fails["passes"] is False


def test_mujoco_agrees_in_the_limits_and_writes_its_verdicts(tmp_path: Path, capsys) -> None:
    out, store = tmp_path / "verdicts.csv", tmp_path / "store.sqlite"
    options = ["--engine", "mujoco:joint", "--workers", "1", "--store", str(store), "--out", str(out)]
    assert run_command(app, ["run", "locked-limit", *options]) == 0
    rows = list(csv.DictReader(out.read_text().splitlines()))
    assert {(row["engine"], row["verdict"]) for row in rows} == {("mujoco", "agree")}
    assert [row["metric"] for row in rows] == ["transmittance", "phase", "same step"] * 2
    assert "locked-limit" in capsys.readouterr().out
    options = ["--engine", "mujoco:all", "--no-run", "--store", str(store), "--out", str(out)]
    assert run_command(app, ["run", "locked-limit", *options]) == 0
    again = list(csv.DictReader(out.read_text().splitlines()))
    assert [row for row in again if (row["formulation"], row["preset"]) == ("joint", "tuned")] == rows
    assert {row["reason"] for row in again if row["formulation"] == "contact"} == {"engine: not evaluated so far"}


@pytest.mark.slow
def test_an_engine_whose_friction_is_a_twentieth_too_strong_is_found_out(install, tmp_path: Path) -> None:
    out = tmp_path / "verdicts.json"
    printed = install("mutations").run(
        "-m", "multibody_xval", "run", "unit-cell", "--engine", "faulty-coefficient:joint", "--out", str(out), code=1
    )
    assert "unmodelled:" in printed
    found = json.loads(out.read_text())["findings"]
    assert {one["case"] for one in found if one["metric"] == "transmittance" and one["verdict"] == "disagree"} == {
        case.label for case in CATALOGUE["unit-cell"].cases
    }
