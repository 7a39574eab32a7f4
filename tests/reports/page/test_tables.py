"""Tables of the page and its finding: small cases, exact answers."""

import pandas as pd
import pytest

from multibody_xval.reports.page import tables
from multibody_xval.reports.page.finding import finding, reasons_to_fail
from multibody_xval.scenarios.edges import judged_edges
from multibody_xval.scenarios.model import Config, Result, Run
from multibody_xval.scenarios.report_plan import HEADLINE, HEADLINE_STEPS
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.ruler.judge import judged
from tests.reports.conftest import spoilt

TUNED = Config("mujoco")


def parts(results: dict[Run, Result]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Give the planned points of engines, and the edges."""
    every = points(now(results))
    shown = tables.planned(every, tables.labelled(judged(every)))
    return tables.engines_only(shown), tables.edge_table(judged_edges(every))


def test_an_error_says_how_many_points_have_one() -> None:
    assert tables.error_text(0.1234, 5, 5, "periodic") == "0.12"
    assert tables.error_text(1.0, 5, 5, "periodic") == "1.0"
    assert tables.error_text(1234.5, 5, 5, "periodic") == "1,200"
    assert tables.error_text(0.1234, 5, 4, "periodic") == "0.12 (4 of 5)"
    assert tables.error_text(float("nan"), 3, 0, "not periodic") == "no steady state"
    assert tables.error_text(float("nan"), 3, 0, "unsupported") == "unsupported"


def test_the_last_phase_of_a_period_goes_on_in_the_next() -> None:
    found = tables.phases([(0.25, "stick"), (0.75, "forward slip")], 0.5)
    assert found == [(0.0, 0.25, "forward slip"), (0.25, 0.5, "stick"), (0.75, 0.25, "forward slip")]


@pytest.mark.parametrize(("stuck", "mode"), [(1.0, "stick"), (0.0, "slip")])
def test_a_contact_that_never_changes_has_one_phase(stuck: float, mode: str) -> None:
    assert tables.phases([], stuck) == [(0.0, 1.0, mode)]


def test_points_that_edges_add_are_not_counted(results: dict[Run, Result]) -> None:
    shown, _ = parts(results)
    own = shown[shown.config == TUNED]
    assert sorted(own.frequency_ratio) == [0.6, 0.7, 1.1]
    assert sum(run.config == TUNED for run in results) > 3, "edges have more"


def test_a_sound_engine_agrees_and_fails_nothing(results: dict[Run, Result]) -> None:
    shown, edges = parts(results)
    assert reasons_to_fail(shown, edges) == []
    assert "MuJoCo (joint) and PyBullet (joint) agree with the exact motion in all 6 simulations" in finding(shown)
    assert "; with default options, vibration amplitudes are wrong by up to" in finding(shown)


def test_a_single_simulation_is_the_only_one(results: dict[Run, Result]) -> None:
    shown, _ = parts(results)
    one = shown[shown.config == TUNED].head(1)
    assert finding(one) == "Tuned to the chain, MuJoCo (joint) agrees with the exact motion in the only simulation."


def test_points_that_are_not_supported_lack_no_steady_state(results: dict[Run, Result]) -> None:
    own = parts(results)[0].query("configuration == 'mujoco:joint:tuned'").assign(error_db=0.5)
    own.loc[own.index[0], ["status", "error_db"]] = ["unsupported", float("nan")]
    (worst,) = tables.headline(tables.largest_errors(own)).to_dict("records")
    assert worst["tuned to the chain"] == "0.50"


@pytest.mark.parametrize("factor", [1.01, 0.99, 1 + 0.01j])
def test_one_per_cent_of_an_amplitude_fails(results: dict[Run, Result], factor: complex) -> None:
    shown, edges = parts(spoilt(results, TUNED, factor))
    lines = reasons_to_fail(shown, edges)
    assert lines[0].startswith("mujoco:joint:tuned: 3 of 3 numbers deviate, by up to ")
    assert "Tuned to the chain, MuJoCo (joint) deviates in 3 of 3 simulations, by up to " in finding(
        shown[shown.config == TUNED]
    )


def test_an_edge_that_deviates_fails(results: dict[Run, Result]) -> None:
    shown, edges = parts(results)
    moved = edges.assign(verdict="deviates", judged=edges.configuration == "mujoco:joint:tuned")
    count = int(moved.judged.sum())
    (line,) = reasons_to_fail(shown, moved)
    assert line.startswith(f"mujoco:joint:tuned: {count} of {count} band edges deviate, by up to ")


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


def test_the_headlines_points_are_no_part_of_curves() -> None:
    runs = {Run(TUNED, case, HEADLINE_STEPS): None for case in HEADLINE}
    rows = pd.DataFrame(
        [{"config": run.config, "case": run.case, "steps": run.steps, "place": tables.place(run.case)} for run in runs]
    )
    assert tables.on_grid(rows).empty
    assert len(tables.on_grid(rows.assign(steps=400))) == len(HEADLINE)
