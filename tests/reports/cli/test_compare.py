"""``python -m reports compare``: a changed option is found, with its points; equal stores are no change."""

import csv
import dataclasses
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from engines.interface import variant
from engines.interface.engine import Engine
from engines.interface.presets import Capabilities, Formulation, FrictionLaw, Option, Preset
from engines.interface.variant import Variant
from reference_lcp.console import run_command
from reference_lcp.exit_code import ExitCode
from reference_lcp.refusal import ParameterError
from reports.__main__ import app
from scenarios.execution.store import ResultStore, digest_of
from scenarios.tasks import task
from scenarios.tasks.result import Result
from scenarios.tasks.task import RESULT_FORMAT, SteadyStateTask, key_of
from scenarios.verdicts.regression import StoredResult, change, compare_stores
from scenarios.verdicts.thresholds import Thresholds

SOFT, HARD = Option(1, 5, "soft"), Option(100, 5, "hard")


class Softening(Engine):
    """An engine whose option decides how hard its friction is; its answers are made by `answered`."""

    name = "softening"

    def __init__(self, option: Option):
        preset = Preset("As hard as it says.", {"iterations": option})
        self.capabilities = Capabilities(  # type: ignore[misc]
            title="Softening", package="softening", licence="MIT", friction_law=FrictionLaw.COULOMB,
            presets={Formulation.JOINT: {"tuned": preset}},
        )  # fmt: skip

    def version(self) -> str:
        return "1.0"

    def unavailable_reason(self) -> str | None:
        return None

    def _build(self, *_: object):
        raise NotImplementedError


def answered(task: SteadyStateTask, residual_slip_compliance: float) -> Result:
    """Only where contacts slip is the transmittance changed by their softness."""
    slip = residual_slip_compliance * (task.frequency_ratio > 0.5)
    return Result(
        status="converged", transmittance_db=-5.0 + slip, residual=1e-9, periods=30, steps_per_period=400,
        period=1.0, stuck_fraction=(0.5, 1.0), transitions=((1, 0.2 + slip / 1000, "stick"),),
    )  # fmt: skip


def fill(file: Path, option: Option, residual_slip_compliance: float, monkeypatch: pytest.MonkeyPatch) -> Path:
    engine = Softening(option)
    monkeypatch.setattr(task, "engine", lambda _name: engine)
    monkeypatch.setattr(variant, "engine", lambda _name: engine)
    task._identity.cache_clear()
    with ResultStore(file) as store:
        asked = [
            SteadyStateTask(variant=Variant("softening"), friction_ratio=0.3, frequency_ratio=eta)
            for eta in (0.3, 0.6, 0.9)
        ]
        store.keep((task, answered(task, residual_slip_compliance)) for task in asked)
    task._identity.cache_clear()
    return file


@pytest.fixture
def before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    return fill(tmp_path / "before.sqlite", HARD, 0.0, monkeypatch)


def compared(*arguments: object) -> int:
    return run_command(app, ["compare", *map(str, arguments)])


