"""Tables of the page and its finding: small cases, exact answers."""

import math
from typing import Any

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


NONE = {
    "status": "not periodic",
    **dict.fromkeys(("error_percent", "error_db", "error_deg", "distance", "allowed"), math.nan),
}


def off_by(part: float) -> dict[str, Any]:
    """Give the columns of an error of so many times what is allowed."""
    errors = {"error_percent": 2 * part, "error_db": part / 6, "error_deg": 0.0}
    return {"status": "periodic", "distance": part, "allowed": 1.0, **errors}


@pytest.mark.parametrize(
    ("columns", "text"),
    [(off_by(0.0), "0"), (off_by(1.5), "0.25"), (off_by(3.0), "0.50; not enough"),
     (NONE, "no steady state")],
)  # fmt: skip
def test_a_recipe_that_leaves_more_than_twice_what_is_allowed_is_not_enough(columns, text) -> None:
    row = {"title": "Exudyn", "case": Case(friction_ratio=0.3, frequency_ratio=1.0), **columns}
    rows = [row | {"options": name, "configuration": name} for name in ("default options", "recipe")]
    shown = tables.headline(tables.largest_errors(pd.DataFrame(rows)))
    assert shown[["default options", "recipe"]].to_numpy().tolist() == [[text.partition(";")[0], text]]


def test_the_last_phase_of_a_period_goes_on_in_the_next() -> None:
    found = tables.phases([(0.25, "stick"), (0.75, "forward slip")], 0.5)
    assert found == [(0.0, 0.25, "forward slip"), (0.25, 0.5, "stick"), (0.75, 0.25, "forward slip")]
    assert [tables.phases([], stuck) for stuck in (1.0, 0.0)] == [[(0.0, 1.0, "stick")], [(0.0, 1.0, "slip")]]


@pytest.mark.needs("pybullet")
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
