"""Steady states in closed form: they are those of the exact motion, and what is wrong deviates from them."""

import cmath
from dataclasses import replace

import pytest

from multibody_xval.scenarios.catalogue.chains import closed_forms
from multibody_xval.scenarios.catalogue.chains.closed_forms import DEN_HARTOG, FRICTIONLESS_LIMIT, LOCKED_LIMIT, SLIDING
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.model import EXACT, Run
from multibody_xval.scenarios.ruler.exact_values import PROVEN_BAR, proven
from multibody_xval.scenarios.ruler.judge import AGREES
from reference_lcp.observables.stick_slip import Mode
from tests.scenarios.in_this_process import OTHER, SHARES, judged_copy, only, quantities, result_of

ALL = (FRICTIONLESS_LIMIT, LOCKED_LIMIT, DEN_HARTOG)


@pytest.mark.parametrize("scenario", ALL, ids=lambda own: own.name)
@pytest.mark.parametrize("config", [SHARES, OTHER])
def test_a_sound_copy_of_the_scheme_agrees(scenario: Scenario, config) -> None:
    table = judged_copy(scenario, config)
    assert set(table.verdict) == {AGREES}
    levels = table[table.quantity == "transmittance"]
    assert set(levels.exact_kind) == {"closed form"}
    assert (levels.error > levels.exact_bar).all()  # that of the step


@pytest.mark.parametrize("scenario", [FRICTIONLESS_LIMIT, LOCKED_LIMIT], ids=lambda own: own.name)
def test_linear_limits_are_the_proven_steady_states_and_need_no_exact_motion(scenario: Scenario) -> None:
    (level,) = scenario.quantities
    for case in scenario.cases.values():
        assert abs(level.exact(case) - proven()[case]) < PROVEN_BAR
    assert EXACT not in {run.config for run in scenario.runs([OTHER])}


@pytest.mark.parametrize("case", SLIDING)
def test_den_hartogs_response_is_the_proven_one_within_the_motion_of_the_heavy_mass(case) -> None:
    exact, bar = closed_forms.sliding_response(case), closed_forms.left_by_standing(case)
    right = proven()[case]
    assert 0.1 * bar < abs(exact - right) < bar < 1e-5


@pytest.mark.parametrize("case", SLIDING)
def test_den_hartogs_turns_are_those_of_the_exact_motion(case) -> None:
    exact, turn = result_of(Run(EXACT, case, case.steps())), SLIDING[case].turn
    turns = sorted([(turn, str(Mode.FORWARD)), ((turn + 0.5) % 1, str(Mode.BACKWARD))])
    assert [mode for _, _, mode in exact.transitions] == [mode for _, mode in turns]
    assert [time for _, time, _ in exact.transitions] == pytest.approx([time for time, _ in turns], abs=1e-6)
    assert exact.stuck == (0.0,)


@pytest.mark.parametrize("config", [SHARES, OTHER])
def test_friction_where_there_should_be_none_and_a_contact_that_gives_way_deviate(config) -> None:
    rubs = judged_copy(FRICTIONLESS_LIMIT, config, lambda case: replace(case, friction_ratio=0.01))
    gives_way = judged_copy(LOCKED_LIMIT, config, lambda case: replace(case, friction_ratio=0.5))
    assert quantities(rubs) == quantities(gives_way) == {"transmittance"}


def test_friction_of_the_oscillator_that_is_a_twentieth_too_strong_deviates() -> None:
    """Below its own frequency, the oscillator's amplitude hardly feels it."""
    table = judged_copy(DEN_HARTOG, OTHER, lambda case: replace(case, friction_ratio=1.05 * case.friction_ratio))
    assert "r 1.3, F/P0 0.4" in table[table.verdict == "deviates"].case.tolist()


@pytest.mark.parametrize("steps", [0.0, 0.01, 1.0, 7.0])
def test_a_base_that_moves_late_is_found_at_equal_steps(steps: float) -> None:
    scenario = only(FRICTIONLESS_LIMIT, "η_r 0.5")
    turn = cmath.exp(-2j * cmath.pi * steps / 400)
    table = judged_copy(
        scenario, SHARES, spoil=lambda result: replace(result, transmittance=turn * result.transmittance)
    )
    assert (quantities(table) == {"transmittance"}) == (steps > 0)
