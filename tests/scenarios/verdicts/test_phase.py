"""A motion that is late by a step: of the right size, and wrong."""

import dataclasses
import math

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.steady.base import SAME_STEP
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.verdicts.finding import (
    FLOOR_DB,
    PHASE,
    TRANSMITTANCE,
    Finding,
    Verdict,
    amplitude_in_degrees,
    phase_reader,
)
from reference_lcp.chain.linear_response import frictionless_response
from tests.scenarios.conftest import WRONG, InProcess

SCENARIO = CATALOGUE["frictionless-limit"]


class Late(InProcess):
    """Answers by the reference; the base of `WRONG` begins to move a number of steps late."""

    def __init__(self, steps: float):
        super().__init__(lambda task: task)
        self.steps = steps

    def evaluate(self, tasks):
        return [
            self._late(result) if task.variant == WRONG else result
            for task, result in zip(tasks, super().evaluate(tasks), strict=True)
        ]

    def _late(self, result: Result) -> Result:
        return dataclasses.replace(result, phase=result.phase - 2 * math.pi * self.steps / result.steps_per_period)


def findings_of(steps: float) -> list[Finding]:
    return SCENARIO.run([WRONG], Late(steps))


@pytest.mark.parametrize("steps", [0.0, 0.01, 1.0, 7.0])
def test_a_base_that_moves_late_is_found_at_equal_step(steps) -> None:
    verdicts = {finding.comparison.verdict for finding in findings_of(steps) if finding.metric == SAME_STEP}
    assert verdicts == {Verdict.DISAGREE if steps else Verdict.AGREE}


def test_a_base_that_moves_late_by_steps_is_an_error_that_vanishes_with_the_step_and_too_coarse() -> None:
    """Seven steps are 3°, where friction changes the phase by 0.2°; a scheme of its own could be no better."""
    late = [finding for finding in findings_of(7.0) if finding.metric == PHASE]
    assert late[1].comparison.verdict is Verdict.TOO_COARSE
    assert abs(late[1].comparison.difference) == pytest.approx(7 * 360 / 800, abs=0.01)


def test_phase_of_the_linear_chain_is_that_of_its_response() -> None:
    findings = [f for f in SCENARIO.run([Variant("reference")], InProcess(lambda task: task)) if f.metric == PHASE]
    for case, finding in zip(SCENARIO.cases, findings, strict=True):
        chain, drive = case.setting()
        response = frictionless_response(chain, drive)[chain.cells - 1]
        assert finding.expected == pytest.approx(math.degrees(math.atan2(response.imag, response.real)))
        assert finding.comparison.verdict is Verdict.AGREE


def test_phases_on_either_side_of_half_a_turn_are_near() -> None:
    read = phase_reader(math.radians(179), 0.0)
    assert read(Result(status="converged", phase=math.radians(-179))) == pytest.approx(181)


def test_below_the_floor_a_phase_counts_as_its_amplitude_does() -> None:
    """A quarter turn of a hundredth of the floor's amplitude is a hundredth of a quarter turn."""
    late = Result(status="converged", phase=math.pi / 2)
    assert phase_reader(0.0, FLOOR_DB)(late) == pytest.approx(90)
    assert phase_reader(0.0, FLOOR_DB - 40)(late) == pytest.approx(0.9)
    assert amplitude_in_degrees(1e-5, FLOOR_DB - 40) == pytest.approx(amplitude_in_degrees(1e-5, FLOOR_DB))
    assert amplitude_in_degrees(1.0, FLOOR_DB) == 180
    assert TRANSMITTANCE.floor_db == FLOOR_DB
