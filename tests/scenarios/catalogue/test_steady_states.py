"""Chains under a harmonic drive: closed forms, and what engines can make of them."""

import pytest

from multibody_xval.scenarios.catalogue.chains import closed_forms
from multibody_xval.scenarios.catalogue.chains.closed_forms import FRICTIONLESS_LIMIT, LOCKED_LIMIT, SLIDING
from multibody_xval.scenarios.catalogue.chains.normal_forces import MODULATED_NORMAL_FORCE
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import EXACT, Case, Config, Run, Status
from multibody_xval.scenarios.ruler.exact_values import PROVEN_BAR, proven
from reference_lcp.observables.stick_slip import Mode
from tests.scenarios.in_this_process import OTHER, judged, only, result_of


def test_linear_limits_are_the_proven_steady_states_and_need_no_exact_motion() -> None:
    for scenario in (FRICTIONLESS_LIMIT, LOCKED_LIMIT):
        (level,) = scenario.quantities
        assert all(abs(level.exact(case) - proven()[case]) < PROVEN_BAR for case in scenario.cases.values())
        assert EXACT not in {run.config for run in scenario.runs([OTHER])}


@pytest.mark.parametrize("case", SLIDING)
def test_den_hartogs_response_and_turns_are_those_of_the_exact_motion(case) -> None:
    """But for the motion of the heavy mass."""
    bar = closed_forms.left_by_standing(case)
    assert 0.1 * bar < abs(closed_forms.sliding_response(case) - proven()[case]) < bar < 1e-5
    exact, turn = result_of(Run(EXACT, case, case.steps())), SLIDING[case].turn
    turns = sorted([(turn, str(Mode.FORWARD)), ((turn + 0.5) % 1, str(Mode.BACKWARD))])
    assert [mode for _, _, mode in exact.transitions] == [mode for _, mode in turns]
    assert [time for _, time, _ in exact.transitions] == pytest.approx([time for time, _ in turns], abs=1e-6)
    assert exact.stuck == (0.0,)


def test_flights_are_those_of_the_closed_form() -> None:
    air, gap = (own for own in MODULATED_NORMAL_FORCE.quantities if own.name in ("time in the air", "largest gap"))
    for name, case in MODULATED_NORMAL_FORCE.cases.items():
        assert air.of(case) != name.startswith("a = 0.5")
        if air.of(case):
            chain, drive = case.setting
            assert air.exact(case) == pytest.approx(0.56758, abs=1e-5)
            rate = case.modulation_multiple * drive.angular_frequency
            unit = chain.normal_force[0] / chain.inner_mass[0] / rate**2
            assert gap.exact(case) == pytest.approx(0.807457 * unit / drive.amplitude, rel=1e-6)


def test_what_an_engine_cannot_represent_is_unsupported_with_its_reason() -> None:
    opens = only(MODULATED_NORMAL_FORCE, "a = 1.5, Ω = 2 ω, η_r = 0.5")
    table = judged(opens, Config("exudyn-regularised"))
    assert set(table.verdict) == {"unsupported"}
    assert table.reason.str.startswith(("not installed", "modulation = 1.5: exudyn")).all()


SOFT = Config("mujoco", preset_name="default")
"""Contacts that creep: far from Euler's steady state, steps of the search may lead to where the motion explodes."""


def test_a_search_that_diverges_next_to_eulers_steady_state_begins_anew() -> None:
    astray = Case(friction_ratio=1.0, frequency_ratio=0.671429)
    found, beside = run_batch([Run(SOFT, own, 400) for own in (astray, Case(friction_ratio=1.0, frequency_ratio=0.9))])
    assert found.status is beside.status is Status.PERIODIC
    near = run_batch([Run(SOFT, Case(friction_ratio=1.0, frequency_ratio=eta), 400) for eta in (0.6709, 0.6719)])
    assert found.transmittance == pytest.approx(sum(own.transmittance for own in near) / 2, rel=1e-3)