def test_a_changed_option_is_found_with_the_points_that_it_changed(
    before: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = fill(tmp_path / "now.sqlite", SOFT, 0.5, monkeypatch)
    table = tmp_path / "changes.csv"
    assert compared(before, now, "--out", table) == 1
    printed = capsys.readouterr().out
    assert "softening:joint:tuned: option iterations 100 → 1" in printed
    assert "2 points beyond" in printed
    rows = {row["frequency_ratio"]: row for row in csv.DictReader(table.read_text().splitlines())}
    assert {eta for eta, row in rows.items() if row["beyond"]} == {"0.6", "0.9"}
    assert float(rows["0.6"]["transmittance_db_change"]) == pytest.approx(0.5)
    assert float(rows["0.6"]["transition_change"]) == pytest.approx(0.0005)


def test_a_changed_option_that_changes_nothing_is_named_and_passes(
    before: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = fill(tmp_path / "now.sqlite", SOFT, 0.01, monkeypatch)
    assert compared(before, now) == 0
    assert "option iterations 100 → 1" in capsys.readouterr().out
    assert compared(before, now, "--db", "0.005") == 1


def test_a_store_equals_itself(before: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert compared(before, before) == 0
    assert "option" not in capsys.readouterr().out


def test_points_of_one_store_alone_are_counted(before: Path, tmp_path: Path) -> None:
    now = tmp_path / "now.sqlite"
    other = SteadyStateTask(variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=0.9)
    with ResultStore(now) as store:
        store.keep([(other, answered(other, 0.0))])
    found = compare_stores(before, now)
    assert found.common == []
    assert (found.only_first, found.only_second) == ({"softening:joint:tuned": 3}, {"reference:joint:tuned": 1})
    assert compared(before, now) == 2


@pytest.mark.parametrize(
    ("now", "beyond"),
    [
        ({"status": "period limit"}, "converged before, period limit now"),
        ({"stuck_fraction": (0.5, 0.9)}, "stuck fraction 0.1"),
        ({"transitions": ((1, 0.21, "stick"),)}, "a transition 1 % of the period away"),
        ({"transitions": ()}, "1 transitions without a partner"),
        ({"transitions": ((1, 0.999, "stick"),)}, "2 transitions without a partner"),
    ],
)
def test_every_kind_of_change_passes_its_threshold(now: dict[str, object], beyond: str) -> None:
    task = SteadyStateTask(variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=0.9)
    old = answered(task, 0.0)
    kept = [StoredResult({}, 3, "1", {}, answer) for answer in (old, dataclasses.replace(old, **now))]
    assert beyond in change(*kept, Thresholds()).beyond
    assert change(kept[0], kept[0], Thresholds()).beyond == ()


NAN = float("nan")


@pytest.mark.parametrize(
    ("now", "beyond"),
    [
        ({"transmittance_db": NAN}, "transmittance db is no longer finite"),
        ({"transitions": ((1, NAN, "stick"),)}, "time of a transition is no longer finite"),
        ({"residual": NAN}, "residual is no longer finite"),
        ({"stuck_fraction": (0.5, NAN)}, "stuck fraction is no longer finite"),
        ({"stuck_fraction": ()}, "stuck fraction is no longer complete"),
        ({"series": {"travels": (0.1, float("inf"))}}, "travels is no longer finite"),
        ({"series": {}}, "travels is no longer complete"),
    ],
)
@pytest.mark.parametrize("status", ["converged", "finished"])
def test_numbers_that_are_lost_or_no_longer_finite_pass_every_threshold(status, now, beyond) -> None:
    task = SteadyStateTask(variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=0.9)
    old = dataclasses.replace(answered(task, 0.0), status=status, series={"travels": (0.1, 0.2)})
    stored = [StoredResult({}, 3, "1", {}, result) for result in (old, dataclasses.replace(old, **now))]
    assert beyond in change(*stored, Thresholds(1e3, 1.0, 1.0)).beyond
    if "transitions" not in now:  # NaN has no partner
        assert change(stored[1], stored[1], Thresholds()).beyond == ()


def results_of(file: Path) -> dict[str, str]:
    """Contents and answers of a store, as JSON."""
    with closing(sqlite3.connect(file)) as connection:
        return dict(connection.execute("SELECT content, answer FROM answers"))


def write_results(file: Path, results: dict[str, str]) -> Path:
    """Write contents and answers into a store, signed."""
    ResultStore(file).close()
    rows = [(key_of(content), content, answer) for content, answer in results.items()]
    with closing(sqlite3.connect(file)) as connection, connection:
        connection.executemany(
            "INSERT INTO answers VALUES (?, ?, ?, ?)",
            [(*row, digest_of(*(text.encode() for text in row))) for row in rows],
        )
    return file


def test_results_that_are_lost_fail_and_are_named(before: Path, tmp_path: Path, capsys) -> None:
    results = results_of(before)
    now = write_results(tmp_path / "now.sqlite", dict(list(results.items())[:1]))
    assert compared(before, now, "--out", tmp_path / "changes.csv") == ExitCode.FAILED
    assert "2 points beyond" in capsys.readouterr().out
    rows = list(csv.DictReader((tmp_path / "changes.csv").read_text().splitlines()))
    assert [row["beyond"] for row in rows] == ["", *["converged before, missing now"] * 2]
    assert compared(now, before) == ExitCode.DONE


def test_formats_that_differ_are_refused_with_both(before: Path, tmp_path: Path, capsys) -> None:
    results = results_of(before)
    own, other = f'"format":{RESULT_FORMAT}', f'"format":{RESULT_FORMAT + 1}'
    assert all(own in content for content in results)
    now = write_results(
        tmp_path / "now.sqlite",
        {content.replace(own, other): text for content, text in results.items()},
    )
    assert compared(before, now) == ExitCode.WRONG_INPUT
    message = capsys.readouterr().err
    assert f"{before} has results of format {RESULT_FORMAT}, {now} of format {RESULT_FORMAT + 1}" in message


def test_blocked_now_fails_with_its_reason_blocked_before_does_not(before: Path, tmp_path: Path, capsys) -> None:
    blocked = Result.blocked("crashed in solve()", by_engine=True).to_json()
    results = results_of(before)
    now = write_results(tmp_path / "now.sqlite", dict.fromkeys(results, blocked))
    assert compared(before, now, "--out", tmp_path / "changes.csv") == ExitCode.FAILED
    assert "3 points beyond" in capsys.readouterr().out
    rows = list(csv.DictReader((tmp_path / "changes.csv").read_text().splitlines()))
    assert {row["beyond"] for row in rows} == {"converged before, blocked now: crashed in solve()"}
    assert compared(now, before) == ExitCode.DONE
    assert compared(now, now) == ExitCode.DONE
    shown = capsys.readouterr().out
    assert shown.count("blocked") == 4, "before and now, of two comparisons"


@pytest.mark.parametrize(
    "arguments", [["missing.sqlite"], ["{}", "--db", "0"], ["{}", "--out", "changes.txt"], ["{}", "--transition", "2"]]
)
def test_wrong_input_is_refused(before: Path, arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert compared(before, *(one.format(before) for one in arguments)) == 2
    assert capsys.readouterr().err.startswith("error: ")


def test_thresholds_name_what_is_wrong() -> None:
    with pytest.raises(ParameterError, match=r"threshold of stuck_fraction = 0"):
        Thresholds(stuck_fraction=0)
