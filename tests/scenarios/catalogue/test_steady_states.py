"""Chains under a harmonic drive: closed forms, what is right agrees, and each kind of mistake is found."""

import cmath
import math
from dataclasses import replace

import pytest

from multibody_xval.scenarios.catalogue.chains import closed_forms
from multibody_xval.scenarios.catalogue.chains import steady_states as chains
from multibody_xval.scenarios.catalogue.chains.closed_forms import (
    DEN_HARTOG,
    FRICTIONLESS_LIMIT,
    LOCKED_LIMIT,
    ONE_CONTACT,
)
from multibody_xval.scenarios.catalogue.chains.normal_forces import MODULATED_NORMAL_FORCE
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import EXACT, Case, Config, Result, Run, Status
from multibody_xval.scenarios.ruler.exact_values import PROVEN_BAR, proven
from multibody_xval.scenarios.ruler.judge import AGREES
from reference_lcp.errors import ParameterError
from reference_lcp.exact.continuous_sliding import SlidingMotion
from reference_lcp.observables.stick_slip import Mode
from tests.scenarios.in_this_process import OTHER, SHARES, deviating, judged, judged_copy, only, quantities, result_of

CLOSED, OPENS = "a = 0.5, Ω = 2 ω, η_r = 0.7", "a = 1.5, Ω = 2 ω, η_r = 0.5"
MODULATED = only(MODULATED_NORMAL_FORCE, CLOSED, OPENS)
FLIGHTS = {"time in the air", "largest gap"}

SMALL = [
    only(chains.FIGURE3, "friction 0.6, η_r 0.9"),
    only(chains.LONG_CHAIN, "15 cells"),
    replace(chains.WIDE_RANGE, cases={name: own for name, own in chains.WIDE_RANGE.cases.items() if own.cells < 5}),
]
CLOSED_FORMS = [FRICTIONLESS_LIMIT, LOCKED_LIMIT, DEN_HARTOG, ONE_CONTACT]

both = pytest.mark.parametrize("config", [SHARES, OTHER])


@both
@pytest.mark.parametrize("scenario", [*SMALL, *CLOSED_FORMS, MODULATED], ids=lambda own: own.name)
def test_a_sound_copy_of_the_scheme_agrees(scenario, config) -> None:
    table = judged_copy(scenario, config)
    assert set(table.verdict) == {AGREES}
    assert set(table.case) == set(scenario.cases)
    kinds = {name: kind for _, name, kind in table[["case", "quantity", "exact_kind"]].itertuples(index=False)}
    if scenario in CLOSED_FORMS:
        assert kinds["transmittance"] == "closed form"
    if scenario is MODULATED:
        assert kinds["transmittance"] == "extrapolated", "no exact motion has contacts that open"
        assert table.groupby("case").judged.any().to_dict() == {CLOSED: config == SHARES, OPENS: False}


def stronger(factor: float):
    return lambda case: replace(case, friction_ratio=factor * case.friction_ratio)


@pytest.mark.parametrize("scenario", SMALL, ids=lambda own: own.name)
def test_friction_that_is_a_thousandth_too_strong_is_found_at_equal_steps(scenario) -> None:
    assert set(judged_copy(scenario, SHARES, stronger(1.001)).verdict) == {"deviates"}


def test_friction_that_is_a_twentieth_too_strong_is_found_next_to_the_exact_motion() -> None:
    """Of a preset that states no accuracy, next to the error of the step alone; Den Hartog's mass hardly feels it."""
    found = deviating(judged_copy(chains.UNIT_CELL, OTHER, stronger(1.05)))
    assert found >= {(name, "transmittance") for name in chains.UNIT_CELL.cases}
    assert "r 1.3, F/P0 0.4" in {case for case, _ in deviating(judged_copy(DEN_HARTOG, OTHER, stronger(1.05)))}


def test_cells_in_the_wrong_order_deviate_on_the_graded_chain() -> None:
    graded = only(chains.GRADED_CHAIN, "η_r 0.6")
    table = judged_copy(graded, OTHER, lambda case: replace(case, friction_ratio=case.friction_ratio[::-1]))
    assert quantities(table) >= {"transmittance", "missed", "spurious", "stuck fraction"}


@both
def test_friction_where_there_should_be_none_and_a_contact_that_gives_way_deviate(config) -> None:
    for scenario, ratio in ((FRICTIONLESS_LIMIT, 0.01), (LOCKED_LIMIT, 0.5)):
        table = judged_copy(scenario, config, lambda case, ratio=ratio: replace(case, friction_ratio=ratio))
        assert quantities(table) == {"transmittance"}


