"""Closed forms: what the exact motion and the scheme do of blocks, of linear chains and of Den Hartog's oscillator."""

import math

import numpy as np
import pytest

from multibody_xval.scenarios.catalogue.blocks import published, static_friction, thrown
from multibody_xval.scenarios.catalogue.chains import closed_forms
from multibody_xval.scenarios.catalogue.chains.normal_forces import MODULATED_NORMAL_FORCE
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import EXACT, Case, Config, Run, Status
from multibody_xval.scenarios.ruler.exact_values import proven
from reference_lcp.defaults import FRICTION_COEFFICIENT
from reference_lcp.exact.continuous_sliding import SlidingMotion
from reference_lcp.observables.stick_slip import Mode
from tests.scenarios.in_this_process import SHARES, judged, only, result_of


def each_case(scenario):
    return pytest.mark.parametrize("case", scenario.cases.values(), ids=list(scenario.cases))


@each_case(thrown.STOPPING_DISTANCE)
def test_exact_block_stops_after_half_of_its_velocity_squared_over_the_deceleration(case) -> None:
    """v² / (2 μ λ_N / m) but for the spring, 1e-4 of the bound at the end, and the carrier, of 20 blocks."""
    run = Run(EXACT, case, case.rows)
    numbers = {own.name: own.read(result_of(run), run) for own in thrown.STOPPING_DISTANCE.quantities}
    assert numbers["distance"] == pytest.approx(1, abs=1e-3)
    assert numbers["time"] == pytest.approx(1 - np.sqrt(1e-3), abs=2 * thrown.FOLLOWED / case.rows)
    deceleration = case.block.normal_force / case.block.mass * FRICTION_COEFFICIENT
    assert case.scale == pytest.approx(case.slip_velocity**2 / (2 * deceleration))


@pytest.mark.parametrize("own", published.NUMBERS.values(), ids=lambda own: own.name)
def test_exact_block_on_a_free_carrier_gives_the_published_number(own) -> None:
    """So that the carrier costs no more than the digits that are printed, and the reading."""
    run, expected = Run(EXACT, own.case, own.steps), own.value / own.over
    left = published.MORE_LEFT.get(own.name, published.LEFT)
    assert abs(published.read(result_of(run), run) - expected) <= published.left_open(run)
    assert left < 1e-3 * abs(expected) or own.name == "sdnd104-0.99"


ABOVE = static_friction.STATIC_ABOVE_KINETIC
"""A block that is held by one coefficient of friction and slides with another."""


def jump_under_growing_load(ratio: float) -> float:
    """First rest of s̈ + Ω² s = Ω² (ΔF + Ḟ t) / k from rest, ΔF = (μ_s − μ_k) λ_N, over 2 ΔF / k.

    ṡ = 0 where tan(Ωt / 2) = −Ω ΔF / Ḟ, and there s = (ΔF (1 − cos Ωt) + Ḟ (t − sin Ωt / Ω)) / k.
    """
    load, rise = static_friction.load, static_friction.RISE_TIME
    rate = ratio * (load(rise + 1e-6) - load(rise - 1e-6)) / 2e-6 * static_friction.JUMP_TIME / math.pi
    left = ratio - 1
    angle = 2 * (math.pi - math.atan(left / rate))
    return (left * (1 - math.cos(angle)) + rate * (angle - math.sin(angle))) / (2 * left)


@each_case(ABOVE)
def test_exact_block_holds_the_static_bound_and_jumps_as_the_oscillator_does(case) -> None:
    """But for the sine, whose growth falls during the jump: that is up to a hundredth of it."""
    run, own = Run(EXACT, case, case.rows), static_friction
    begin = own.load(own.RISE_TIME + math.asin(own.FAST) / math.pi * own.JUMP_TIME)
    assert own.breakaway_load(result_of(run), run) == pytest.approx(begin, abs=own.TWO_STEPS)
    assert own.jump(result_of(run), run) == pytest.approx(jump_under_growing_load(case.static_ratio), rel=0.01)


SLIDING = (*closed_forms.DEN_HARTOG.cases.values(), *closed_forms.ONE_CONTACT.cases.values())


@each_case(closed_forms.DEN_HARTOG)
def test_den_hartogs_response_is_proven(case) -> None:
    """Of the chain with its dashpot and its heavy mass, whose motion the printed formula leaves out."""
    assert abs(closed_forms.sliding_response(case) - proven()[case]) < 1e-14


@pytest.mark.parametrize("case", SLIDING)
def test_sliding_response_and_turns_are_those_of_the_exact_motion(case) -> None:
    exact, turn = result_of(Run(EXACT, case, case.steps())), SlidingMotion.of_chain(*case.setting).turn
    turns = sorted([(turn, str(Mode.FORWARD)), ((turn + 0.5) % 1, str(Mode.BACKWARD))])
    assert abs(closed_forms.sliding_response(case) - exact.transmittance) < 1e-10
    assert [mode for _, _, mode in exact.transitions] == [mode for _, mode in turns]
    assert [time for _, time, _ in exact.transitions] == pytest.approx([time for time, _ in turns], abs=1e-9)
    assert not any(exact.stuck)


def test_flights_are_those_of_the_closed_form() -> None:
    air, gap = (own for own in MODULATED_NORMAL_FORCE.quantities if own.name in ("time in the air", "largest gap"))
    flying = {name: case for name, case in MODULATED_NORMAL_FORCE.cases.items() if air.of(case)}
    assert MODULATED_NORMAL_FORCE.cases.keys() - flying == {
        own for own in MODULATED_NORMAL_FORCE.cases if "a = 0.5" in own
    }
    for case in flying.values():
        chain, drive = case.setting
        assert air.exact(case) == pytest.approx(0.56758, abs=1e-5)
        unit = chain.normal_force[0] / chain.inner_mass[0] / (case.modulation_multiple * drive.angular_frequency) ** 2
        assert gap.exact(case) == pytest.approx(0.807457 * unit / drive.amplitude, rel=1e-6)


def test_what_an_engine_cannot_represent_is_unsupported_with_its_reason() -> None:
    opening = only(MODULATED_NORMAL_FORCE, "a = 1.5, Ω = 2 ω, η_r = 0.5")
    for scenario, config, reason in ((only(ABOVE, "1 kg, 1.5"), SHARES, "static_ratio = 1.5: mujoco"),
                                     (opening, Config("exudyn-regularised"), "modulation = 1.5: ")):  # fmt: skip
        table = judged(scenario, config)
        assert set(table.verdict) == {"unsupported"}
        assert table.reason.str.startswith(("not installed", reason)).all()


SOFT = Config("mujoco", preset_name="default")
"""Contacts that creep: far from Euler's steady state, steps of the search may lead to where the motion explodes."""


def test_a_search_that_diverges_next_to_eulers_steady_state_begins_anew() -> None:
    astray = Case(friction_ratio=1.0, frequency_ratio=0.671429)
    found, beside = run_batch([Run(SOFT, own, 400) for own in (astray, Case(friction_ratio=1.0, frequency_ratio=0.9))])
    assert found.status is beside.status is Status.PERIODIC
    near = run_batch([Run(SOFT, Case(friction_ratio=1.0, frequency_ratio=eta), 400) for eta in (0.6709, 0.6719)])
    assert found.transmittance == pytest.approx(sum(own.transmittance for own in near) / 2, rel=1e-3)
