"""A block that is held by one coefficient of friction and slides with another, and engines that have only one."""

import math
from dataclasses import replace

import pytest

from multibody_xval.scenarios.cases.motions import BlockMotion
from multibody_xval.scenarios.catalogue.blocks import static_friction as own
from multibody_xval.scenarios.model import EXACT, Run
from multibody_xval.scenarios.ruler.judge import AGREES
from reference_lcp.errors import ParameterError
from tests.scenarios.in_this_process import (
    OTHER,
    SHARES,
    changed_block,
    judged,
    judged_copy,
    only,
    quantities,
    result_of,
)

ONE = only(own.STATIC_ABOVE_KINETIC, "1 kg, 1.5")
(KILOGRAM,) = ONE.cases.values()
assert isinstance(KILOGRAM, BlockMotion)


def jump_under_growing_load(ratio: float) -> float:
    """First rest of s̈ + Ω² s = Ω² (ΔF + Ḟ t) / k from rest, ΔF = (μ_s − μ_k) λ_N, over 2 ΔF / k.

    ṡ = 0 where tan(Ωt / 2) = −Ω ΔF / Ḟ, and there s = (ΔF (1 − cos Ωt) + Ḟ (t − sin Ωt / Ω)) / k.
    """
    omega, left = math.pi / own.JUMP_TIME, ratio - 1
    rate = ratio * (own.load(own.RISE_TIME + 1e-6) - own.load(own.RISE_TIME - 1e-6)) / 2e-6 / omega
    angle = 2 * (math.pi - math.atan(left / rate))
    return (left * (1 - math.cos(angle)) + rate * (angle - math.sin(angle))) / (2 * left)


@pytest.mark.parametrize("case", own.STATIC_ABOVE_KINETIC.cases.values(), ids=own.STATIC_ABOVE_KINETIC.cases)
def test_exact_block_holds_the_static_bound_and_jumps_as_the_oscillator_does(case) -> None:
    """But for the sine, whose growth falls during the jump: that is up to a hundredth of it."""
    run = Run(EXACT, case, case.rows)
    begin = own.load(own.RISE_TIME + math.asin(own.FAST) / math.pi * own.JUMP_TIME)
    assert own.breakaway_load(result_of(run), run) == pytest.approx(begin, abs=own.TWO_STEPS)
    jump = jump_under_growing_load(case.static_ratio)
    assert own.jump(result_of(run), run) == pytest.approx(jump, rel=0.01)


@pytest.mark.parametrize("config", [SHARES, OTHER])
def test_a_sound_copy_of_the_scheme_agrees(config) -> None:
    table = judged_copy(ONE, config)
    assert set(table.verdict) == {AGREES}
    assert table.value.astype(float).to_numpy() == pytest.approx(1, abs=0.01)
    assert set(table.exact) == {1.0}


@pytest.mark.parametrize("config", [SHARES, OTHER])
@pytest.mark.parametrize(
    ("static", "kinetic", "found"),
    [(1 / 1.5, 1.0, {"breakaway", "jump"}), (1.01, 1.0, {"breakaway", "jump"}), (1 / 1.02, 1.02, {"jump"})],
    ids=["one coefficient", "static off", "kinetic off"],
)
def test_friction_that_is_off_breaks_away_or_jumps_elsewhere(static, kinetic, found, config) -> None:
    def change(case):
        return changed_block(replace(case, static_ratio=max(1.0, static * case.static_ratio)), normal_force=kinetic)

    assert quantities(judged_copy(ONE, config, change)) == found


def test_engine_with_one_coefficient_is_unsupported_with_the_ability_that_is_missing() -> None:
    table = judged(ONE, SHARES)
    assert set(table.verdict) == {"unsupported"}
    assert all("static_ratio = 1.5: mujoco" in reason for reason in table.reason)


def test_static_friction_below_kinetic_friction_is_refused() -> None:
    with pytest.raises(ParameterError, match="static_ratio"):
        replace(KILOGRAM, static_ratio=0.9).lane(4 * KILOGRAM.rows)
