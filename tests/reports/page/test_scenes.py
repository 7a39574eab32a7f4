"""Scenes that a store holds stand on the page, engine by engine; a store without any leaves the section out."""

from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.catalogue import scene_numbers
from multibody_xval.reports.data.report import Report
from multibody_xval.reports.page.render import page, sections
from multibody_xval.reports.page.sections.scenes import Scenes, heat_map
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.executor import InProcessExecutor
from multibody_xval.scenarios.runs.store import ResultStore

CREEP = "joint-hold, creep [µm/s]"


@pytest.fixture(scope="module")
def numbers(tmp_path_factory: pytest.TempPathFactory) -> pd.DataFrame:
    """What a store knows of loaded joints in MuJoCo, and of some of those in PyBullet."""
    scenario = CATALOGUE["joint-hold"]
    with ResultStore(tmp_path_factory.mktemp("store") / "results.sqlite") as kept:
        evaluator = Evaluator(kept, InProcessExecutor())
        scenario.run(scenario.variants(["mujoco"]), evaluator)
        partial = Variant("pybullet", "joint", "default")
        evaluator.evaluate([task for _, task in scenario.tasks(partial, scenario.cases[:1]).values()])
        return scene_numbers(kept)


def test_a_joint_that_creeps_as_installed_and_not_as_recommended_stands_on_the_page(
    numbers: pd.DataFrame, report: Report
) -> None:
    assert set(numbers.engine) == {"mujoco"}, "of PyBullet not all is known"
    (creep,) = numbers[numbers.number == CREEP].itertuples()
    assert creep.recommended < 1e-3 * creep.default
    html = page("A page", [Scenes(replace(report, scenes=numbers))]).html
    assert f"<th>{CREEP}</th>" in html
    assert f'<td class="shade1">{creep.default:,.0f}<br>→ {creep.recommended:.2g}</td>' in html


def test_a_store_without_scenes_has_no_section(report: Report, tmp_path: Path) -> None:
    with ResultStore(tmp_path / "empty.sqlite") as kept:
        assert scene_numbers(kept).empty
    assert "Scenes" not in {type(part).__name__ for part in sections(report)}


def test_shades_tell_decades_and_what_fails_or_was_not_measured() -> None:
    rows = pd.DataFrame(
        [("mujoco", CREEP, 5e3, 0.05), ("pybullet", CREEP, 20.0, float("nan")), ("drake", CREEP, 5.0, float("inf"))],
        columns=["engine", "number", "default", "recommended"],
    )
    html = heat_map(rows, {"mujoco": "mujoco.html"})
    assert '<th><a href="mujoco.html">MuJoCo</a></th>' in html
    assert '<td class="shade0">5,000<br>→ 0.05</td>' in html
    assert '<td class="shade3">20</td>' in html
    assert '<td class="shade6">5<br>→ failed</td>' in html
