"""A normal force that swings: friction follows it, contacts fly and land as long as they should."""

import math
from dataclasses import replace

import pytest

from multibody_xval.scenarios.catalogue.chains.normal_forces import MODULATED_NORMAL_FORCE
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.model import Case, Config, Result
from multibody_xval.scenarios.ruler.judge import AGREES
from multibody_xval.scenarios.store import Stored
from reference_lcp.errors import ParameterError
from tests.scenarios.in_this_process import OTHER, SHARES, deviating, judged_copy, only, quantities, result_of

CLOSED, OPENS = "a = 0.5, Ω = 2 ω, η_r = 0.7", "a = 1.5, Ω = 2 ω, η_r = 0.5"
SMALL = only(MODULATED_NORMAL_FORCE, CLOSED, OPENS)
FLIGHTS = {"time in the air", "largest gap"}


@pytest.mark.parametrize("config", [SHARES, OTHER])
def test_what_moves_as_the_reference_does_agrees(config) -> None:
    table = judged_copy(SMALL, config)
    assert set(table.verdict) == {AGREES}
    assert set(table[table.case == OPENS].quantity) - set(table[table.case == CLOSED].quantity) == FLIGHTS
    own = table.set_index(["case", "quantity"])
    assert own.exact_kind[CLOSED, "transmittance"] == "proven"
    assert own.exact_kind[OPENS, "transmittance"] == own.exact_kind[CLOSED, "time"] == "extrapolated"
    assert not own.judged[OPENS].any(), "where contacts open numbers are measured"


def test_flights_are_those_of_the_closed_form() -> None:
    for name, case in MODULATED_NORMAL_FORCE.cases.items():
        air, gap = (own for own in MODULATED_NORMAL_FORCE.quantities if own.name in FLIGHTS)
        if not air.of(case):
            assert name.startswith("a = 0.5")
            continue
        chain, drive = case.setting
        assert air.exact(case) == pytest.approx(0.56758, abs=1e-5)
        unit = chain.normal_force[0] / chain.inner_mass[0] / (case.modulation_multiple * drive.angular_frequency) ** 2
        assert gap.exact(case) == pytest.approx(0.807457 * unit / drive.amplitude, rel=1e-6)


@pytest.mark.parametrize("config", [SHARES, OTHER])
def test_friction_under_another_normal_force_deviates(config) -> None:
    """A tenth less of modulation: every flight is lower and shorter."""
    found = deviating(judged_copy(SMALL, config, lambda case: replace(case, modulation=0.9 * case.modulation)))
    assert found >= {(CLOSED, "transmittance"), *((OPENS, name) for name in ("transmittance", *FLIGHTS))}


def fewer(result: Result) -> Result:
    return replace(result, transitions=result.transitions[1:])


def late(result: Result) -> Result:
    return replace(result, transitions=tuple((cell, time + 0.01, mode) for cell, time, mode in result.transitions))


def longer(result: Result) -> Result:
    return replace(result, stuck=tuple(own + 0.02 for own in result.stuck))


@pytest.mark.parametrize("config", [SHARES, OTHER])
@pytest.mark.parametrize(("spoilt", "name"), [(fewer, "missed"), (late, "time"), (longer, "stuck fraction")])
def test_without_an_exact_motion_stick_and_slip_are_those_of_the_reference(spoilt, name, config) -> None:
    assert quantities(judged_copy(only(SMALL, CLOSED), config, spoil=spoilt)) == {name}


def test_what_an_engine_cannot_represent_is_unsupported_with_its_reason() -> None:
    (run,) = only(SMALL, OPENS).own_runs(Config("exudyn-regularised")).values()
    table = numbers(only(SMALL, OPENS), [Stored(run, "1", result_of(run))])
    assert set(table.verdict) == {"unsupported"}
    assert table.value.isna().all()
    assert table.reason.str.startswith(("not installed", "modulation = 1.5: exudyn")).all()


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"modulation": -1.0}, "modulation = -1 "),
        ({"modulation_multiple": 0}, "modulation_multiple = 0 "),
        ({"modulation_multiple": 1.5}, "modulation_multiple = 1.5 "),
        ({"modulation_phase": math.nan}, "modulation_phase = nan "),
    ],
)
def test_an_impossible_modulation_is_refused_with_its_value(wrong, message) -> None:
    with pytest.raises(ParameterError, match=message):
        Case(friction_ratio=0.3, frequency_ratio=0.5, **{"modulation": 0.5, **wrong})
