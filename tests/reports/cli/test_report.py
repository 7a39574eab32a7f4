"""``multibody-xval report``: what it refuses, what it writes, what it keeps."""

import errno
import importlib
import json
import os
import sqlite3
import tempfile
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest
from multibody_xval.reports.data import collect
from multibody_xval.reports.data.collect import Scope, expected_tasks
from multibody_xval.reports.export.files import FILES, report_dataset
from multibody_xval.reports.plan import planned_report

from multibody_xval.engines.interface.registry import default_engine_names
from multibody_xval.engines.interface.variant import Variant, variants_of
from multibody_xval.reports import plan
from multibody_xval.reports.cli.report import app
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.runs.evaluator import Evaluator, StoredResults
from multibody_xval.scenarios.runs.local_processes import LocalWorker
from multibody_xval.scenarios.runs.parameters import Excitation
from multibody_xval.scenarios.runs.store import ResultStore, opened_store
from multibody_xval.scenarios.studies.accuracy import task_at
from multibody_xval.scenarios.studies.claims import led_claims_sweep
from multibody_xval.scenarios.studies.figure3 import figure3
from multibody_xval.scenarios.studies.headline import HEADLINE_POINTS, HEADLINE_STEPS, headline_sweep, headline_tasks
from multibody_xval.scenarios.sweeps.compared import compare_sweep
from multibody_xval.scenarios.sweeps.dataset_reader import read_dataset
from multibody_xval.scenarios.sweeps.run import compared_points, save_sweep, stored_points
from multibody_xval.scenarios.sweeps.spec_file import read_sweep
from multibody_xval.scenarios.sweeps.sweep import Case, Sweep
from reference_lcp.errors import ExitCode
from reference_lcp.process import run_command
from tests.scenarios.in_process import evaluator, rub_harder
from tests.scenarios.runs.builders import certified

SMALL = {"friction_ratios": (0.3,), "frequency_ratios": (0.3, 0.6, 0.63, 0.65, 0.7, 0.8, 0.9, 1.1)}


def refuse(*_arguments: object) -> None:
    raise AssertionError("something was computed")


@pytest.fixture
def no_computation(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Evaluator, "evaluate", refuse)


def test_the_default_report_has_every_engine_as_installed_and_tuned_in_every_formulation() -> None:
    """Where no law predicts a default, and in contact, at a few points and without a verdict."""
    planned = planned_report([], None, quick=True, stored_in=None)
    judged = {str(variant) for variant in planned.sweep.variants}
    assert judged >= {"mujoco", "mujoco:joint:default", "pybullet:joint:default", "exudyn-regularised"}
    shown = {str(variant) for variant in planned.scope.beside}
    assert shown >= {"mujoco:contact", "mujoco:contact:default", "exudyn-bristle:joint:default"}
    assert not shown & judged
    every = {str(own) for name in default_engine_names() for own in variants_of(name) if own.engine != "reference"}
    presets = {name for name in every if not name.endswith(":newton")}
    assert presets <= shown | judged
    assert planned.scope.scenarios == ()


def test_the_default_report_begins_with_an_exact_motion_that_compiles_its_solver() -> None:
    """One without friction does not: others would be compiled for side by side, later."""
    planned = planned_report([], None, quick=False, stored_in=None)
    first = expected_tasks(planned.sweep, planned.scope)[0]
    assert (str(first.variant), first.friction_ratio > 0) == ("reference:joint:exact", True)


def test_the_default_report_shows_five_scenarios() -> None:
    scope = planned_report([], None, quick=False, stored_in=None).scope
    assert set(scope.scenarios) < set(CATALOGUE)
    assert len(scope.scenarios) == 5
    named = planned_report(["exudyn-bristle:joint:default"], None, quick=False, stored_in=None).scope
    assert Variant("exudyn-bristle") in named.beside, "beside what is named stand its other presets"


@pytest.fixture
def small_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    def asked(variants: list[Variant], quick: bool) -> Sweep:
        return figure3(tuple(variants), **SMALL)

    importlib.import_module(
        "multibody_xval.reports.write"
    )  # it says of arguments that they are a `Scope`: before that is another one
    monkeypatch.setattr(plan, "_figure3", asked)
    monkeypatch.setattr(collect, "Scope", lambda: Scope(((0.3, 0.9),), (0.3,), (0.6, 0.9), steps=()))


