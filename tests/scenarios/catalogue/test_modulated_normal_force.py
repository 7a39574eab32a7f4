"""The scenario of a normal force that changes in time, and the question that it puts."""

import dataclasses
import math

import pytest
from pydantic_core import to_json

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.steady.modulated_normal_force import (
    CASES,
    LARGEST_GAP,
    OPEN_FRACTION,
    STUCK,
    ModulatedNormalForce,
)
from multibody_xval.scenarios.runs.evaluator import Evaluator, StoredResults
from multibody_xval.scenarios.runs.executor import InProcessExecutor, run_batch
from multibody_xval.scenarios.runs.parameters import Modulation
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import SOURCES, SteadyStateTask, key_of
from multibody_xval.scenarios.verdicts.finding import TRANSMITTANCE, Verdict
from reference_lcp.errors import ParameterError

REFERENCE, OTHER = Variant("reference"), Variant("mujoco", "contact")


KNOWN: dict[SteadyStateTask, Result] = {}


class Answering:
    """Answers by the reference alone; what it is asked of another variant it answers from a changed question."""

    def __init__(self, change=lambda task: task):
        self.change = change

    def evaluate(self, tasks):
        tasks = [
            task if task.variant == REFERENCE else dataclasses.replace(self.change(task), variant=REFERENCE)
            for task in tasks
        ]
        missing = [task for task in dict.fromkeys(tasks) if task not in KNOWN]
        if missing:
            KNOWN.update(zip(missing, run_batch(missing), strict=True))
        return [KNOWN[task] for task in tasks]


class NothingRuns(InProcessExecutor):
    """An executor that must not be needed."""

    def run(self, batches):
        assert not list(batches), "a task is run whose result is known"
        return iter(())


def with_modulation(task, factor):
    changed = dataclasses.replace(task.modulation, modulation=factor * task.modulation.modulation)
    return dataclasses.replace(task, modulation=changed)


def test_who_moves_as_the_reference_does_agrees_in_every_case() -> None:
    findings = ModulatedNormalForce().run([OTHER], Answering())
    assert {finding.comparison.verdict for finding in findings} == {Verdict.AGREE}
    lifting = [case for case in CASES if case.modulation > 1]
    assert len(findings) == 5 * len(CASES) + 2 * len(lifting)
    flown = [finding for finding in findings if finding.metric == OPEN_FRACTION]
    assert [finding.expected for finding in flown] == [pytest.approx(0.56758, abs=1e-5)] * len(lifting)
    assert all(finding.value > 0 for finding in findings if finding.metric == LARGEST_GAP)


def test_friction_under_another_normal_force_disagrees() -> None:
    """A tenth less of modulation, and every flight is lower and shorter."""
    findings = ModulatedNormalForce().run([OTHER], Answering(lambda task: with_modulation(task, 0.9)))
    for metric in (OPEN_FRACTION, LARGEST_GAP):
        assert {finding.comparison.verdict for finding in findings if finding.metric == metric} == {Verdict.DISAGREE}
    off = [
        finding
        for finding in findings
        if finding.metric == TRANSMITTANCE and finding.comparison.verdict is Verdict.DISAGREE
    ]
    assert len(off) >= 6


def test_what_cannot_be_represented_is_blocked_with_its_reason() -> None:
    class Refusing(Answering):
        def evaluate(self, tasks):
            return [
                Result.blocked("contacts stay closed") if task.variant != REFERENCE else answer
                for task, answer in zip(tasks, super().evaluate(tasks), strict=True)
            ]

    findings = ModulatedNormalForce().run([OTHER], Refusing())
    assert {(finding.comparison.verdict, finding.comparison.reason) for finding in findings} == {
        (Verdict.BLOCKED, "contacts stay closed")
    }
    assert all(math.isnan(finding.value) for finding in findings)


