"""``multibody-xval compare``: a changed option is found, with its points; equal stores are no change."""

import csv
import dataclasses
import json
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from multibody_xval.reports.export.changes import Regression, changes_markdown
from multibody_xval.scenarios.verdicts.regression import StoreComparison, TruthDirection, change, compare_stores
from multibody_xval.scenarios.verdicts.stored import StoredResult
from multibody_xval.scenarios.verdicts.thresholds import Thresholds

from multibody_xval.engines.interface import variant
from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw, Option, Preset
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.cli.console_script import app
from multibody_xval.scenarios.runs import task
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.steady import run_steady_states
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import RESULT_FORMAT, SteadyStateTask, key_of
from multibody_xval.scenarios.runs.transient_task import Block, BlockTask
from multibody_xval.scenarios.verdicts.proven import proven_level
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, EXACT
from reference_lcp.chain.drives import HarmonicBase, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.errors import ExitCode
from reference_lcp.one_call import exact_steady_state
from reference_lcp.process import run_command

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
    tasks = [
        SteadyStateTask(variant=Variant("softening"), friction_ratio=0.3, frequency_ratio=eta)
        for eta in (0.3, 0.6, 0.9)
    ]
    with monkeypatch.context() as patched, ResultStore(file) as store:
        patched.setattr(task, "engine", lambda _name: engine)
        patched.setattr(variant, "engine", lambda _name: engine)
        task._identity.cache_clear()
        store.keep((own, answered(own, residual_slip_compliance)) for own in tasks)
    task._identity.cache_clear()
    return file


PROVEN = "multibody_xval.scenarios.verdicts.stored.proven_level"


@pytest.fixture(autouse=True)
def nothing_proven(monkeypatch: pytest.MonkeyPatch) -> None:
    """Most numbers here are invented."""
    monkeypatch.setattr(PROVEN, lambda _: None)


@pytest.fixture
def before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    return fill(tmp_path / "before.sqlite", HARD, 0.0, monkeypatch)


def compared(*arguments: object) -> int:
    """Compare by what the stores say of the truth."""
    return run_command(app, ["compare", "--no-exact", *map(str, arguments)])


def know_truth(file: Path, transmittance_db: float, variant: Variant = EXACT) -> None:
    """Add what is true of the points of `fill` to a store."""
    tasks = [
        SteadyStateTask(variant=variant, friction_ratio=0.3, frequency_ratio=eta, steps_per_period=800)
        for eta in (0.3, 0.6, 0.9)
    ]
    with ResultStore(file) as store:
        store.keep(
            (task, dataclasses.replace(answered(task, 0.0), transmittance_db=transmittance_db)) for task in tasks
        )


