"""What a store holds is read back, or refused with the field that is wrong; equal tasks have equal keys."""

import dataclasses
import json
import math

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.task import SteadyStateTask
from reference_lcp.chain.simulation import OrbitStatus
from reference_lcp.errors import ParameterError

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


def test_what_an_older_result_does_not_have_is_as_usual() -> None:
    text = '{"status": "converged", "periods": 28}'
    assert Result.from_json(text).multiple == 1
    assert Result.from_json(text).series == {}


def test_a_status_that_there_is_not_is_refused() -> None:
    with pytest.raises(ParameterError, match="status of a result = 'not asked'; allowed: converged, period limit, "):
        Result(status="not asked")
    assert {str(status) for status in OrbitStatus} < set(ResultStatus)


@pytest.mark.parametrize("ratio", [1, 0.1, 1e-5, 1 / 3])
def test_key_depends_on_values_and_not_on_how_they_are_written(ratio: float) -> None:
    one = dataclasses.replace(TASK, friction_ratio=ratio)
    same = dataclasses.replace(TASK, friction_ratio=float(repr(ratio)), ratios=ChainRatios(mass_ratio=1))
    assert one.key() == same.key()
    assert one.key() != dataclasses.replace(one, frequency_ratio=0.9 + 1e-16 * 2).key()
    assert json.loads(one.text())["task"]["friction_ratio"] == ratio


FULL = Result(
    status="finished", reason="told", by_engine=True, transmittance_db=-3.25, phase=0.75, residual=1e-9,
    amplification=4.5, periods=33, multiple=2, steps_per_period=400, period=0.25, stuck_fraction=(0.5, 1.0),
    transitions=((1, 0.25, "stick"),), creep=(1e-6, 2e-6), open_fraction=(0.125, 0.0), largest_gap=(0.75, 0.0),
    seconds=0.5, series={"outer": (0.0, 1.5)},
)  # fmt: skip
"""Every field has another value than it has unless it is given: what is lost on the way is noticed."""


def test_every_field_of_an_answer_survives_json() -> None:
    usual = vars(Result(status="converged"))
    assert [name for name, value in vars(FULL).items() if value == usual[name]] == []
    assert Result.from_json(FULL.to_json()) == FULL


@pytest.mark.parametrize("name", [name for name in vars(FULL) if name not in ("status", "transitions")])
def test_answer_that_lost_a_field_is_another_one(name) -> None:
    lost = {key: value for key, value in json.loads(FULL.to_json()).items() if key != name}
    assert Result.from_json(json.dumps(lost)) != FULL


def test_answer_without_numbers_survives_json_as_nan() -> None:
    text = Result(status="diverged").to_json()
    assert "NaN" not in text
    again = Result.from_json(text)
    assert again.status == "diverged"
    for name in ("transmittance_db", "residual", "period", "seconds"):
        assert math.isnan(getattr(again, name)), name
