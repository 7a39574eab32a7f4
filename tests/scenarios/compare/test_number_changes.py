"""Numbers of scenarios of two stores: what a block does is compared by its error to the exact motion."""

import warnings
from dataclasses import replace
from functools import cache
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.reports.changes import WRITTEN, Comparison, changed_numbers, changed_points, markdown
from multibody_xval.reports.formatting import flat
from multibody_xval.scenarios.cases.motions import BlockMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.compare.stores import compare, conclusion, fails
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import REFERENCE, Config, Result, Run, failed, unsupported
from multibody_xval.scenarios.store import opened
from reference_lcp.errors import ParameterError
from tests.scenarios.stores import CASE, with_bound, write_store

SCENARIO, ENGINE = SCENARIOS["stopping-distance"], Config("mujoco")
ENGINE_NAME = "mujoco:joint:tuned"
NAME, (OWN, *_) = next(iter(SCENARIO.cases)), SCENARIO.own_runs(ENGINE).values()
RULER = [run for run in SCENARIO.runs([ENGINE]) if run.case == OWN.case and run.config != ENGINE]


@cache
def of(run: Run) -> Result:
    return run_batch([run])[0]


def thrown(factor: float) -> Result:
    """The scheme's motion of a block that friction holds by a factor too strongly."""
    assert isinstance(OWN.case, BlockMotion)
    block = replace(OWN.case.block, normal_force=factor * OWN.case.block.normal_force)
    return of(Run(REFERENCE, replace(OWN.case, block=block), OWN.steps))


@pytest.fixture
def changes(tmp_path: Path):
    """Compare stores with a result each, or none, with the ruler or without, and give the numbers by their names."""

    def compared(*results: Result | None, ruled: bool = True) -> pd.DataFrame:
        files = [tmp_path / name for name in ("before.sqlite", "now.sqlite")]
        for file, result in zip(files, results, strict=True):
            with opened(file) as store:
                store.add({run: of(run) for run in RULER} if ruled else {})
                store.add({} if result is None else {OWN: result})
        return compare(*files).set_index("quantity")

    return compared


@pytest.mark.parametrize(
    ("before", "now", "change"), [(1.05, 1.01, "improved"), (1.01, 1.05, "regressed"), (1.02, 1.02, "unchanged")]
)
def test_the_error_of_a_distance_decides(changes, before, now, change) -> None:
    rows = changes(thrown(before), thrown(now))
    assert rows.change["distance"] == change
    assert rows.change["drift"] == "unchanged"
    assert rows.error_before["distance"] == pytest.approx(1 / before - 1, abs=0.004)  # and what a step errs
    assert fails(rows) == (change == "regressed")
    assert rows.case["distance"] == f"stopping-distance, {NAME}: distance"


def test_what_has_changed_is_said_with_both_errors(changes) -> None:
    rows = changes(thrown(1.01), thrown(1.05))
    value = f"{rows.value_before['distance']:.5g} → {rows.value_now['distance']:.5g}"
    assert rows.what["distance"].startswith(f"{value}, error ")
    assert "regressed, " in conclusion(rows, "before", "now")


def test_a_number_that_has_changed_is_shown_before_and_now_with_what_is_allowed_and_its_verdict(changes) -> None:
    rows = changes(thrown(1.01), thrown(1.05))
    own, table = rows.loc["distance"], changed_numbers(rows.reset_index())
    assert own.value_before > own.value_now > 0, "more friction stops it earlier"
    (shown,) = flat(table).to_numpy().tolist()
    numbers = [f"{own.value_before:.5g}", f"{own.value_now:.5g}", "<1e−9"]
    assert shown == [ENGINE_NAME, f"distance; stopping-distance, {NAME}", *numbers, "regressed; deviates"]
    assert changed_points(rows.reset_index()).empty
    text = markdown(Comparison(rows.reset_index(), "before", "now", 0.001, strict=False))
    assert f"; stopping-distance, {NAME} | {own.value_before:.5g} | {own.value_now:.5g} |" in text


def test_steady_states_that_the_second_store_alone_has_are_new_without_a_warning(tmp_path: Path) -> None:
    before, now = tmp_path / "before.sqlite", write_store(tmp_path / "now.sqlite", {CASE: with_bound(1.01)})
    for file in (before, now):
        with opened(file) as store:
            store.add({run: of(run) for run in RULER} | {OWN: thrown(1.01)})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rows = compare(before, now)
    assert set(rows[rows.scenario.isna()].change) == {"new"}
    assert set(rows[rows.scenario.notna()].change) == {"unchanged"}


def test_columns_of_steady_states_are_not_written_where_there_are_none(changes) -> None:
    rows = changes(thrown(1.01), thrown(1.05)).reset_index()
    header = WRITTEN[".csv"](Comparison(rows, "before", "now", 0.001, strict=False)).splitlines()[0].split(",")
    assert {"quantity", "value_before", "value_now", "error_now", "allowed_now"} <= set(header)
    assert not {"friction_ratio", "transmittance_db_now", "error_percent_before"} & set(header)


@pytest.mark.parametrize("ending", sorted(WRITTEN))
def test_numbers_without_any_steady_state_are_written(changes, ending) -> None:
    rows = changes(thrown(1.01), thrown(1.05)).reset_index()
    text = WRITTEN[ending](Comparison(rows, "before", "now", 0.001, strict=False))
    assert NAME in text.replace("\\", "")


@pytest.mark.parametrize(
    ("before", "now", "change", "what"),
    [
        (thrown(1.0), failed("it crashed"), "missing", "finished before, failed now: it crashed"),
        (failed("it crashed"), thrown(1.0), "improved", "failed before, finished now: it crashed"),
        (unsupported("no blocks"), thrown(1.0), "new", "unsupported before, finished now: no blocks"),
    ],
)
def test_runs_that_end_otherwise_are_named(changes, before, now, change, what) -> None:
    rows = changes(before, now)
    assert set(rows.change) == {change}
    assert set(rows.what) == {what}


def test_without_the_ruler_a_change_is_unknown_and_fails(changes) -> None:
    rows = changes(thrown(1.01), thrown(1.05), ruled=False)
    assert rows.change["distance"] == "unknown"
    assert fails(rows)


def test_stores_of_other_engines_have_nothing_in_common(changes) -> None:
    with pytest.raises(ParameterError, match="have no point in common"):
        changes(thrown(1.0), None)
