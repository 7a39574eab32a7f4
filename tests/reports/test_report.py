"""A report in one call: of a sweep over anything, of its dataset, of a part of it, of a file, of a store."""

import json
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from multibody_xval.reports import report, write
from multibody_xval.reports.data.collect import Scope, collect, collect_dataset
from multibody_xval.reports.data.points import NAMES, POINT_COLUMNS
from multibody_xval.reports.data.report import Report
from multibody_xval.reports.export.files import files_of, report_dataset
from multibody_xval.reports.page.render import FIGURES
from multibody_xval.reports.plan import planned_report
from multibody_xval.reports.write import check_folder, write_sweep_report
from multibody_xval.scenarios.runs.evaluator import Evaluator, StoredResults
from multibody_xval.scenarios.runs.executor import InProcessExecutor, run_batch
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.studies.figure3 import figure3
from multibody_xval.scenarios.studies.work_precision import exact_step_tasks, step_tasks
from multibody_xval.scenarios.sweeps.compared import ComparedSweep, compare_sweep
from multibody_xval.scenarios.sweeps.dataset import sweep_dataset
from multibody_xval.scenarios.sweeps.dataset_reader import DatasetResults
from multibody_xval.scenarios.sweeps.point import tasks_of
from multibody_xval.scenarios.sweeps.run import save_sweep, saved_sweeps, stored_points
from multibody_xval.scenarios.sweeps.spec_file import read_sweep
from multibody_xval.scenarios.sweeps.sweep import Case, Sweep
from multibody_xval.scenarios.sweeps.truths import with_truths
from multibody_xval.scenarios.tables import json_text, records
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from reference_lcp.errors import ParameterError

CONTENT = """\
engines = ["reference:joint", "reference:joint:converged", "mujoco:joint", "mujoco:joint:default"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.6, 0.9]
mass_ratio = [0.5, 1.0]
cells = [1, 2]
[drive]
kind = "force"
amplitude = 5.0
"""


@pytest.fixture(scope="module")
def sweep(tmp_path_factory: pytest.TempPathFactory) -> Sweep:
    file = tmp_path_factory.mktemp("file") / "sweep.toml"
    file.write_text(CONTENT)
    return read_sweep(file)