@pytest.mark.parametrize("workers", [None, 1], ids=["nobody is asked", "asked"])
def test_refusal_is_known_before_the_engine_is_asked(tmp_path, workers) -> None:
    """Joints of PyBullet take a normal force that stays above zero, joints of Exudyn a constant one only."""
    tasks = [
        SteadyStateTask(
            variant=variant, friction_ratio=0.3, frequency_ratio=0.6, modulation=Modulation(modulation=modulation)
        )
        for variant, modulation in [(Variant("pybullet"), 1.5), (Variant("exudyn-regularised"), 0.5)]
    ]
    with ResultStore(tmp_path / "store.sqlite") as store:
        answers = (StoredResults(store) if workers is None else Evaluator(store, NothingRuns())).evaluate(tasks)
    assert [answer.status for answer in answers] == ["blocked", "blocked"]
    for answer, what in zip(answers, ("modulation = 1.5: pybullet", "modulation = 0.5: exudyn"), strict=True):
        assert answer.reason.startswith(("not installed", f"cannot be represented: {what}"))


def test_question_under_a_constant_normal_force_keeps_its_stored_key() -> None:
    plain = SteadyStateTask(variant=REFERENCE, friction_ratio=0.3, frequency_ratio=0.6)
    assert "modulation" not in plain.content()["task"]
    asked = {name: value for name, value in plain.content().items() if name != SOURCES}
    asked["version"] = "0.1.0"  # of the suite, when this key was stored
    assert key_of(to_json(asked).decode()) == "04b85dbb1b8d7e57ead178f23bc303f4e02642aa544b02934a82e8e8d72f409c"
    modulated = dataclasses.replace(plain, modulation=Modulation(modulation=0.5))
    assert modulated.content()["task"]["modulation"] == {"modulation": 0.5, "multiple": 1, "phase": 0.0}
    assert modulated.key() != plain.key()


def test_key_of_a_modulated_question_holds_the_options_of_that_case() -> None:
    task = SteadyStateTask(
        variant=OTHER, friction_ratio=0.3, frequency_ratio=0.6, modulation=Modulation(modulation=1.5)
    )
    assert "solimp" in task.content()["options"]
    assert "solimp" not in dataclasses.replace(task, modulation=None).content()["options"]


def test_answer_keeps_time_in_the_air_and_largest_gap() -> None:
    task = SteadyStateTask(
        variant=REFERENCE, friction_ratio=0.3, frequency_ratio=0.5, modulation=Modulation(modulation=1.5, multiple=2)
    )
    (answer,) = run_batch([task])
    assert Result.from_json(answer.to_json()) == answer
    assert min(answer.open_fraction) > 0.5
    assert min(answer.largest_gap) > 0
    (plain,) = run_batch([dataclasses.replace(task, modulation=None)])
    assert (plain.open_fraction, plain.largest_gap) == ((), ())


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"modulation": -1.0}, "modulation = -1 "),
        ({"multiple": 0}, "modulation_multiple = 0 "),
        ({"multiple": 1.5}, "modulation_multiple = 1.5 "),
        ({"phase": math.nan}, "modulation_phase = nan"),
    ],
)
def test_impossible_modulation_is_refused_with_its_value(wrong, message) -> None:
    with pytest.raises(ParameterError, match=message):
        Modulation(**{"modulation": 0.5, **wrong})


@pytest.mark.parametrize(("part", "verdict"), [(0.002, Verdict.AGREE), (0.5, Verdict.TOO_COARSE)])
def test_what_agrees_only_by_its_coarse_step_is_inconclusive(part, verdict) -> None:
    class Coarse(Answering):
        def evaluate(self, tasks):
            return [self.off(*pair) for pair in zip(tasks, super().evaluate(tasks), strict=True)]

        def off(self, task, result):
            if task.variant == REFERENCE:
                return result
            error = part * 800 / task.steps_per_period
            return dataclasses.replace(
                result,
                transmittance_db=result.transmittance_db + 20 * math.log10(1 + error),
                stuck_fraction=tuple(own + error for own in result.stuck_fraction),
                open_fraction=tuple((1 + error) * own for own in result.open_fraction),
                largest_gap=tuple((1 + error) * own for own in result.largest_gap),
            )

    findings = ModulatedNormalForce().run([OTHER], Coarse())
    for metric in (TRANSMITTANCE, STUCK, OPEN_FRACTION, LARGEST_GAP):
        assert {finding.comparison.verdict for finding in findings if finding.metric == metric} == {verdict}, metric
