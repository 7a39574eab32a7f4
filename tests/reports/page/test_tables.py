"""Tables of the page and its finding: small cases, exact answers."""

import pandas as pd
import pytest

from multibody_xval.reports.page import tables
from multibody_xval.reports.page.finding import finding, reasons_to_fail
from multibody_xval.scenarios.edges import judged_edges
from multibody_xval.scenarios.model import Case, Config, Result, Run
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.ruler.judge import judged
from tests.reports.conftest import spoilt

TUNED = Config("mujoco")


def parts(results: dict[Run, Result]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Give the planned points of engines, and the edges."""
    every = points(now(results))
    shown = tables.planned(every, tables.labelled(judged(every)))
    return tables.engines_only(shown), tables.edge_table(judged_edges(every))


@pytest.mark.parametrize(
    ("row", "text"),
    [
        ((0.1234, 5, 5, "periodic"), "0.12"),
        ((1234.5, 5, 5, "periodic"), "1,200"),
        ((0.1234, 5, 4, "periodic"), "0.12 (4 of 5)"),
        ((float("nan"), 3, 0, "not periodic"), "no steady state"),
        ((float("nan"), 3, 0, "unsupported"), "unsupported"),
    ],
)
def test_an_error_says_how_many_points_have_one(row, text) -> None:
    assert tables.error_text(*row) == text


@pytest.mark.parametrize(("part", "text"), [(0.0, "0"), (1.5, "0.25"), (3.0, "0.50; no cure known")])
def test_a_recipe_that_leaves_more_than_twice_what_is_allowed_is_called_no_cure(part, text) -> None:
    row = {
        "title": "Exudyn", "status": "periodic", "error_percent": 2.0 * part, "error_db": part / 6, "error_deg": 0.0,
        "distance": part, "allowed": 1.0, "case": Case(friction_ratio=0.3, frequency_ratio=1.0),
    }  # fmt: skip
    rows = [row | {"options": name, "configuration": name} for name in ("default options", "recipe")]
    shown = tables.headline(tables.largest_errors(pd.DataFrame(rows)))
    assert shown[["default options", "recipe"]].to_numpy().tolist() == [[text.partition(";")[0], text]]


def test_a_recipe_that_reaches_no_steady_state_is_called_no_cure() -> None:
    row = {
        "title": "Exudyn", "options": "recipe", "configuration": "recipe", "status": "not periodic",
        "case": Case(friction_ratio=0.3, frequency_ratio=1.0),
    }  # fmt: skip
    none = dict.fromkeys(("error_percent", "error_db", "error_deg", "distance", "allowed"), float("nan"))
    (text,) = tables.headline(tables.largest_errors(pd.DataFrame([row | none]))).recipe
    assert text == "no steady state; no cure known"


def test_the_last_phase_of_a_period_goes_on_in_the_next() -> None:
    found = tables.phases([(0.25, "stick"), (0.75, "forward slip")], 0.5)
    assert found == [(0.0, 0.25, "forward slip"), (0.25, 0.5, "stick"), (0.75, 0.25, "forward slip")]
    assert [tables.phases([], stuck) for stuck in (1.0, 0.0)] == [[(0.0, 1.0, "stick")], [(0.0, 1.0, "slip")]]


def test_a_sound_engine_agrees_and_fails_nothing(results: dict[Run, Result]) -> None:
    shown, edges = parts(results)
    assert reasons_to_fail(shown, edges) == []
    assert "MuJoCo (joint) and PyBullet (joint) agree with the exact motion in all 6 simulations" in finding(shown)
    assert "; with default options, vibration amplitudes are wrong by up to" in finding(shown)


@pytest.mark.parametrize("factor", [1.01, 0.99, 1 + 0.01j])
def test_one_per_cent_of_an_amplitude_fails(results: dict[Run, Result], factor: complex) -> None:
    shown, edges = parts(spoilt(results, TUNED, factor))
    lines = reasons_to_fail(shown, edges)
    assert lines[0].startswith("mujoco:joint:tuned: 3 of 3 numbers deviate, by up to ")
    assert "Tuned to the chain, MuJoCo (joint) deviates in 3 of 3 simulations, by up to " in finding(
        shown[shown.config == TUNED]
    )


def test_default_options_are_measured_and_never_fail(results: dict[Run, Result]) -> None:
    default = Config("mujoco", preset_name="default")
    shown, edges = parts(spoilt(results, default, 2.0))
    assert reasons_to_fail(shown, edges) == []
    assert "Nothing was judged" in finding(shown[shown.config == default])


def test_versions_of_one_engine_stand_next_to_each_other(results: dict[Run, Result]) -> None:
    stored = now(results)
    other = [row._replace(version="1.0") for row in stored if row.run.config == TUNED]
    every = points([*stored, *other])
    titles = set(tables.labelled(judged(every)).title)
    version = next(row.version for row in stored if row.run.config == TUNED)
    assert {f"MuJoCo, joint {version}", "MuJoCo, joint 1.0"} <= titles
    assert "MuJoCo, joint" in titles, "of default options there is one version"
