"""What deviates of a sweep: as the law of the variant predicts, or unmodelled, whatever a text says."""

import dataclasses
from collections.abc import Iterator

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.evaluator import StoredResults
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import ResultStore, opened_store
from multibody_xval.scenarios.studies.figure3 import figure3
from multibody_xval.scenarios.sweeps.attenuation_band import Crossing, Edge
from multibody_xval.scenarios.sweeps.compared import ComparedSweep, compare_sweep
from multibody_xval.scenarios.sweeps.edges import BandEdge, RefinedEdges
from multibody_xval.scenarios.sweeps.predictions import _predicted_edge
from multibody_xval.scenarios.sweeps.sweep import GivenTolerance, Sweep
from multibody_xval.scenarios.verdicts.finding import Comparison, Finding, Verdict, failures, unmodelled
from multibody_xval.scenarios.verdicts.prediction import LawPeriod
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from tests.scenarios.in_process import be_late, evaluator, press_harder

LAWFUL = Variant("mujoco", "joint", "default")
"""It deviates from Coulomb's law, and its law predicts how."""

GRID = (0.55, 0.62, 0.67, 0.9, 1.1)
"""With the lower edge of the band at friction ratio 0.3; at 0.67 a residual grows by more than in the linear limits."""

needs_mujoco = pytest.mark.needs("mujoco")


def planned(variant: Variant = LAWFUL) -> Sweep:
    return figure3((variant,), (0.3,), GRID)


def compared(sweep: Sweep, store: ResultStore | None = None) -> ComparedSweep:
    if store is not None:
        return compare_sweep(sweep, evaluator(store))
    with opened_store(None) as own:
        return compare_sweep(sweep, evaluator(own))


def deviating(result: ComparedSweep, variant: Variant = LAWFUL) -> list[Finding]:
    own = [finding for finding in result.findings if finding.variant == variant]
    return [finding for finding in own if finding.comparison.verdict is Verdict.DISAGREE]


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ResultStore]:
    """What a sound engine, its law and the reference have been asked so far."""
    with ResultStore(tmp_path_factory.mktemp("sound") / "results.sqlite") as store:
        yield store


@pytest.fixture(scope="module")
def result(sound) -> ComparedSweep:
    """Of a sound engine."""
    return compared(planned(), sound)


@needs_mujoco
def test_points_and_edges_that_deviate_are_as_the_law_predicts(result) -> None:
    wrong = deviating(result)
    assert {finding.metric.name for finding in wrong} == {"transmittance", "phase", "band edge"}
    for finding in wrong:
        assert finding.modelled, finding
        assert finding.prediction is not None
        assert abs(finding.prediction.difference) < 1e-3 * abs(finding.comparison.difference)
    assert failures(result.findings) == []


@pytest.mark.slow
@needs_mujoco
@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_an_engine_that_does_not_obey_its_law_is_unmodelled_at_points_and_edges(monkeypatch, factor) -> None:
    press_harder(monkeypatch, LAWFUL, factor)
    result = compared(planned())
    wrong = deviating(result)
    assert {finding.metric.name for finding in wrong} >= {"transmittance", "band edge"}
    assert unmodelled(wrong) == wrong
    assert failures(result.findings) == [f"unmodelled: {len(wrong)} disagreements, of {LAWFUL}"]


@pytest.mark.parametrize(("own", "of_law"), [(None, None), (0.7, None), (None, 0.7), (0.7, 0.7)])
def test_an_edge_that_is_not_there_is_as_the_law_predicts_if_the_law_has_none_either(own, of_law) -> None:
    (case,) = planned().cases
    disagrees = Comparison(Verdict.DISAGREE, "", difference=0.1, per_amplitude=1.0)
    edge = BandEdge(LAWFUL, case, Edge.LOWER, own, disagrees, expected=0.6)
    crossings = {} if of_law is None else {(LAWFUL.law, case, Edge.LOWER): Crossing(of_law)}
    predicted = _predicted_edge(edge, RefinedEdges(crossings, set()), LawPeriod(0.0, 1e-6))
    assert predicted.prediction is not None
    assert predicted.finding.modelled is (own == of_law)


@needs_mujoco
def test_a_tolerance_that_is_given_leaves_the_law_what_both_leave_open(sound) -> None:
    given = GivenTolerance(transmittance_db=1e-3, baseline=REFERENCE)
    result = compared(dataclasses.replace(planned(), tolerance=given), sound)
    wrong = deviating(result)
    assert wrong
    assert unmodelled(wrong) == []


@needs_mujoco
def test_laws_that_have_not_been_run_explain_nothing(tmp_path, sound) -> None:
    sweep = planned()
    with ResultStore(tmp_path / "without.sqlite") as without:
        running = evaluator(sound)
        compare_sweep(sweep, running)
        kept = {task: result for task, result in running._results.items() if "@law" not in task.variant.engine}
        without.keep(list(kept.items()))
        result = compare_sweep(sweep, StoredResults(without))
    wrong = deviating(result)
    assert wrong
    assert {finding.prediction for finding in wrong} == {None}
    assert unmodelled(wrong) == wrong


def test_a_drive_that_is_a_step_late_disagrees_at_every_point_though_no_level_does(monkeypatch) -> None:
    late = Variant("mujoco")
    be_late(monkeypatch)
    result = compared(planned(late))
    wrong = deviating(result, late)
    assert {finding.metric.name for finding in wrong} == {"phase"}
    assert len(wrong) == len(result.points_of(late))
    assert failures(result.findings) == [f"unmodelled: {len(wrong)} disagreements, of {late}"]


def test_a_variant_without_a_certified_steady_state_fails() -> None:
    variant = Variant("mujoco")
    with opened_store(None) as store:
        running = evaluator(store)
        whole = running.evaluate

        def never(tasks):
            lost = Result(status="period limit", residual=1e-3, periods=400, steps_per_period=400, period=1.0)
            others = iter(whole([task for task in tasks if task.variant != variant]))
            return [lost if task.variant == variant else next(others) for task in tasks]

        running.evaluate = never
        result = compare_sweep(planned(variant), running)
    lines = [line for line in failures(result.findings) if line.startswith(f"{variant}: ")]
    assert len(lines) == 1
    assert "without a certified steady state" in lines[0]
