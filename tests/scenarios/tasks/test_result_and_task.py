"""What a store holds is read back, or refused with the field that is wrong; equal tasks have equal keys."""

import dataclasses
import json

import pytest

from engines.interface.variant import Variant
from reference_lcp.refusal import ParameterError
from scenarios.tasks.parameters import ChainRatios
from scenarios.tasks.result import Result, ResultSummary
from scenarios.tasks.task import SteadyStateTask

TASK = SteadyStateTask(variant=Variant("reference"), friction_ratio=1.0, frequency_ratio=0.9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"status": "solved"}', "status of a result = 'solved'; allowed: converged, "),
        ("{}", "status is missing"),
        ('{"status": "converged", "mood": 1}', "mood is unknown; allowed: status, reason, "),
        ('{"status": "converged", "residual": "small"}', "residual = 'small'; input should be a valid number"),
        ('{"status": "converged", "transitions": [[1, 0.5]]}', r"transitions\.0\.2 is missing"),
        ("{", "invalid JSON"),
    ],
)
def test_wrong_result_is_refused_with_the_field_and_its_value(text: str, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        Result.from_json(text)


def test_summary_of_a_result_without_a_multiple_is_that_of_a_plain_period() -> None:
    assert ResultSummary.from_json('{"status": "converged", "periods": 28}') == ResultSummary("converged", 28, 1)


@pytest.mark.parametrize("ratio", [1, 0.1, 1e-5, 1 / 3])
def test_key_depends_on_values_and_not_on_how_they_are_written(ratio: float) -> None:
    one = dataclasses.replace(TASK, friction_ratio=ratio)
    same = dataclasses.replace(TASK, friction_ratio=float(repr(ratio)), ratios=ChainRatios(mass_ratio=1))
    assert one.key() == same.key()
    assert one.key() != dataclasses.replace(one, frequency_ratio=0.9 + 1e-16 * 2).key()
    assert json.loads(one.text())["task"]["friction_ratio"] == ratio
