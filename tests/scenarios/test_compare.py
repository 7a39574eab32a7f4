"""Two stores, or two configurations: closer to the exact motion is improved, farther is regressed."""

import math
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval import compare
from multibody_xval.reports.changes import WRITTEN, Comparison, changed_numbers, identities
from multibody_xval.reports.formatting import flat
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.compare.stores import conclusion, fails
from multibody_xval.scenarios.model import EXACT, REFERENCE, Config, Result, Run, Status, failed, unsupported
from multibody_xval.scenarios.ruler.exact_values import ruler
from multibody_xval.scenarios.store import opened
from tests.scenarios.in_this_process import pressed, result_of
from tests.scenarios.stores import CASE, ENGINE, STEPS, with_bound, write_store


@pytest.fixture
def written(tmp_path: Path):
    """Write a store by its name."""
    return lambda name, *results, **about: write_store(tmp_path / f"{name}.sqlite", *results, **about)


def own(changes: pd.DataFrame) -> pd.DataFrame:
    """The rows of the engine; those of the reference are the same in every store."""
    reference = changes.configuration == "reference:joint:tuned"
    assert (changes[reference].change == "unchanged").all()
    return changes[~reference]


def test_the_error_to_the_exact_motion_decides_and_how_much_does_not_count_is_given(written) -> None:
    before, now = (written(f"{factor}", {CASE: with_bound(factor)}, f"{factor}") for factor in (1.01, 1.02))
    (row,) = own(compare(before, now)).to_dict("records")
    assert (row["change"], row["version_before"], row["version_now"]) == ("regressed", "1.01", "1.02")
    exact = result_of(next(run for run in ruler([(CASE, STEPS)]) if run.config == EXACT)).transmittance
    ratios = [with_bound(factor).transmittance for factor in (1.01, 1.02)]
    for side, ratio in zip(("before", "now"), ratios, strict=True):
        assert row[f"error_percent_{side}"] == pytest.approx(100 * abs(ratio / exact - 1), rel=1e-9)
    assert own(compare(now, before)).change.tolist() == ["improved"]
    decibel = 20 * math.log10(1 + abs(ratios[1] / ratios[0] - 1))
    for part, change in ((0.9, "regressed"), (1.1, "unchanged")):
        assert own(compare(before, now, db=part * decibel)).change.tolist() == [change]


SOUND, BROKEN = with_bound(1.0), failed("it crashed")
LONGER = replace(SOUND, stuck=tuple(min(1.0, part + 0.05) for part in SOUND.stuck))
RESTLESS, WITHOUT = Result(status=Status.NOT_PERIODIC), unsupported("not installed")
ENDED = [
    (SOUND, BROKEN, "missing", "periodic before, failed now: it crashed"),
    (SOUND, RESTLESS, "missing", "periodic before, not periodic now"),
    (SOUND, LONGER, "regressed", "stuck fraction 0.05"),
    (BROKEN, SOUND, "improved", "failed before, periodic now: it crashed"),
    (WITHOUT, SOUND, "new", "unsupported before, periodic now: not installed"),
]


@pytest.mark.parametrize(("before", "now", "change", "what"), ENDED)
def test_how_runs_end_decides_first_and_contacts_that_stick_longer_count(written, before, now, change, what) -> None:
    rows = own(compare(written("before", {CASE: before}), written("now", {CASE: now})))
    assert rows[["change", "what"]].to_numpy().tolist() == [[change, what]]
    assert fails(rows) == (change in ("missing", "regressed"))


def test_a_change_that_no_store_has_a_ruler_for_is_unknown_and_fails(written) -> None:
    before, now = (written(f"{factor}", {CASE: with_bound(factor)}, ruled=False) for factor in (1.01, 1.05))
    rows = compare(before, now)
    assert rows.change.tolist() == ["unknown"]
    assert fails(rows)
    assert conclusion(rows, "a", "b").endswith("no exact value says which of the two is closer to the exact motion.")
    assert compare(before, before).change.tolist() == ["unchanged"]


def test_points_without_a_result_say_nothing_of_which_is_closer() -> None:
    rows = pd.DataFrame({"change": ["missing", "unchanged"]})
    assert conclusion(rows, "a", "b").endswith("where both have a result, both are as close to the exact motion.")
    assert conclusion(rows[:1], "a", "b").endswith("the second has no result.")


def test_a_worse_reference_is_found_though_it_is_the_ruler(written) -> None:
    """The exact motion judges the reference too."""
    before, now = written("before", {CASE: SOUND}), written("now", {CASE: SOUND})
    with opened(now) as store:
        store.add({Run(REFERENCE, CASE, STEPS): with_bound(1.05)})
    (row,) = compare(before, now).query("change != 'unchanged'").to_dict("records")
    assert (row["configuration"], row["change"]) == ("reference:joint:tuned", "regressed")


PRESET = "mujoco:joint:default"
CHANGED = f"{PRESET}:iterations=50"


def test_a_preset_and_the_same_with_an_option_are_compared_where_each_store_has_one(written) -> None:
    files = written("before", {CASE: with_bound(1.01)}), written("now", {CASE: with_bound(1.05)})
    for file, name, factor in zip(files, (PRESET, CHANGED), (1.01, 1.05), strict=True):
        with opened(file) as store:
            store.add({Run(Config.parse(name), CASE, STEPS): with_bound(factor)})
    rows = compare(*files)
    changes = own(rows).set_index("configuration").change.to_dict()
    assert changes == {f"{PRESET} -> {CHANGED}": "regressed", "mujoco:joint:tuned": "regressed"}
    assert f"{PRESET} -> {CHANGED}: options iterations 100 → 50" in identities(rows)


SCENARIO = SCENARIOS["stopping-distance"]
NAME, (OWN, *_) = next(iter(SCENARIO.cases)), SCENARIO.own_runs(ENGINE).values()


def thrown(file: Path, factor: float) -> Path:
    """Write a block that friction holds by a factor too strongly, and the ruler."""
    ruling = [run for run in SCENARIO.runs([ENGINE]) if run.case == OWN.case and run.config != ENGINE]
    with opened(file) as store:
        store.add({run: result_of(run) for run in ruling})
        store.add({OWN: result_of(Run(REFERENCE, pressed(factor)(OWN.case), OWN.steps))})
    return file


def test_the_error_of_a_distance_decides_and_is_shown_with_its_verdict(tmp_path: Path) -> None:
    table = compare(thrown(tmp_path / "before.sqlite", 1.01), thrown(tmp_path / "now.sqlite", 1.05))
    rows = table.set_index("quantity")
    assert (rows.change["distance"], rows.change["drift"], fails(rows)) == ("regressed", "unchanged", True)
    assert rows.error_before["distance"] == pytest.approx(1 / 1.01 - 1, abs=0.004)  # and what a step errs
    assert rows.case["distance"] == f"stopping-distance, {NAME}: distance"
    distance = rows.loc["distance"]
    assert distance.value_before > distance.value_now > 0, "more friction stops it earlier"
    (shown,) = flat(changed_numbers(table)).to_numpy().tolist()
    numbers = [f"{distance.value_before:.5g}", f"{distance.value_now:.5g}", "<1e−9"]
    assert shown == ["mujoco:joint:tuned", f"distance; stopping-distance, {NAME}", *numbers, "regressed; deviates"]
    for ending in WRITTEN:
        text = WRITTEN[ending](Comparison(table, "before", "now", 0.001, strict=False))
        assert NAME in text.replace("\\", "")
        assert ending != ".csv" or "transmittance_db_now" not in text, "there are no steady states"
