"""Disagreements that a law predicts, and those that it does not, whatever a text says."""

import math
from dataclasses import replace

import pytest

from multibody_xval.engines.interface.registry import law_of
from multibody_xval.engines.interface.tolerances import STEPS
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.base import run_with_predictions
from multibody_xval.scenarios.catalogue.steady.unit_cell import UnitCell
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.runs.task import Recorded, SteadyStateTask
from multibody_xval.scenarios.verdicts.finding import TRANSMITTANCE, Comparison, Finding, Prediction, Verdict
from multibody_xval.scenarios.verdicts.prediction import PERIODS_OF_ERROR, LawPeriod, with_predictions
from tests.scenarios.in_process import evaluator, press_harder

LAWFUL = Variant("mujoco", "joint", "default")
LAW = law_of(LAWFUL.preset)


class OneCase(UnitCell):
    cases = UnitCell.cases[:1]


def wrong_findings(scenario=None) -> list[Finding]:
    with opened_store(None) as store, evaluator(store) as running:
        findings = run_with_predictions(scenario or OneCase(), [LAWFUL], running)
    return [finding for finding in findings if finding.comparison.verdict is Verdict.DISAGREE]


@pytest.mark.needs("mujoco")
def test_the_soft_friction_of_mujoco_is_as_its_law_predicts_number_by_number() -> None:
    wrong = wrong_findings()
    assert wrong
    assert all(finding.modelled for finding in wrong)
    largest = max(abs(finding.prediction.difference) for finding in wrong if finding.prediction is not None)
    assert largest < 1e-6 * max(abs(finding.comparison.difference) for finding in wrong)


@pytest.mark.needs("mujoco")
@pytest.mark.parametrize("factor", [0.99, 1.01, 10.0])
def test_an_engine_that_does_not_obey_its_law_is_not_excused_by_it(monkeypatch, factor) -> None:
    """The preset has a law and a text; friction that is a hundredth off is found out by both parts of the check."""
    press_harder(monkeypatch, LAWFUL, factor)
    wrong = wrong_findings()
    assert wrong
    assert not any(finding.modelled for finding in wrong)


def finding(variant: Variant, value: float, resolution: float = 0.0) -> Finding:
    comparison = Comparison(Verdict.DISAGREE, "by hand", value + 20.0, 0.1, resolution)
    return Finding(variant, "case", TRANSMITTANCE, value, -20.0, comparison)


def period(distance: float) -> LawPeriod:
    assert LAW is not None
    return LawPeriod(distance, LAW.period_bound)


@pytest.mark.parametrize(
    ("left", "periods", "holds"),
    [
        (0.0, {"case": period(0.0)}, True),
        (1e-9, {"case": period(0.0)}, True),
        (28.0, {"case": period(0.0)}, False),  # another number
        (0.0, {"case": period(1.0)}, False),  # the same number from other steps
        (0.0, {"case": period(math.nan)}, False),
        (0.0, {"another": period(1.0)}, False),  # a case without a period of its own takes the worst
        (math.nan, {"case": period(0.0)}, False),
    ],
)
def test_a_law_predicts_a_number_and_a_period(left, periods, holds) -> None:
    law = LAWFUL.law
    assert law is not None
    judged = with_predictions([finding(LAWFUL, -10.0)], [finding(law, -10.0 - left)], periods)
    assert judged[0].modelled is holds


def test_a_distance_that_the_law_allows_leaves_a_number_what_it_makes_in_many_periods() -> None:
    law = LAWFUL.law
    assert law is not None
    assert LAW is not None
    distance = LAW.period_bound / 10
    judged = with_predictions([finding(LAWFUL, 0.0)], [finding(law, 0.0)], {"case": period(distance)})
    assert judged[0].prediction is not None
    assert judged[0].prediction.allowed == pytest.approx(20 * math.log10(1 + PERIODS_OF_ERROR * distance))


@pytest.mark.parametrize(("text", "growth"), [("rapier:contact:default", 2.0), ("mujoco:joint:default", 1.0)])
def test_roundings_of_four_times_the_steps_add_up_to_twice_as_much_where_each_rounds_by_the_same(text, growth) -> None:
    variant = Variant.parse(text)
    ended = Result(status="finished", series={"distance": (1e-5,), "reference": (1.0,)})
    coarse, fine = (
        LawPeriod.of(
            SteadyStateTask(
                recorded=Recorded.LAW, variant=variant, friction_ratio=0.3, frequency_ratio=0.9, steps_per_period=steps
            ),
            ended,
        )
        for steps in (STEPS, 4 * STEPS)
    )
    law = law_of(variant.preset)
    assert law is not None
    assert coarse == LawPeriod(1e-5, law.period_bound)
    assert fine.bound == pytest.approx(growth * coarse.bound)


def test_a_period_that_has_not_ended_has_no_distance() -> None:
    task = SteadyStateTask(recorded=Recorded.LAW, variant=LAWFUL, friction_ratio=0.3, frequency_ratio=0.9)
    assert math.isnan(LawPeriod.of(task, Result.blocked("no law here")).distance)


def test_a_preset_without_a_law_is_excused_by_no_text() -> None:
    assert Variant("exudyn-bristle", "joint", "default").preset.known_deviation
    assert Variant("exudyn-bristle", "joint", "default").law is None


def test_what_distances_add_up_to_is_that_of_the_worst_case_and_the_bound_holds_in_each() -> None:
    """A solver that stops short in another case's period may do so in this one's steady state."""
    law = LAWFUL.law
    assert law is not None
    assert LAW is not None
    far = LAW.period_bound / 2
    own, of_law = [finding(LAWFUL, 0.0)], [finding(law, 1e-5)]
    for periods, holds in (
        ({"case": period(0.0)}, False),
        ({"case": period(0.0), "another": period(far)}, True),
        ({"case": period(0.0), "another": period(4 * LAW.period_bound)}, True),
        ({"case": period(2 * LAW.period_bound), "another": period(0.0)}, False),
        ({"case": period(far), "another": period(math.nan)}, True),
        ({"case": period(math.nan), "another": period(far)}, False),
    ):
        assert with_predictions(own, of_law, periods)[0].modelled is holds


def test_an_edge_that_neither_engine_nor_law_has_is_modelled() -> None:
    law = LAWFUL.law
    assert law is not None
    nowhere = Comparison(Verdict.DISAGREE, "no edge nearby")
    own, of_law = (Finding(variant, "case", TRANSMITTANCE, math.nan, 0.6, nowhere) for variant in (LAWFUL, law))
    assert with_predictions([own], [of_law], {"case": period(0.0)})[0].modelled
    assert not with_predictions([own], [finding(law, 0.6)], {"case": period(0.0)})[0].modelled


def test_what_a_scenario_predicted_itself_of_a_finding_is_not_replaced_by_the_law() -> None:
    """As friction in a turned row, of which a preset states the bound and no law holds."""
    stated = Prediction(value=0.0, difference=0.0, allowed=1.0, distance=0.0, period_bound=1.0)
    own = replace(finding(LAWFUL, 0.0), prediction=stated)
    (judged,) = with_predictions([own], [finding(LAWFUL, 28.0)], {"case": period(1.0)})
    assert judged.modelled
