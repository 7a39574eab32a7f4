"""The catalogue: right engines agree, each kind of mistake is found by the scenario that is there for it."""

import dataclasses
import re

import numpy as np
import pytest

from multibody_xval.engines.interface.registry import law_of
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.steady.base import LONGEST_SECONDS, SAME_STEP, SteadyScenario
from multibody_xval.scenarios.catalogue.steady.den_hartog import POINTS, expected_motion
from multibody_xval.scenarios.catalogue.steady.linear_limits import LOCKING_FRICTION
from multibody_xval.scenarios.catalogue.steady.unequal_cells import DISORDER_SEED
from multibody_xval.scenarios.catalogue.verdict_table import law_in_words
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.verdicts.finding import TRANSMITTANCE, Verdict
from multibody_xval.scenarios.verdicts.judge import missing
from reference_lcp import Chain, HarmonicForce, steady_state
from reference_lcp.chain.linear_response import stuck_response
from reference_lcp.defaults import CHAIN_STIFFNESS
from tests.reference_lcp.cases import STANDING

REFERENCE, FINISHED = Variant("reference"), Result(status="finished")

QUICK = ("unit-cell", "den-hartog", "frictionless-limit", "locked-limit")
LONG = tuple(name for name, scenario in CATALOGUE.items() if isinstance(scenario, SteadyScenario) and name not in QUICK)


def wrong(findings, metric=None):
    """Give the findings that disagree."""
    return [
        finding
        for finding in findings
        if finding.comparison.verdict is Verdict.DISAGREE and (metric is None or finding.metric == metric)
    ]


def with_friction(factor):
    def falsified(task):
        friction = tuple(np.multiply(task.friction_ratio, factor).ravel().tolist())
        return dataclasses.replace(task, friction_ratio=friction if len(friction) > 1 else friction[0])

    return falsified


def test_every_scenario_says_what_it_asks_and_is_found_under_its_name() -> None:
    for name, scenario in CATALOGUE.items():
        assert scenario.name == name
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", name)
        assert scenario.question.endswith("?")
        assert scenario.source
        assert scenario.expects
        assert scenario.metrics


@pytest.mark.parametrize("name", [*QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in LONG)])
def test_reference_and_who_takes_its_step_agree(verdicts, name) -> None:
    for variant in (REFERENCE, Variant("mujoco")):
        findings = verdicts(CATALOGUE[name], variant=variant)
        assert {finding.comparison.verdict for finding in findings} == {Verdict.AGREE}
        assert {finding.variant for finding in findings} == {variant}


def test_friction_that_is_a_twentieth_too_strong_disagrees(verdicts) -> None:
    cell, oscillator = CATALOGUE["unit-cell"], CATALOGUE["den-hartog"]
    cases = {finding.case for finding in wrong(verdicts(cell, with_friction(1.05)), TRANSMITTANCE)}
    assert cases == {case.label for case in cell.cases}
    # below its own frequency the oscillator's amplitude hardly feels its friction
    assert {finding.case for finding in wrong(verdicts(oscillator, with_friction(1.05)), TRANSMITTANCE)} == {
        "r 1.3, F/P0 0.4"
    }


def test_friction_that_is_a_thousandth_too_strong_is_found_at_equal_step(verdicts) -> None:
    findings = verdicts(CATALOGUE["unit-cell"], with_friction(1.001))
    assert {finding.case for finding in wrong(findings, SAME_STEP)} == {
        case.label for case in CATALOGUE["unit-cell"].cases
    }


def test_friction_where_there_should_be_none_and_a_contact_that_gives_way_disagree(verdicts) -> None:
    rubs = verdicts(CATALOGUE["frictionless-limit"], lambda task: dataclasses.replace(task, friction_ratio=0.01))
    gives_way = verdicts(CATALOGUE["locked-limit"], with_friction(0.1))
    assert wrong(rubs, TRANSMITTANCE)
    assert wrong(gives_way, TRANSMITTANCE)


def test_cells_in_the_wrong_order_disagree_on_the_graded_chain(verdicts) -> None:
    def reversed_friction(task):
        return dataclasses.replace(task, friction_ratio=task.friction_ratio[::-1])

    findings = verdicts(CATALOGUE["graded-chain"], reversed_friction)
    assert wrong(findings, TRANSMITTANCE)
    assert {finding.metric.name for finding in wrong(findings)} >= {"missed", "spurious", "stuck fraction"}


@pytest.mark.parametrize("point", POINTS)
def test_den_hartogs_motion_is_the_event_driven_one_of_a_mass_beside_one_that_stands(point) -> None:
    frequency_ratio, force_ratio = point
    chain = Chain(
        cells=1, outer_mass=np.asarray(1.0), inner_mass=STANDING, chain_stiffness=np.asarray(50.0),
        inner_stiffness=np.asarray(50.0), normal_force=np.asarray(force_ratio * 10), friction_coefficient=np.asarray(1),
    )  # fmt: skip
    exact = steady_state(chain, HarmonicForce(10.0, frequency_ratio * 10), solver="exact")
    expected = expected_motion(*point)
    assert exact.transmittance_db == pytest.approx(expected.transmittance_db, abs=1e-8)
    assert [str(change.kind) for change in exact.transitions] == [kind for _, _, kind in expected.transitions]
    period = 2 * np.pi / (frequency_ratio * 10)
    _, drive = CATALOGUE["den-hartog"].cases[POINTS.index(point)].setting()
    for change, (_, time, _) in zip(exact.transitions, expected.transitions, strict=True):
        assert change.time / period == pytest.approx(time / drive.period, abs=1e-9)


