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
from multibody_xval.scenarios.model import REFERENCE, Config, Result, Run, Status, failed, unsupported
from multibody_xval.scenarios.ruler.exact_values import ruler
from multibody_xval.scenarios.store import opened
from reference_lcp.errors import ParameterError
from tests.scenarios.in_this_process import pressed, result_of
from tests.scenarios.stores import CASE, STEPS, of, with_bound, write_store


@pytest.fixture
def written(tmp_path: Path):
    """Write a store by its name."""
    return lambda name, *results, **about: write_store(tmp_path / f"{name}.sqlite", *results, **about)


def own(changes: pd.DataFrame) -> pd.DataFrame:
    """The rows of the engine; those of the reference are the same in every store."""
    reference = changes.configuration == "reference:joint:tuned"
    assert (changes[reference].change == "unchanged").all()
    return changes[~reference]


@pytest.mark.parametrize(
    ("factors", "change"), [((1.05, 1.01), "improved"), ((1.01, 1.05), "regressed"), ((1.02, 1.02), "unchanged")]
)
def test_the_error_to_the_exact_motion_decides(written, factors, change: str) -> None:
    before, now = (written(f"{at}", {CASE: with_bound(factors[at])}, f"{at}.0") for at in (0, 1))
    (row,) = own(compare(before, now)).to_dict("records")
    assert (row["change"], row["version_before"], row["version_now"]) == (change, "0.0", "1.0")
    exact = of(next(run for run in ruler([(CASE, STEPS)]) if run.config.preset_name == "exact")).transmittance
    for side, factor in zip(("before", "now"), factors, strict=True):
        error = 100 * abs(with_bound(factor).transmittance / exact - 1)
        assert row[f"error_percent_{side}"] == pytest.approx(error, rel=1e-9)


def test_the_largest_change_that_does_not_count_is_given(written) -> None:
    before, now = (written(f"{factor}", {CASE: with_bound(factor)}) for factor in (1.01, 1.02))
    moved = abs(with_bound(1.02).transmittance / with_bound(1.01).transmittance - 1)
    decibel = 20 * math.log10(1 + moved)
    assert own(compare(before, now, db=0.9 * decibel)).change.tolist() == ["regressed"]
    assert own(compare(before, now, db=1.1 * decibel)).change.tolist() == ["unchanged"]


SOUND, BROKEN = with_bound(1.0), failed("it crashed")
LONGER = replace(SOUND, stuck=tuple(min(1.0, part + 0.05) for part in SOUND.stuck))
RESTLESS, WITHOUT = Result(status=Status.NOT_PERIODIC), unsupported("not installed")
ENDED = [
    (SOUND, BROKEN, "missing", "periodic before, failed now: it crashed"),
    (SOUND, RESTLESS, "missing", "periodic before, not periodic now"),
    (SOUND, LONGER, "regressed", "stuck fraction 0.05"),
    (LONGER, SOUND, "improved", "stuck fraction 0.05"),
    (BROKEN, SOUND, "improved", "failed before, periodic now: it crashed"),
    (BROKEN, BROKEN, "unchanged", ""),
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


def test_a_worse_reference_is_found_though_it_is_the_ruler(written) -> None:
    """The exact motion judges the reference too."""
    before, now = written("before", {CASE: SOUND}), written("now", {CASE: SOUND})
    with opened(now) as store:
        store.add({Run(REFERENCE, CASE, STEPS): with_bound(1.05)})
    (row,) = compare(before, now).query("change != 'unchanged'").to_dict("records")
    assert (row["configuration"], row["change"]) == ("reference:joint:tuned", "regressed")


def test_stores_that_have_the_reference_alone_in_common_are_refused(written, tmp_path: Path) -> None:
    other = stored_as(tmp_path / "other.sqlite", 1.0, "pybullet")
    with pytest.raises(ParameterError, match="have no point in common; allowed: stores with the same configurations"):
        compare(written("now", {CASE: SOUND}), other)


def stored_as(file: Path, factor: float, *names: str) -> Path:
    """Write a result of configurations, and the ruler."""
    with opened(file) as store:
        store.add({run: of(run) for run in ruler([(CASE, STEPS)])})
        store.add({Run(Config.parse(name), CASE, STEPS): with_bound(factor) for name in names})
    return file


PRESET = "mujoco:joint:default"
CHANGED, OTHERWISE = f"{PRESET}:iterations=50", f"{PRESET}:iterations=9"


def test_a_preset_and_the_same_with_an_option_are_compared_where_each_store_has_one(tmp_path: Path) -> None:
    before = stored_as(tmp_path / "before.sqlite", 1.01, PRESET, "mujoco")
    now = stored_as(tmp_path / "now.sqlite", 1.05, CHANGED, "mujoco")
    rows = own(compare(before, now)).set_index("configuration")
    assert rows.change.to_dict() == {f"{PRESET} -> {CHANGED}": "regressed", "mujoco:joint:tuned": "regressed"}
    assert f"{PRESET} -> {CHANGED}: options iterations 100 → 50" in identities(compare(before, now))


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