def test_a_changed_option_is_found_with_the_points_that_it_changed(
    before: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = fill(tmp_path / "now.sqlite", SOFT, 0.5, monkeypatch)
    table = tmp_path / "changes.csv"
    assert compared(before, now, "--out", table) == 1
    printed = capsys.readouterr().out
    assert "softening: option iterations 100 → 1" in printed
    assert "softening: 3 points: 2 changed with the truth unknown, by 0.5 dB at most" in printed
    assert "3 points: 2 changed with the truth unknown; 2 fail" in printed
    table_lines = [line for line in printed.splitlines() if "│" in line or "──" in line or "η_r" in line]
    assert max(map(len, table_lines)) <= 80
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
    assert compared(before, now, "--db", "0.005", "--strict") == 1


def test_a_store_equals_itself(before: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert compared(before, before) == 0
    assert "option" not in capsys.readouterr().out


def test_points_of_one_store_alone_are_counted(before: Path, tmp_path: Path) -> None:
    now = tmp_path / "now.sqlite"
    other = SteadyStateTask(variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=0.9)
    with ResultStore(now) as store:
        store.keep([(other, answered(other, 0.0))])
    assert compared(before, now) == 2
    shutil.copy(before, tmp_path / "first.sqlite")
    with ResultStore(before) as store:
        store.keep([(other, answered(other, 0.0))])
    assert compare_stores(tmp_path / "first.sqlite", before).only_second == {"reference": 1}
    assert [own.direction for own in compare_stores(before, now).changes] == [*[TruthDirection.MISSING] * 3, None]


def results_of(file: Path) -> dict[str, str]:
    """Contents and answers of a store, as JSON."""
    with closing(sqlite3.connect(file)) as connection:
        return dict(connection.execute("SELECT content, answer FROM answers"))


def write_results(file: Path, results: dict[str, str]) -> Path:
    """Write contents and answers into a store."""
    ResultStore(file).close()
    rows = [(key_of(content), content, answer) for content, answer in results.items()]
    with closing(sqlite3.connect(file)) as connection, connection:
        connection.executemany("INSERT INTO answers VALUES (?, ?, ?)", rows)
    return file


def test_results_that_are_lost_fail_and_are_named(before: Path, tmp_path: Path, capsys) -> None:
    results = results_of(before)
    now = write_results(tmp_path / "now.sqlite", dict(list(results.items())[:1]))
    assert compared(before, now, "--out", tmp_path / "changes.csv") == ExitCode.FAILED
    assert "2 missing; 2 fail" in capsys.readouterr().out
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
    assert "3 missing; 3 fail" in capsys.readouterr().out
    rows = list(csv.DictReader((tmp_path / "changes.csv").read_text().splitlines()))
    assert {row["beyond"] for row in rows} == {"converged before, blocked now: crashed in solve()"}
    assert compared(now, before) == ExitCode.DONE
    assert compared(now, now) == ExitCode.DONE
    assert "3 points blocked before, 3 blocked now" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments",
    [
        ["missing.sqlite"],
        ["{}", "--db", "0"],
        ["{}", "--out", "changes.txt"],
        ["{}", "--out", "x.md", "--out", "x.md"],
        ["{}", "--transition", "2"],
    ],
)
def test_wrong_input_is_refused(before: Path, arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert compared(before, *(one.format(before) for one in arguments)) == 2
    assert capsys.readouterr().err.startswith("error: ")


@pytest.mark.parametrize(
    ("truth", "direction", "code"),
    [
        (-4.4, TruthDirection.IMPROVED, ExitCode.DONE),  # 0.6 dB before, 0.1 dB now
        (-4.75, TruthDirection.UNCHANGED, ExitCode.DONE),  # to the other side
        (-5.1, TruthDirection.REGRESSED, ExitCode.FAILED),
        (None, TruthDirection.UNKNOWN, ExitCode.FAILED),
    ],
)
@pytest.mark.parametrize("variant", [EXACT, CONVERGED], ids=["exact", "converged"])
def test_only_what_leads_away_from_the_truth_fails(
    before, tmp_path, monkeypatch, truth, direction, code, variant
) -> None:
    now = fill(tmp_path / "now.sqlite", SOFT, 0.5, monkeypatch)
    if truth is not None:
        know_truth(now, truth, variant)
    assert compared(before, now, "--out", tmp_path / "changes.csv") == code
    rows = list(csv.DictReader((tmp_path / "changes.csv").read_text().splitlines()))
    assert [row["direction"] for row in rows] == ["", direction, direction]
    if truth is not None:
        errors = [float(rows[1][f"error_db_{side}"]) for side in ("before", "now")]
        assert errors == pytest.approx([abs(-5.0 - truth), abs(-4.5 - truth)])
        assert rows[1]["truth"] == ("exact motion" if variant == EXACT else "converged reference")
    assert compared(before, now, "--strict") == ExitCode.FAILED


def test_the_command_computes_exact_motions(before, tmp_path, monkeypatch, capsys) -> None:
    now = fill(tmp_path / "now.sqlite", SOFT, 0.5, monkeypatch)
    assert run_command(app, ["compare", str(before), str(now)]) == ExitCode.FAILED
    assert "3 points: 1 regressed, 1 improved; 1 fail" in capsys.readouterr().out


def test_the_exact_motion_counts_before_the_converged_reference(before, tmp_path, monkeypatch) -> None:
    now = fill(tmp_path / "now.sqlite", SOFT, 0.5, monkeypatch)
    for store in before, now:
        know_truth(store, -4.4)
        know_truth(store, -5.1, CONVERGED)
    assert compared(before, now) == ExitCode.DONE


def test_an_exact_motion_that_no_store_has_is_computed(before, tmp_path, monkeypatch) -> None:
    """The chain transmits +1.3 dB at η_r = 0.6 and −9.6 dB at 0.9: from −5 to −4.5 dB is closer there, farther here."""
    now = fill(tmp_path / "now.sqlite", SOFT, 0.5, monkeypatch)
    changes = compare_stores(before, now, compute=run_steady_states).changes
    at = {own.first.task["frequency_ratio"]: own for own in changes}
    assert [at[eta].direction for eta in (0.3, 0.6, 0.9)] == [None, TruthDirection.IMPROVED, TruthDirection.REGRESSED]
    exact = exact_steady_state(Chain.from_ratios(friction_ratio=0.3), HarmonicBase.from_ratio(Chain.from_ratios(), 0.9))
    assert at[0.9].error_db(at[0.9].second) == pytest.approx(abs(-4.5 - exact.transmittance_db), abs=1e-6)


@pytest.mark.parametrize(
    ("known", "source"), [(None, "proven"), (CONVERGED, "proven level, converged reference")], ids=["alone", "beside"]
)
def test_a_proven_level_is_the_truth_whatever_the_stores_say(before, tmp_path, monkeypatch, known, source) -> None:
    now = fill(tmp_path / "now.sqlite", SOFT, 0.5, monkeypatch)
    if known is not None:
        know_truth(now, -4.4, known)
    monkeypatch.setattr(PROVEN, proven_level)
    at = {own.first.task["frequency_ratio"]: own for own in compare_stores(before, now).changes}
    level = proven_level(SteadyStateTask(variant=EXACT, friction_ratio=0.3, frequency_ratio=0.9))
    assert at[0.9].truth.source == source
    assert at[0.9].error_db(at[0.9].second) == pytest.approx(abs(-4.5 - float(level.transmittance_db)), abs=1e-14)
    assert at[0.9].truth.result.stuck_fraction == (() if known is None else (0.5, 1.0))


def test_a_motion_is_named_by_its_base_and_its_block(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    block = Block(mass=1.0, normal_force=10.0, stiffness=1e3)
    task = BlockTask(
        variant=Variant("mujoco"), block=block, base=StillBase(0.01), time_step=1e-3, steps=100, recorded="slip"
    )
    for file, slip in (("before", 0.0), ("now", 1e-3)):
        with ResultStore(tmp_path / f"{file}.sqlite") as store:
            store.keep([(task, Result(status="finished", series={"slip": (slip,) * 100}))])
    before, now = (tmp_path / f"{file}.sqlite" for file in ("before", "now"))
    assert compared(before, now, "--motion", 0.01) == 0
    assert compared(before, now) == 1
    assert "base: still base, m [kg] 1, λ_N [N] 10, slip [m] 0" in " ".join(capsys.readouterr().out.split())


def test_files_say_what_the_command_says(before, tmp_path, monkeypatch) -> None:
    now = fill(tmp_path / "now.sqlite", SOFT, 0.5, monkeypatch)
    know_truth(now, -5.1)
    outs = [tmp_path / f"changes.{ending}" for ending in ("md", "json", "csv")]
    assert compared(before, now, *(word for out in outs for word in ("--out", out))) == ExitCode.FAILED
    content = json.loads(outs[1].read_text())
    assert (content["passes"], content["failing"], content["regressed"], content["points"]) == (False, 2, 2, 3)
    assert [own["fails"] for own in content["changes"]] == [True, True]
    document = outs[0].read_text()
    assert document.startswith("## Engine regression: fails\n\n3 points: 2 regressed; 2 fail.\n")
    assert "| softening | μ 0.3, η_r 0.6, steps 400 | 0.1 | 0.6 | transmittance +0.5 dB, regressed |" in document
    assert "<details>" not in document


def test_a_document_of_many_changes_folds_them_and_fits_a_comment() -> None:
    """GitHub takes 65,536 characters; all points are in the other formats."""
    task = {
        "steps_per_period": 400,
        "variant": {"engine": "e", "formulation": "joint", "preset_name": "tuned"},
        "friction_ratio": 0.123456,
    }
    results = [Result(status="converged", transmittance_db=level, period=1.0) for level in range(1001)]
    changes = tuple(
        change(
            *(StoredResult(task | {"frequency_ratio": k / 997}, 4, "1", {}, results[at]) for at in (0, k)), Thresholds()
        )
        for k in range(1, 1001)
    )
    document = changes_markdown(Regression(StoreComparison(changes, {}), "a", "b", Thresholds()))
    head, folded = document.split("<details>")
    assert [f"transmittance {k:+.4g} dB" in head for k in (1000, 991, 990)] == [True, True, False]
    assert "<summary>200 more points, and 790 that are not shown</summary>" in folded
    assert len(document) < 65_536