@pytest.mark.parametrize("steps", [0.0, 0.01, 1.0, 7.0])
def test_a_base_that_moves_late_is_found_at_equal_steps(steps: float) -> None:
    """A motion of the right size with a wrong phase."""
    turn = cmath.exp(-2j * cmath.pi * steps / 400)
    scenario = only(FRICTIONLESS_LIMIT, "η_r 0.5")
    table = judged_copy(scenario, SHARES, spoil=lambda own: replace(own, transmittance=turn * own.transmittance))
    assert quantities(table) == ({"transmittance"} if steps else set())


def test_linear_limits_are_the_proven_steady_states_and_need_no_exact_motion() -> None:
    for scenario in (FRICTIONLESS_LIMIT, LOCKED_LIMIT):
        (level,) = scenario.quantities
        assert all(abs(level.exact(case) - proven()[case]) < PROVEN_BAR for case in scenario.cases.values())
        assert EXACT not in {run.config for run in scenario.runs([OTHER])}


@pytest.mark.parametrize("case", DEN_HARTOG.cases.values())
def test_den_hartogs_response_is_proven(case) -> None:
    """Of the chain with its dashpot and its heavy mass, whose motion the printed formula leaves out."""
    assert abs(closed_forms.sliding_response(case) - proven()[case]) < 1e-14


@pytest.mark.parametrize("case", [*DEN_HARTOG.cases.values(), *ONE_CONTACT.cases.values()])
def test_sliding_response_and_turns_are_those_of_the_exact_motion(case) -> None:
    exact = result_of(Run(EXACT, case, case.steps()))
    turn = SlidingMotion.of_chain(*case.setting).turn
    turns = sorted([(turn, str(Mode.FORWARD)), ((turn + 0.5) % 1, str(Mode.BACKWARD))])
    assert abs(closed_forms.sliding_response(case) - exact.transmittance) < 1e-10
    assert [mode for _, _, mode in exact.transitions] == [mode for _, mode in turns]
    assert [time for _, time, _ in exact.transitions] == pytest.approx([time for time, _ in turns], abs=1e-9)
    assert not any(exact.stuck)


def test_flights_are_those_of_the_closed_form() -> None:
    air, gap = (own for own in MODULATED_NORMAL_FORCE.quantities if own.name in FLIGHTS)
    for name, case in MODULATED_NORMAL_FORCE.cases.items():
        assert air.of(case) != name.startswith("a = 0.5")
        if air.of(case):
            chain, drive = case.setting
            assert air.exact(case) == pytest.approx(0.56758, abs=1e-5)
            rate = case.modulation_multiple * drive.angular_frequency
            unit = chain.normal_force[0] / chain.inner_mass[0] / rate**2
            assert gap.exact(case) == pytest.approx(0.807457 * unit / drive.amplitude, rel=1e-6)


@both
def test_friction_under_another_normal_force_deviates(config) -> None:
    """A tenth less of modulation: every flight is lower and shorter."""
    found = deviating(judged_copy(MODULATED, config, lambda case: replace(case, modulation=0.9 * case.modulation)))
    assert found >= {(CLOSED, "transmittance"), *((OPENS, name) for name in ("transmittance", *FLIGHTS))}


def late(result: Result) -> Result:
    return replace(result, transitions=tuple((cell, time + 0.01, mode) for cell, time, mode in result.transitions))


@both
def test_without_an_exact_motion_stick_and_slip_are_those_of_the_reference(config) -> None:
    assert quantities(judged_copy(only(MODULATED, CLOSED), config, spoil=late)) == {"time"}


def test_what_an_engine_cannot_represent_is_unsupported_with_its_reason() -> None:
    table = judged(only(MODULATED, OPENS), Config("exudyn-regularised"))
    assert set(table.verdict) == {"unsupported"}
    assert table.reason.str.startswith(("not installed", "modulation = 1.5: exudyn")).all()


@pytest.mark.parametrize(
    "wrong", [{"modulation": -1.0}, {"modulation_multiple": 0}, {"modulation_phase": math.nan}], ids=str
)
def test_an_impossible_modulation_is_refused_with_its_value(wrong) -> None:
    ((name, value),) = wrong.items()
    with pytest.raises(ParameterError, match=f"{name} = {value:g} "):
        Case(friction_ratio=0.3, frequency_ratio=0.5, **{"modulation": 0.5, **wrong})


SOFT = Config("mujoco", preset_name="default")
"""Contacts that creep: far from Euler's steady state, steps of the search may lead to where the motion explodes."""


def test_a_search_that_diverges_next_to_eulers_steady_state_begins_anew() -> None:
    astray = Case(friction_ratio=1.0, frequency_ratio=0.671429)
    found, beside = run_batch([Run(SOFT, own, 400) for own in (astray, Case(friction_ratio=1.0, frequency_ratio=0.9))])
    assert found.status is beside.status is Status.PERIODIC
    near = run_batch([Run(SOFT, Case(friction_ratio=1.0, frequency_ratio=eta), 400) for eta in (0.6709, 0.6719)])
    assert found.transmittance == pytest.approx(sum(own.transmittance for own in near) / 2, rel=1e-3)