def test_bound_of_the_locked_chain_is_four_times_the_force_that_holds() -> None:
    for case in CATALOGUE["locked-limit"].cases:
        chain, drive = case.setting()
        inner = np.abs(stuck_response(chain, drive)[chain.cells :])
        assert np.all(4 * chain.inner_mass * drive.angular_frequency**2 * inner < chain.friction_bound)
        assert chain.friction_bound[0] == pytest.approx(LOCKING_FRICTION * chain.chain_stiffness[0] * drive.amplitude)


def test_numbers_of_the_disordered_chain_are_printed_cell_by_cell() -> None:
    scenario = CATALOGUE["disordered-chain"]
    assert f"seed {DISORDER_SEED}" in scenario.source
    lines = dict(line.split(" = ") for line in scenario.parameters())
    ratios = {"mass_ratio", "stiffness_ratio", "damping_ratio", "outer_mass_ratio", "chain_stiffness_ratio"}
    assert set(lines) == ratios | {"friction_ratio"}
    for case in scenario.cases:
        chain, _ = case.setting()
        for name, built in {
            "mass_ratio": chain.inner_mass / chain.outer_mass,
            "outer_mass_ratio": chain.outer_mass,
            "chain_stiffness_ratio": chain.chain_stiffness / CHAIN_STIFFNESS,
        }.items():
            assert built.tolist() == pytest.approx([float(number) for number in lines[name].split(", ")])
        assert np.unique(chain.friction_bound).size == chain.cells


class Answering:
    """Gives every question to `WRONG` the same answer, and those of the reference by the reference."""

    def __init__(self, answer):
        self.answer = answer
        self.asked = []

    def evaluate(self, tasks):
        self.asked += [task for task in tasks if task.variant != REFERENCE]
        certified = Result(status="converged", transmittance_db=0.0, steps_per_period=400)
        return [certified if task.variant.engine == "reference" else self.answer for task in tasks]


def test_a_slow_engine_is_asked_the_first_case_only() -> None:
    slow = Result(status="converged", transmittance_db=0.0, residual=1e-9, seconds=0.6 * LONGEST_SECONDS)
    evaluator = Answering(slow)
    scenario = CATALOGUE["frictionless-limit"]
    findings = scenario.run([Variant("mujoco")], evaluator)
    assert {task.frequency_ratio for task in evaluator.asked} == {scenario.cases[0].frequency_ratio}
    later = [finding for finding in findings if finding.case == scenario.cases[1].label]
    assert {finding.comparison.verdict for finding in later} == {Verdict.INCONCLUSIVE}
    assert later[0].comparison.reason == "skipped: η_r 0.9 took 180 s, this would take some 180 s, allowed 150 s"


def test_a_longer_chain_is_not_asked_where_the_shorter_one_says_that_it_takes_too_long() -> None:
    slow = Result(status="converged", transmittance_db=0.0, residual=1e-9, seconds=LONGEST_SECONDS / 6)
    findings = CATALOGUE["long-chain"].run([Variant("mujoco")], Answering(slow))
    reasons = {finding.case: finding.comparison.reason for finding in findings if finding.metric == TRANSMITTANCE}
    assert reasons["15 cells"].startswith("skipped: 7 cells took 50 s, this would take some 230 s")
    assert reasons["30 cells"] == "skipped, as 15 cells was"


@pytest.mark.parametrize(
    ("answer", "verdict", "reason"),
    [
        (Result.blocked("not installed: no wheel"), Verdict.BLOCKED, "not installed: no wheel"),
        (
            Result(status="period limit", residual=2e-3, periods=400, steps_per_period=800),
            Verdict.INCONCLUSIVE,
            "engine at 800 steps a period: period limit after 400 periods, residual 2.0e-03",
        ),
    ],
)
def test_failures_are_verdicts_with_their_reasons(answer, verdict, reason) -> None:
    findings = CATALOGUE["frictionless-limit"].run([Variant("mujoco")], Answering(answer))
    assert {finding.comparison.verdict for finding in findings} == {verdict}
    assert findings[0].comparison.reason == reason


@pytest.mark.parametrize(
    ("unfinished", "expected"),
    [
        (Result.missing(), (Verdict.INCONCLUSIVE, "not evaluated so far")),
        (Result.blocked("crashed"), (Verdict.BLOCKED, "crashed")),
        (FINISHED, None),
    ],
    ids=["that nobody has asked for is no failure", "that failed is blocked", "that is there is compared"],
)
def test_a_motion(unfinished, expected) -> None:
    gap = missing("", [FINISHED, unfinished])
    assert (gap and (gap.verdict, gap.reason)) == expected


@pytest.mark.needs("pymunk")
def test_a_deviation_without_words_is_the_formula_of_its_law() -> None:
    assert law_in_words(Variant("reference")) == ""
    law = law_of(Variant("pymunk", preset_name="default").preset)
    assert law is not None
    assert law_in_words(Variant("pymunk", preset_name="default")) == law.formula