def one_line(capsys: pytest.CaptureFixture[str]) -> str:
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert captured.err.startswith("error: ")
    return captured.err


@pytest.mark.usefixtures("no_computation")
def test_a_folder_that_cannot_hold_the_page_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "index.html").mkdir()
    for out, named in ((tmp_path / "file" / "report", "--out"), (tmp_path, "index.html")):
        assert run_command(app, ["--quick", "--out", str(out)]) == 2
        assert named in one_line(capsys)


@pytest.mark.usefixtures("no_computation")
def test_a_folder_that_cannot_be_written_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(**_arguments: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(tempfile, "TemporaryFile", full)
    assert run_command(app, ["--quick", "--out", str(tmp_path)]) == 2
    assert "No space left on device" in one_line(capsys)


@pytest.mark.usefixtures("no_computation")
def test_a_store_of_another_program_is_refused_and_left_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    foreign = tmp_path / "foreign.sqlite"
    with sqlite3.connect(foreign) as connection:
        connection.execute("CREATE TABLE notes (text TEXT)")
    connection.close()
    before = foreign.read_bytes()
    assert run_command(app, ["--quick", "--out", str(tmp_path), "--store", str(foreign)]) == 2
    assert "another program" in one_line(capsys)
    assert foreign.read_bytes() == before


@pytest.mark.slow
@pytest.mark.usefixtures("small_grid")
def test_a_second_run_answers_from_the_store(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    arguments = ["--engine", "reference", "--workers", "1", "--out", str(tmp_path)]
    assert run_command(app, arguments) == 0
    *_, last = capsys.readouterr().out.splitlines()
    assert last.startswith("passed: 0 agree, "), "the reference is not compared with itself"
    assert last.endswith(str(tmp_path / "index.html"))
    first = {file.name: file.read_text() for file in tmp_path.glob("*.csv")}
    assert {file.name for file in tmp_path.iterdir()} == {*FILES, "figures", "results.sqlite"}
    figures = {file.name for file in (tmp_path / "figures").iterdir()}
    assert figures >= {"figure3.svg", "figure3.pdf", "hysteresis-0.3-0.9.svg", "stick-slip-0.3-0.9.pdf"}

    monkeypatch.setattr(LocalWorker, "run", refuse)
    assert run_command(app, arguments) == 0
    assert {file.name: file.read_text() for file in tmp_path.glob("*.csv")} == first
    assert json.loads((tmp_path / "report.json").read_text())["provenance"]["command"] == (
        "multibody-xval report --engine reference"
    )


@pytest.mark.usefixtures("small_grid")
def test_an_interrupted_run_says_that_answers_are_kept_and_writes_no_page(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_arguments: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(LocalWorker, "run", interrupt)
    assert run_command(app, ["--engine", "reference", "--out", str(tmp_path)]) == 130
    assert f"kept in {tmp_path / 'results.sqlite'}" in capsys.readouterr().err
    assert {file.name for file in tmp_path.iterdir() if file.is_file()} == {"results.sqlite"}


SWEEP = """\
engines = ["mujoco:joint"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.6, 0.62, 0.63, 0.64, 0.65, 0.9]
"""


@pytest.fixture
def stopped(tmp_path: Path) -> list[str]:
    """A sweep that was stopped after two of its six points."""
    (tmp_path / "sweep.toml").write_text(SWEEP)
    asked = planned_report([], tmp_path / "sweep.toml", quick=False, stored_in=None).sweep
    with ResultStore(tmp_path / "sweep.sqlite") as store:
        tasks = [asked.task(Variant("mujoco"), Case.of(friction_ratio=0.3), eta) for eta in (0.6, 0.9)]
        store.keep((task, certified(7, transmittance_db=-1.0)) for task in tasks)
    files = {"--sweep": "sweep.toml", "--store": "sweep.sqlite", "--out": "out"}
    return [word for option, name in files.items() for word in (option, str(tmp_path / name))]


@pytest.mark.slow
def test_a_sweep_that_was_stopped_is_shown_as_far_as_it_went(
    stopped: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(LocalWorker, "run", refuse)
    before = (tmp_path / "sweep.sqlite").read_bytes()
    assert run_command(app, [*stopped, "--no-run"]) == 0
    page = (tmp_path / "out" / "index.html").read_text()
    assert "16 points of the grid are not evaluated so far" in page  # 4 of MuJoCo, 6 of the reference, 6 converged
    assert "engine: not evaluated so far" in page
    assert "reference: not evaluated so far" in page
    assert 'id="friction_map"' not in page, "no point of it is evaluated"
    table = (tmp_path / "out" / "transmittance.csv").read_text()
    assert table.count("mujoco,joint,tuned,0.3,0.6,converged,-1.0") == 1
    assert (tmp_path / "sweep.sqlite").read_bytes() == before


@pytest.mark.slow
def test_a_fuller_page_is_not_overwritten_by_what_a_store_holds(
    stopped: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(app, [*stopped, "--no-run"]) == 0
    page = (tmp_path / "out" / "index.html").read_bytes()
    asked = planned_report([], tmp_path / "sweep.toml", quick=False, stored_in=None).sweep
    with ResultStore(tmp_path / "empty.sqlite") as store:
        save_sweep(store, asked)
    capsys.readouterr()
    lesser = [*stopped[:2], "--store", str(tmp_path / "empty.sqlite"), *stopped[4:], "--no-run"]
    assert run_command(app, lesser) == 2
    assert "of mujoco 2 points for 0; allowed: another --out, or without --no-run" in one_line(capsys)
    assert (tmp_path / "out" / "index.html").read_bytes() == page
    assert run_command(app, [*stopped, "--no-run"]) == 0, "as much as before is no less"


@pytest.mark.slow
def test_a_store_alone_is_shown_with_all_engines_that_were_saved(
    stopped: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = planned_report([], tmp_path / "sweep.toml", quick=False, stored_in=None).sweep
    pybullet = replace(asked, variants=(Variant("pybullet"),))
    elsewhere = replace(asked, axes={**asked.axes, "friction_ratio": (0.1, 0.2)}, variants=(Variant("drake"),))
    with ResultStore(tmp_path / "sweep.sqlite") as store:
        for noted in (elsewhere, asked, pybullet):
            save_sweep(store, noted)
    assert run_command(app, ["--no-run", *stopped[2:]]) == 0
    captured = capsys.readouterr()
    line = "not shown: the store also has 2 of friction_ratio, 6 of frequency_ratio, of drake; --sweep FILE shows them"
    assert line in captured.err
    origin = json.loads((tmp_path / "out" / "report.json").read_text())["provenance"]
    assert {each["engine"] for each in origin["variants"]} == {"reference", "mujoco", "pybullet"}
    assert origin["command"] == f"multibody-xval report --no-run --store {tmp_path / 'sweep.sqlite'}"


def test_a_store_alone_is_shown_with_presets_at_the_headlines_points_that_it_has_of_them(stopped: list[str]) -> None:
    """As the report that filled it showed them; what was never run is not shown as missing."""
    file = Path(stopped[3])
    asked = planned_report([], Path(stopped[1]), quick=False, stored_in=None).sweep
    installed = Variant("mujoco", "contact", "default")
    with ResultStore(file) as store:
        save_sweep(store, asked)
        task = task_at(installed, HEADLINE_POINTS[0], HEADLINE_STEPS)
        store.keep([(task, certified(7, transmittance_db=-1.0))])
    planned = planned_report([], None, quick=False, stored_in=file)
    with ResultStore(file) as store:
        shown = collect.collect(planned.sweep, store, StoredResults(store), "", scope=planned.scope)
    assert [(point.variant, point.frequency_ratio) for point in shown.headline] == [(installed, 1.4)]


PUSHED = """\
engines = ["reference:joint", "mujoco:joint", "mujoco:joint:default"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.6, 0.9]
[drive]
kind = "force"
amplitude = 10.0
[tolerances]
transmittance_db = 0.1
"""
"""Driven by a force, with a tolerance that a default keeps at one of the points only."""


@pytest.mark.slow
def test_a_report_of_a_sweep_has_its_drive_and_judges_by_its_tolerance(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scope = Scope(((0.3, 0.9),), (0.3,), (0.6, 0.9), steps=())
    monkeypatch.setattr(collect, "Scope", lambda: scope)
    file, store = tmp_path / "sweep.toml", tmp_path / "results.sqlite"
    file.write_text(PUSHED)
    arguments = ["--sweep", str(file), "--store", str(store), "--out", str(tmp_path / "out"), "--workers", "1"]
    assert run_command(app, arguments) == 0
    read = read_sweep(file)
    with ResultStore(store) as kept:
        asked = {(q.variant, q.frequency_ratio): q for q in read.tasks()}
        found = {place: kept.find(task) for place, task in asked.items()}
        whole, points = stored_points(read, kept)
        compared = compared_points(whole, points)
        expected = {v: Counter(str(point.comparison.verdict) for point in own) for v, own in compared.items()}
    with sqlite3.connect(store) as connection:
        contents = [json.loads(text)["task"] for (text,) in connection.execute("SELECT content FROM answers")]
    connection.close()
    # everything that was asked, map and lines of the reference among it, is about the force
    assert all(one["excitation"] == {"kind": "force", "amplitude": 10.0} for one in contents)
    recorded = [one for one in contents if one.get("recorded") not in (None, "law")]
    assert len(recorded) == len(read.variants)
    written = json.loads((tmp_path / "out" / "report.json").read_text())
    names = ("engine", "formulation", "preset")
    rows = {(Variant(*(row[n] for n in names)), row["frequency_ratio"]): row for row in written["transmittance"]}
    assert all(rows[place]["transmittance_db"] == answer.transmittance_db for place, answer in found.items())
    assert found[Variant("reference"), 0.6].transmittance_db == pytest.approx(-0.152416, abs=1e-6)  # base: -0.151560
    for variant, counted in expected.items():
        own = [row["verdict"] for (whose, eta), row in rows.items() if whose == variant and (whose, eta) in asked]
        assert Counter(own) == counted
    assert {verdict for counted in expected.values() for verdict in counted} == {"agree", "disagree"}
    origin = written["provenance"]
    assert (origin["drive"]["kind"], origin["drive"]["amplitude"]) == ("force", 10.0)
    assert origin["tolerances"]["given"] == {"transmittance_db": 0.1, "baseline": "reference"}
    page = (tmp_path / "out" / "index.html").read_text()
    assert "driven by a harmonic force on the outer mass of cell 1 (P<sub>0</sub> = 10 N" in page
    assert "0.1 dB of transmittance from reference, the tolerance of the sweep" in page
    assert "on a base that moves" not in page


TWO_CELLS = """\
engines = ["reference:joint"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.6, 0.9]
[chain]
cells = 2
"""


@pytest.mark.usefixtures("no_computation")
@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--quick"], "7 of 11 (friction 0), 11 of 12 (friction 0.3), 9 of 12 (friction 1)"),
        (["--sweep", "{sweep}"], ""),
    ],
)
def test_what_is_proven_of_the_grid_is_said_before_anything_is_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], said: str
) -> None:
    """Of two cells, nothing is."""
    (tmp_path / "sweep.toml").write_text(TWO_CELLS)
    arguments = [part.format(sweep=tmp_path / "sweep.toml") for part in options]
    assert run_command(app, [*arguments, "--out", str(tmp_path / "out")]) == ExitCode.UNEXPECTED
    *first, fault = capsys.readouterr().err.splitlines()
    assert first == [f"proven: frequency ratios that the exact motion attenuates: {said}"] * bool(said)
    assert fault.startswith("error: ")


@pytest.mark.slow
def test_truths_of_other_points_are_proven_on_demand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two cells, which the table of proven levels does not have."""
    pytest.importorskip("flint", reason="python-flint is not installed")
    monkeypatch.setattr(plan, "Scope", lambda: Scope((), (0.3,), (0.6, 0.9), steps=(), checked=0))
    (tmp_path / "sweep.toml").write_text(TWO_CELLS)
    command = ["--sweep", str(tmp_path / "sweep.toml"), "--out", str(tmp_path / "out"), "--workers", "1"]
    for options, proven in (([], 0), (["--proof"], 1)):
        assert run_command(app, [*command, *options]) == 0
        data = read_dataset(tmp_path / "out" / "report.nc")
        assert set(data.truth_proven.values.ravel().tolist()) == {proven}
    at = data.truth_db.sel(friction_ratio=0.3, frequency_ratio=0.6)
    assert float(at) == pytest.approx(1.69877440905827, abs=1e-13)
    page = (tmp_path / "out" / "index.html").read_text()
    assert f"of which {data.truth_db.size} are <b>proven</b>" in page
    assert json.loads((tmp_path / "out" / "report.json").read_text())["provenance"]["command"].endswith(" --proof")


def test_the_step_study_of_a_report_is_about_the_drive_of_its_sweep(tmp_path: Path) -> None:
    (tmp_path / "sweep.toml").write_text(PUSHED)
    asked = planned_report([], tmp_path / "sweep.toml", quick=False, stored_in=None).sweep
    expected = expected_tasks(asked, Scope())
    assert {task.steps_per_period for task in expected} >= {50, 100, 200, 400, 800, 1600}
    assert {task.excitation for task in expected} == {Excitation(kind="force", amplitude=10.0)}


def test_headline_and_claims_are_begun_with_the_grid_and_what_may_never_settle_is_not_left_to_the_end() -> None:
    planned = planned_report([], None, quick=True, stored_in=None)
    expected = expected_tasks(planned.sweep, planned.scope)
    headline = headline_tasks(headline_sweep((*planned.sweep.variants, *planned.scope.beside)))
    assert set(headline.values()) <= set(expected)
    assert set(led_claims_sweep(planned.sweep, planned.scope.claims).tasks()) <= set(expected)
    unsettled = [number for number, task in enumerate(expected) if task.variant in planned.scope.beside]
    assert 2 * max(unsettled) < len(expected)


@pytest.mark.usefixtures("no_computation")
@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["--no-run", "--store", "nowhere.sqlite"], "nowhere.sqlite does not exist"),
        (["--sweep", "{sweep}", "--quick"], "neither --engine nor --quick"),
        (["--data", "{sweep}", "--quick"], "neither --sweep, --engine nor --quick"),
        (["--data", "{sweep}"], "allowed: .nc, .toml or .sqlite"),
        (["--sweep", "nowhere.toml"], "nowhere.toml"),
        (["--engine", "mujocco"], "mujocco"),
        (["--workers", "0"], "workers"),
        (["--workers", "two"], "workers"),
    ],
)
def test_wrong_input_is_refused_and_leaves_no_folder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], named: str
) -> None:
    file = tmp_path / "sweep.toml"
    file.write_text(SWEEP)
    asked = [argument.format(sweep=file) for argument in arguments]
    assert run_command(app, [*asked, "--out", str(tmp_path / "out")]) == 2
    assert named in one_line(capsys)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_an_unmodelled_disagreement_is_code_1_after_the_page_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rub_harder(monkeypatch, 1.1)
    planned = figure3((Variant("mujoco"),), (0.3,), (0.6, 0.9))
    with opened_store(None) as kept:
        data = report_dataset(compare_sweep(planned, evaluator(kept)))
    for name, part, code in (
        ("wrong", data, ExitCode.FAILED),
        ("right", data.sel(variant=["reference:joint:converged", "reference"]), ExitCode.DONE),
    ):
        file, out = tmp_path / f"{name}.nc", tmp_path / name
        part.to_netcdf(file, engine="h5netcdf")
        assert run_command(app, ["--data", str(file), "--out", str(out)]) == code
        lines = capsys.readouterr().out.splitlines()
        assert (out / "index.html").is_file()
        assert any(line.endswith(str(out / "index.html")) for line in lines)
        assert any(line.split()[:1] == ["MuJoCo"] for line in lines) == (code == ExitCode.FAILED)
        assert any(line.startswith("unmodelled:") for line in lines) == (code == ExitCode.FAILED)