@pytest.fixture(scope="module")
def store(sweep: Sweep, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of every point, and of those with other numbers of steps."""
    file = tmp_path_factory.mktemp("store") / "results.sqlite"
    with ResultStore(file) as kept:
        for task in tasks_of(sweep, list(sweep.grid_points())):
            kept.keep([(task, run_batch([task])[0])])
        save_sweep(kept, sweep)
    return file


@pytest.fixture(scope="module")
def data(sweep: Sweep, store: Path) -> xr.Dataset:
    with ResultStore(store) as kept:
        return sweep_dataset(*stored_points(sweep, kept), store)


@pytest.fixture(scope="module")
def result(sweep: Sweep, store: Path) -> ComparedSweep:
    with ResultStore(store) as kept:
        return compare_sweep(sweep.with_reference(), StoredResults(kept))


def test_dataset_says_what_its_numbers_are(data: xr.Dataset, sweep: Sweep) -> None:
    assert data.transmittance_db.attrs["units"] == "dB"
    assert data.status.attrs["flag_meanings"].split() == ["converged", "period_limit", "diverged", "blocked", "missing"]
    assert (data.attrs["drive_kind"], data.attrs["drive_amplitude"]) == ("force", 5.0)
    assert data.attrs["damping_ratio"] == 0.01
    assert not {"cells", "mass_ratio"} & data.attrs.keys(), "what is varied is a coordinate"
    assert data.attrs["store"] == "results.sqlite"
    variants = json.loads(data.attrs["variants"])
    assert variants["mujoco"]["package"] == "mujoco"
    assert {option["name"] for option in variants["mujoco"]["options"]} >= {"solver", "noslip_iterations"}
    short = data.stuck_fraction.sel(cells=1)
    assert bool(short.isel(cell=1).isnull().all())
    assert bool(short.isel(cell=0).notnull().all())
    assert bool(data.step_error_db.sel(variant="reference").notnull().all())
    assert bool(data.step_error_db.sel(variant="mujoco").isnull().all()), "it shares the reference's error"


def test_results_out_of_a_file_are_those_of_the_store(
    data: xr.Dataset, sweep: Sweep, store: Path, tmp_path: Path
) -> None:
    data.to_netcdf(tmp_path / "sweep.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "sweep.nc", engine="h5netcdf") as read:
        xr.testing.assert_equal(read, data)
        results = DatasetResults(read)
    tasks = list(sweep.tasks())
    names = ("status", "transmittance_db", "residual", "periods", "period", "stuck_fraction", "transitions")
    assert results.sweep == sweep
    with ResultStore(store) as kept:
        for ours, theirs in zip(results.evaluate(tasks), StoredResults(kept).evaluate(tasks), strict=True):
            for name in names:
                assert getattr(ours, name) == getattr(theirs, name)


def test_report_of_a_dataset_has_the_verdicts_of_the_store(data: xr.Dataset, result: ComparedSweep) -> None:
    read = collect_dataset(data, "")

    def rows(report: Report) -> list[dict[str, Any]]:
        return json.loads(json_text(records(report.points[[*NAMES, *result.sweep.case_axes, *POINT_COLUMNS]])))

    found = rows(read)
    places = {
        (row["engine"], row["preset"], row["mass_ratio"], row["cells"], row["frequency_ratio"]): row for row in found
    }
    expected = [row for row in rows(Report(with_truths(result), "")) if row["verdict"] != "inconclusive"]
    assert len(expected) > 12
    for row in expected:
        assert places[row["engine"], row["preset"], row["mass_ratio"], row["cells"], row["frequency_ratio"]] == row


def test_part_of_a_dataset_is_reported_by_itself(data: xr.Dataset) -> None:
    part = collect_dataset(data.sel(mass_ratio=1.0, variant=["reference", "mujoco"]), "").result
    assert part.cases == tuple(Case.of(friction_ratio=0.3, mass_ratio=1.0, cells=cells) for cells in (1, 2))
    assert {str(point.variant) for point in part.points} == {"reference", "mujoco"}
    assert {str(point.comparison.verdict) for point in part.points_of(part.sweep.variants[1])} == {"agree"}


@pytest.mark.slow
def test_report_of_a_sweep_over_more_than_friction_names_its_cases(data: xr.Dataset, tmp_path: Path) -> None:
    page = report(data, tmp_path / "report")
    assert page == tmp_path / "report" / "index.html"
    text = page.read_text()
    assert "Friction ratio 0.3, mass ratio 0.5, cells 2" in text
    assert "friction ratio, mass ratio, number of cells" in text
    assert "driven by a harmonic force" in text
    assert "They are not known: a dataset holds the points of its grid" in text
    for absent in ("Friction and frequency", "Work and precision"):
        assert f"<h2>{absent}</h2>" not in text
    header = (tmp_path / "report" / "transmittance.csv").read_text().splitlines()[0]
    assert header.startswith("engine,formulation,preset,friction_ratio,mass_ratio,cells,frequency_ratio,")


def test_dataset_of_a_report_can_be_reported(result: ComparedSweep) -> None:
    again = collect_dataset(report_dataset(result), "").result
    ours, theirs = (sorted(repr(point.findings) for point in each.points) for each in (again, result))
    assert ours == theirs


def test_store_knows_its_sweep(sweep: Sweep, store: Path, tmp_path: Path) -> None:
    assert saved_sweeps(store).sweep == sweep
    with ResultStore(tmp_path / "other.sqlite"):
        pass
    with pytest.raises(ParameterError, match="holds no sweep"):
        report(tmp_path / "other.sqlite", tmp_path / "report")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("data.xlsx", "allowed: .nc, .toml or .sqlite"),
        ("none.nc", "none.nc cannot be read"),
        ("none.toml", "cannot be"),
    ],
)
def test_what_is_no_data_is_refused_before_a_folder_is_made(name: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match=message):
        report(tmp_path / name, tmp_path / "report")
    assert not (tmp_path / "report").exists()


def test_dataset_that_is_none_of_a_sweep_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match="no attribute 'sweep'"):
        report(xr.Dataset({"a": ("x", [1.0])}), tmp_path / "report")


ADAPTIVE = """\
engines = ["mujoco:joint"]
[grid]
friction_ratio = [0.3]
frequency_ratio = { first = 0.5, last = 1.5, accuracy_db = 3.0, least_spacing = 0.01 }
[chain]
cells = 2
"""


@pytest.mark.slow
def test_adaptive_frequencies_are_those_of_all_curves_together(tmp_path: Path) -> None:
    file, store = tmp_path / "sweep.toml", tmp_path / "results.sqlite"
    file.write_text(ADAPTIVE)
    sweep = read_sweep(file).with_reference()
    with ResultStore(store) as kept, Evaluator(kept, InProcessExecutor()) as evaluator:
        result = compare_sweep(sweep, evaluator)
    etas = {
        variant: [point.frequency_ratio for point in result.curve(variant, sweep.cases[0])]
        for variant in sweep.variants
    }
    first, *others = etas.values()
    assert len(first) > len(sweep.frequency_ratios)
    assert all(first == other for other in others), "every variant can be compared at every point"
    assert {str(point.comparison.verdict) for point in result.points} == {"agree"}
    again = collect_dataset(report_dataset(result), "").result
    assert len(again.points) == len(result.points)
    page = files_of(collect_dataset(report_dataset(result), ""))["index.html"].decode()
    assert "are not evaluated so far" not in page


@pytest.mark.slow
def test_a_report_shows_the_numbers_of_steps_that_its_store_holds_and_says_nothing_of_others(tmp_path: Path) -> None:
    """In a preview nothing is run for their sake."""
    planned = figure3((), (0.3,), (0.6, 0.9))
    with ResultStore(tmp_path / "results.sqlite") as kept:
        for own in (exact_step_tasks(), step_tasks(REFERENCE, steps=(50, 400))):
            kept.keep(zip(own, run_batch(own), strict=True))
        shown = collect(planned, kept, StoredResults(kept), "", scope=Scope(steps=()))
    assert shown.steps is not None
    assert [(point.variant, point.steps_per_period) for point in shown.steps] == [(REFERENCE, 50), (REFERENCE, 400)]
    coarse, fine = (point.error_db for point in shown.steps)
    assert coarse > 4 * fine > 0, "eight times the step"
    page = files_of(shown)["index.html"].decode()
    assert "at 50, 400 steps a period" in page
    assert "from 50 to 400 steps a period" in page
    assert "6400" not in page.split('id="work_precision"')[1].split("</section>")[0].split("<img")[0]


def test_a_store_among_the_figures_is_refused_and_one_beside_the_page_is_not(tmp_path: Path) -> None:
    """A figure could be written over it."""
    check_folder("--out", tmp_path, [None, tmp_path / "results.sqlite", tmp_path.parent / FIGURES / "results.sqlite"])
    with pytest.raises(ParameterError, match=f"lies among the figures .*; allowed: a file outside {FIGURES}"):
        check_folder("--out", tmp_path, [tmp_path / "results.sqlite", tmp_path / FIGURES / "results.sqlite"])


@pytest.mark.parametrize(("given", "meant"), [(Scope(checked=1), Scope(checked=1)), (None, Scope())])
def test_a_report_has_the_scope_that_is_asked_for(
    given, meant, sweep: Sweep, store: Path, tmp_path, monkeypatch
) -> None:
    asked = []
    monkeypatch.setattr(write, "collect", lambda *_, scope: asked.append(scope))
    monkeypatch.setattr(write, "check_loses_nothing", lambda *_: None)
    monkeypatch.setattr(write, "_written", lambda *_: None)
    write_sweep_report(sweep, tmp_path, "", store=store, run=False, scope=given)
    assert asked == [meant]


@pytest.mark.parametrize(("names", "quick"), [(["mujoco"], False), ([], True)])
def test_a_sweep_leaves_no_choice_of_engines_or_grid(names, quick) -> None:
    with pytest.raises(ParameterError, match="--sweep names engines and grid; allowed beside it: neither"):
        planned_report(names, Path("sweep.toml"), quick=quick, stored_in=None)
