"""CSV and JSON: columns, full numbers, the same in both."""

import csv
import dataclasses
import io
import json
import math
import statistics
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from multibody_xval.reports.data.report import Report
from multibody_xval.reports.export.files import report_dataset, write_all
from multibody_xval.scenarios.sweeps.compared import ComparedSweep
from multibody_xval.scenarios.sweeps.point import Truth
from multibody_xval.scenarios.sweeps.truths import with_recorded_truths
from reference_lcp.errors import ParameterError
from tests.reports.conftest import CONVERGED_ERROR, STEP_ERROR

COLUMNS = {
    "errors.csv": (
        "engine,formulation,preset,worst_error_db,worst_friction_ratio,worst_frequency_ratio,median_error_db,class,"
        "points_beyond_step,points_known,points,same_equations,difference_from_scheme_db"
    ),
    "band_edges.csv": (
        "engine,formulation,preset,friction_ratio,edge,frequency_ratio,difference,verdict,outcome,"
        "law_value,law_left,law_allowed,law_distance,law_period_bound,reason"
    ),
    "transmittance.csv": (
        "engine,formulation,preset,friction_ratio,frequency_ratio,status,transmittance_db,truth_db,truth_error_db,error_db,residual,difference_db,"
        "phase_rad,difference_phase_deg,verdict,outcome,law_value_db,law_left_db,law_allowed_db,law_value_phase_deg,"
        "law_left_phase_deg,law_allowed_phase_deg,law_distance,law_period_bound,reason"
    ),
    "catalogue.csv": "scenario,engine,formulation,preset,unmodelled,modelled,inconclusive,blocked,agrees",
    "work_precision.csv": (
        "engine,formulation,preset,steps_per_period,largest_error_db,step_s,steady_state_s,points_certified,"
        "points_evaluated,reason"
    ),
    "transitions.csv": "engine,formulation,preset,friction_ratio,frequency_ratio,cell,time_s,kind",
}


@pytest.fixture(scope="module")
def texts(files: dict[str, bytes]) -> dict[str, str]:
    return {name: content.decode() for name, content in files.items() if name.endswith((".csv", ".json"))}


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


@pytest.mark.parametrize("name", COLUMNS)
def test_csv_has_exactly_the_columns_promised(texts: dict[str, str], name: str) -> None:
    assert texts[name].splitlines()[0] == COLUMNS[name]


def test_every_point_of_every_variant_has_a_row_with_its_verdict(texts: dict[str, str], result: ComparedSweep) -> None:
    table = rows(texts["transmittance.csv"])
    assert len(table) == len(result.points)
    found = {(row["engine"], row["preset"], row["friction_ratio"], row["frequency_ratio"]): row for row in table}
    assert found["mujoco", "tuned", "0.0", "0.9"]["verdict"] == "disagree"
    assert found["mujoco", "tuned", "0.3", "1.3"]["verdict"] == "inconclusive"
    assert found["pybullet", "tuned", "0.3", "0.6"]["verdict"] == "blocked"


def test_csv_numbers_are_in_full(texts: dict[str, str], result: ComparedSweep) -> None:
    for row, point in zip(rows(texts["transmittance.csv"]), result.points, strict=True):
        assert row["transmittance_db"] == repr(point.result.transmittance_db)
        assert row["residual"] == repr(point.result.residual)


@pytest.mark.parametrize("name", ["errors.csv", "band_edges.csv", "transmittance.csv"])
def test_json_holds_the_numbers_of_the_csv(texts: dict[str, str], name: str) -> None:
    listed = json.loads(texts["report.json"])[name.removesuffix(".csv")]
    for written, read in zip(listed, rows(texts[name]), strict=True):
        assert list(written) == list(read)
        for column, value in written.items():
            assert read[column] == ("nan" if value is None else str(value))


def test_json_writes_null_where_there_is_no_number(texts: dict[str, str]) -> None:
    def refuse(constant: str) -> float:
        raise AssertionError(constant)

    report = json.loads(texts["report.json"], parse_constant=refuse)
    blocked = [row for row in report["transmittance"] if row["verdict"] == "blocked"]
    assert blocked
    assert all(row["transmittance_db"] is None for row in blocked)


def test_json_says_where_the_numbers_come_from(texts: dict[str, str]) -> None:
    origin = json.loads(texts["report.json"])["provenance"]
    assert origin["command"] == "multibody-xval report --quick --engine '<b>'"
    assert origin["tolerances"]["residual"] == 1e-8
    assert origin["band"]["depth_db"] == -10.0
    mujoco = next(variant for variant in origin["variants"] if variant["engine"] == "mujoco")
    assert {option["name"] for option in mujoco["options"]} >= {"solver", "noslip_iterations"}
    assert mujoco["worst_residual"] == 3e-9


