"""Figure 3 from a store of a run that was stopped: what is missing is said, and nothing is judged by it."""

from pathlib import Path

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.evaluator import StoredResults
from multibody_xval.scenarios.runs.executor import run_batch
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.studies.figure3 import figure3
from multibody_xval.scenarios.sweeps.attenuation_band import Edge
from multibody_xval.scenarios.sweeps.compared import ComparedSweep, compare_sweep
from multibody_xval.scenarios.sweeps.sweep import Case
from multibody_xval.scenarios.verdicts.finding import Verdict
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE

STOPPED = Variant("mujoco")
ASKED = figure3((STOPPED,), (0.3,), (0.3, 0.62, 0.63, 0.64, 0.65, 0.9, 1.0))
RUBBING = Case.of(friction_ratio=0.3)
GRID = list(ASKED.frequency_ratios)


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> ComparedSweep:
    """The reference is complete on the grid; the engine was stopped after four points."""
    with ResultStore(tmp_path_factory.mktemp("store") / "results.sqlite") as store:
        for variant, etas in ((CONVERGED, GRID), (REFERENCE, GRID), (STOPPED, GRID[:4])):
            tasks = [ASKED.task(variant, RUBBING, eta) for eta in etas]
            store.keep(zip(tasks, run_batch(tasks), strict=True))
        return compare_sweep(ASKED, StoredResults(store))


def test_points_that_are_not_answered_are_inconclusive_with_that_reason(result: ComparedSweep) -> None:
    curve = result.curve(STOPPED, RUBBING)
    assert [point.frequency_ratio for point in curve] == GRID
    for point in curve:
        if point.frequency_ratio in GRID[:4]:
            assert point.comparison.verdict is Verdict.AGREE
        else:
            assert point.comparison.verdict is Verdict.INCONCLUSIVE
            assert point.comparison.reason == "engine: not evaluated so far"


def test_edges_of_a_curve_with_gaps_are_not_judged(result: ComparedSweep) -> None:
    for edge in Edge:
        band_edge = result.edge(STOPPED, RUBBING, edge)
        assert band_edge.comparison.verdict is Verdict.INCONCLUSIVE
        assert "MuJoCo's curve" in band_edge.comparison.reason
        assert "points are not evaluated so far" in band_edge.comparison.reason


def test_an_empty_store_gives_a_result_without_a_single_number(tmp_path: Path) -> None:
    with ResultStore(tmp_path / "results.sqlite") as store:
        result = compare_sweep(ASKED, StoredResults(store))
    assert {point.result.status for point in result.points} == {"missing"}
    assert {point.comparison.verdict for point in result.points} == {Verdict.INCONCLUSIVE}
    assert {edge.comparison.verdict for edge in result.edges} == {Verdict.INCONCLUSIVE}
