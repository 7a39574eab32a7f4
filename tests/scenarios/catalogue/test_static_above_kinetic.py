"""A block that is held by one coefficient of friction and slides with another, and engines that have only one."""

import dataclasses
import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.block import static_above_kinetic
from multibody_xval.scenarios.catalogue.block.base import TIME_STEP
from multibody_xval.scenarios.catalogue.block.static_above_kinetic import (
    BREAKAWAY,
    FAST,
    FOLLOWED,
    JUMP,
    JUMP_TIME,
    RISE_TIME,
    Release,
    StaticAboveKinetic,
)
from multibody_xval.scenarios.runs.transient import run_transients
from multibody_xval.scenarios.verdicts.finding import Finding, Verdict
from multibody_xval.scenarios.verdicts.steady_case import EXACT, REFERENCE
from reference_lcp.chain.simulation import Lane
from reference_lcp.errors import ParameterError
from tests.scenarios.in_process import deviating, findings

ONE_COEFFICIENT = Variant("mujoco")

KILOGRAM = next(release for release in StaticAboveKinetic.cases if str(release) == "1 kg, 1.5")


@pytest.fixture(scope="module")
def one_scale() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(StaticAboveKinetic, "cases", [KILOGRAM])
        yield


@pytest.fixture(scope="module")
def judged(one_scale) -> list[Finding]:
    """What the scenario finds of the reference, and of an engine with one coefficient."""
    return findings(StaticAboveKinetic(), REFERENCE, ONE_COEFFICIENT)


def jump_under_growing_load(release: Release) -> float:
    """First rest of s̈ + Ω² s = Ω² (ΔF + Ḟ t) / k from rest, ΔF = (μ_s − μ_k) λ_N, over 2 ΔF / k.

    ṡ = 0 where tan(Ωt / 2) = −Ω ΔF / Ḟ, and there s = (ΔF (1 − cos Ωt) + Ḟ (t − sin Ωt / Ω)) / k.
    """
    omega, left = math.pi / JUMP_TIME, release.static_ratio - 1
    rate = release.static_ratio * (release.load(RISE_TIME + 1e-6) - release.load(RISE_TIME - 1e-6)) / 2e-6 / omega
    angle = 2 * (math.pi - math.atan(left / rate))
    return (left * (1 - math.cos(angle)) + rate * (angle - math.sin(angle))) / (2 * left)


@pytest.mark.parametrize("release", StaticAboveKinetic.cases, ids=str)
def test_exact_block_holds_the_static_bound_and_jumps_as_the_oscillator_does(release) -> None:
    """But for the sine, whose growth falls during the jump: that is up to a hundredth of it."""
    (result,) = run_transients([release.task(EXACT)])
    numbers = StaticAboveKinetic().numbers(release, result.series)
    counts = math.asin(FAST) / math.pi * JUMP_TIME
    assert numbers[BREAKAWAY] == pytest.approx(release.load(RISE_TIME + counts), abs=release.two_steps)
    assert numbers[JUMP] == pytest.approx(jump_under_growing_load(release), rel=0.01)


def test_block_rests_where_it_has_jumped_to() -> None:
    (result,) = run_transients([KILOGRAM.task(EXACT)])
    slip = np.array(result.series["slip"])
    rested = round((RISE_TIME + 1.5 * JUMP_TIME) / TIME_STEP)
    assert rested < FOLLOWED * RISE_TIME / TIME_STEP
    assert np.ptp(slip[rested:]) < 1e-12


def test_scheme_agrees(judged) -> None:
    of_scheme = [finding for finding in judged if finding.variant == REFERENCE]
    assert {finding.metric for finding in of_scheme} == {BREAKAWAY, JUMP}
    assert not deviating(of_scheme)


@pytest.mark.slow
def test_roundings_grow_with_the_way_of_the_carrier_and_count_against_the_jump(one_scale, monkeypatch) -> None:
    """By ε of the displacement scale each: over the jump they are ε times the way over the jump."""
    (plain,) = (each for each in findings(StaticAboveKinetic(), REFERENCE) if each.metric is JUMP)
    part = 0.01
    monkeypatch.setattr(static_above_kinetic, "round_off", lambda _: part * KILOGRAM.length)
    (rounded,) = (each for each in findings(StaticAboveKinetic(), REFERENCE) if each.metric is JUMP)
    more = rounded.comparison.tolerance - plain.comparison.tolerance
    assert KILOGRAM.travel / KILOGRAM.length > 2
    assert more == pytest.approx(part * KILOGRAM.travel / KILOGRAM.length, rel=0.01)


def altered(monkeypatch: pytest.MonkeyPatch, change: Callable[[Lane], Lane]) -> None:
    """Make the variant ``mujoco`` the reference in lanes that are changed, with the capabilities of the reference."""
    build, preset, answer = Variant.build, Variant.preset, REFERENCE.preset
    assert isinstance(preset, property)

    def wrong(self, lanes):
        return build(REFERENCE, [change(lane) for lane in lanes]) if self.engine == "mujoco" else build(self, lanes)

    monkeypatch.setattr(Variant, "build", wrong)
    monkeypatch.setattr(
        Variant, "preset", property(lambda self: answer if self.engine == "mujoco" else preset.fget(self))
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "metrics"),
    [
        (lambda lane: dataclasses.replace(lane, static_ratio=1.0), {BREAKAWAY, JUMP}),
        (lambda lane: dataclasses.replace(lane, static_ratio=1.01 * lane.static_ratio), {BREAKAWAY, JUMP}),
        (lambda lane: with_kinetic(lane, 1.02), {JUMP}),
    ],
    ids=["one coefficient", "static friction a hundredth too large", "kinetic friction two hundredths too large"],
)
def test_friction_that_is_off_breaks_away_or_jumps_elsewhere(change, metrics, one_scale, monkeypatch) -> None:
    altered(monkeypatch, change)
    judged = findings(StaticAboveKinetic(), Variant("mujoco"))
    wrong = {finding.metric for finding in judged if finding.comparison.verdict is Verdict.DISAGREE}
    assert wrong == metrics


def with_kinetic(lane: Lane, factor: float) -> Lane:
    """Change kinetic friction alone."""
    chain = dataclasses.replace(lane.chain, friction_coefficient=factor * lane.chain.friction_coefficient)
    return dataclasses.replace(lane, chain=chain, static_ratio=lane.static_ratio / factor)


def test_engine_with_one_coefficient_is_blocked_with_the_reason(judged) -> None:
    of_engine = [finding.comparison for finding in judged if finding.variant == ONE_COEFFICIENT]
    assert {comparison.verdict for comparison in of_engine} == {Verdict.BLOCKED}
    assert "static_ratio = 1.5: mujoco" in of_engine[0].reason


@pytest.mark.parametrize("ratio", [0.9, math.nan])
def test_static_friction_below_kinetic_friction_is_refused(ratio) -> None:
    lane = KILOGRAM.task(REFERENCE).lane()
    with pytest.raises(ParameterError, match="static_ratio"):
        dataclasses.replace(lane, static_ratio=ratio)


def test_tasks_without_static_friction_keep_their_keys() -> None:
    task = KILOGRAM.task(REFERENCE)
    assert "static_ratio" in task.content()["task"]
    assert "static_ratio" not in dataclasses.replace(task, static_ratio=1.0).content()["task"]