def test_an_edge_outside_the_grid_is_nan_and_a_blocked_engine_has_no_difference(texts: dict[str, str]) -> None:
    table = rows(texts["band_edges.csv"])
    absent = [row for row in table if (row["friction_ratio"], row["edge"]) == ("0.3", "upper")]
    assert len(absent) == 4
    for row in [*absent, *(row for row in table if row["engine"] == "pybullet")]:
        assert math.isnan(float(row["frequency_ratio"]))
        assert math.isnan(float(row["difference"]))


def test_files_are_replaced_whole(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("old")
    write_all(tmp_path, {"a.csv": b"new", "figures/b.svg": b"more"})
    found = {str(file.relative_to(tmp_path)): file.read_text() for file in tmp_path.rglob("*") if file.is_file()}
    assert found == {"a.csv": "new", "figures/b.svg": "more"}


def test_netcdf_holds_every_point_and_edge_with_its_labels(
    report: Report, files: dict[str, bytes], tmp_path: Path
) -> None:
    file = tmp_path / "report.nc"
    file.write_bytes(files["report.nc"])
    with xr.open_dataset(file, engine="h5netcdf") as read:
        assert read.transmittance_db.attrs["units"] == "dB"
        for point in report.result.points:
            place = {"variant": str(point.variant), **point.case.by_axis}
            one = read.sel(place).sel(frequency_ratio=point.frequency_ratio)
            np.testing.assert_equal(float(one.transmittance_db), point.result.transmittance_db)
            meaning = read.verdict.attrs["flag_meanings"].split()
            assert meaning[int(one.verdict)] == str(point.comparison.verdict)
        for edge in report.result.edges:
            place = {"variant": str(edge.variant), **edge.case.by_axis, "edge": str(edge.edge)}
            expected = math.nan if edge.frequency_ratio is None else edge.frequency_ratio
            np.testing.assert_equal(float(read.band_edge.sel(place)), expected)


def test_points_that_were_not_asked_are_told_from_those_without_a_number(result: ComparedSweep) -> None:
    fewer = dataclasses.replace(result, points=result.points[1:])
    assert int(report_dataset(fewer).verdict.min()) == -1
    assert int(report_dataset(result).verdict.min()) == 0


def test_errors_of_the_table_are_those_that_a_reader_computes_from_the_points(texts: dict[str, str]) -> None:
    """Worst and median of |transmittance - truth|, the smallest worst error first, whatever a variant is judged by."""
    points = rows(texts["headline.csv"])
    table = rows(texts["errors.csv"])
    worst = []
    for row in table:
        name = ("engine", "formulation", "preset")
        own = [p for p in points if all(p[part] == row[part] for part in name) and p["error_db"] != "nan"]
        errors = [float(p["transmittance_db"]) - float(p["truth_db"]) for p in own]
        if not own:
            assert (row["engine"], row["class"]) == ("pybullet", "")
            continue
        assert float(row["worst_error_db"]) == pytest.approx(max(errors, key=abs), abs=1e-12)
        assert float(row["median_error_db"]) == pytest.approx(statistics.median(map(abs, errors)), abs=1e-12)
        worst.append(abs(float(row["worst_error_db"])))
    assert worst == sorted(worst)
    assert [row["engine"] for row in table] == ["reference", "reference", "mujoco", "mujoco", "pybullet"]


def test_agreement_with_the_scheme_is_a_column_of_its_own(texts: dict[str, str]) -> None:
    """Beside an error of its step, which it shares with the scheme."""
    by_name = {(row["engine"], row["preset"]): row for row in rows(texts["errors.csv"])}
    own = by_name["mujoco", "tuned"]
    assert own["same_equations"] == "yes"
    assert float(own["difference_from_scheme_db"]) == pytest.approx(0.03, abs=1e-12)
    assert float(own["worst_error_db"]) == pytest.approx(0.03 + STEP_ERROR + CONVERGED_ERROR, abs=1e-12)
    assert own["class"] == "visible"
    scheme = by_name["reference", "tuned"]
    assert (scheme["class"], float(scheme["difference_from_scheme_db"])) == ("within the step's error", 0.0)


def test_a_dataset_holds_the_truth_and_gives_it_back(report: Report, monkeypatch) -> None:
    data, sweep = report_dataset(report.result), report.result.sweep
    bare = dataclasses.replace(
        report.result, points=[dataclasses.replace(p, truth=Truth()) for p in report.result.points]
    )
    read = with_recorded_truths(bare, data, sweep).truths
    assert read == report.result.truths
    assert all(truth.exact for truth in read.values())
    off = data.error_db.sel(variant="mujoco", friction_ratio=0.0, frequency_ratio=0.9)
    assert float(off) == pytest.approx(0.03 + STEP_ERROR + CONVERGED_ERROR, abs=1e-12)
    monkeypatch.setattr(
        "multibody_xval.scenarios.sweeps.truths.proven_level", lambda _: None
    )  # all numbers here are invented
    assert not any(truth.exact for truth in with_recorded_truths(bare, report_dataset(bare), sweep).truths.values())
    with pytest.raises(ParameterError, match="truth_error_db"):
        with_recorded_truths(bare, data.drop_vars("truth_error_db"), sweep)
