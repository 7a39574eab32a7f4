"""Numbers of scenarios of two stores: what a block does is compared by its error to the exact motion."""

from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.reports.changes import WRITTEN, Comparison, changed_numbers
from multibody_xval.reports.formatting import flat
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.compare.stores import compare, fails
from multibody_xval.scenarios.model import REFERENCE, Config, Result, Run
from multibody_xval.scenarios.store import opened
from tests.scenarios.in_this_process import pressed, result_of
from tests.scenarios.stores import CASE, with_bound, write_store

SCENARIO, ENGINE = SCENARIOS["stopping-distance"], Config("mujoco")
NAME, (OWN, *_) = next(iter(SCENARIO.cases)), SCENARIO.own_runs(ENGINE).values()
RULER = [run for run in SCENARIO.runs([ENGINE]) if run.case == OWN.case and run.config != ENGINE]


def thrown(factor: float) -> Result:
    """The scheme's motion of a block that friction holds by a factor too strongly."""
    return result_of(Run(REFERENCE, pressed(factor)(OWN.case), OWN.steps))


@pytest.fixture
def changes(tmp_path: Path):
    """Compare stores with a result each, with the ruler or without, and give the numbers by their names."""

    def compared(*results: Result, ruled: bool = True) -> pd.DataFrame:
        files = [tmp_path / name for name in ("before.sqlite", "now.sqlite")]
        for file, result in zip(files, results, strict=True):
            with opened(file) as store:
                store.add({run: result_of(run) for run in (RULER if ruled else [])} | {OWN: result})
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


def test_a_number_that_has_changed_is_shown_before_and_now_with_what_is_allowed_and_its_verdict(changes) -> None:
    rows = changes(thrown(1.01), thrown(1.05))
    own, table = rows.loc["distance"], rows.reset_index()
    assert own.value_before > own.value_now > 0, "more friction stops it earlier"
    (shown,) = flat(changed_numbers(table)).to_numpy().tolist()
    numbers = [f"{own.value_before:.5g}", f"{own.value_now:.5g}", "<1e−9"]
    assert shown == ["mujoco:joint:tuned", f"distance; stopping-distance, {NAME}", *numbers, "regressed; deviates"]
    for ending in WRITTEN:
        text = WRITTEN[ending](Comparison(table, "before", "now", 0.001, strict=False))
        assert NAME in text.replace("\\", "")
        assert ending != ".csv" or "transmittance_db_now" not in text, "there are no steady states"


def test_steady_states_that_the_second_store_alone_has_are_new(tmp_path: Path) -> None:
    before, now = tmp_path / "before.sqlite", write_store(tmp_path / "now.sqlite", {CASE: with_bound(1.01)})
    for file in (before, now):
        with opened(file) as store:
            store.add({run: result_of(run) for run in RULER} | {OWN: thrown(1.01)})
    rows = compare(before, now)
    assert set(rows[rows.scenario.isna()].change) == {"new"}
    assert set(rows[rows.scenario.notna()].change) == {"unchanged"}


def test_without_the_ruler_a_change_is_unknown_and_fails(changes) -> None:
    rows = changes(thrown(1.01), thrown(1.05), ruled=False)
    assert rows.change["distance"] == "unknown"
    assert fails(rows)
