"""Copies of the scheme under names of engines: a sound one agrees in every kind of case, and each mistake is found."""

import cmath
from collections.abc import Callable
from dataclasses import replace

import pandas as pd
import pytest

from multibody_xval.engines.interface.presets import LARGEST_ACCURACY
from multibody_xval.scenarios.cases.motions import BlockMotion
from multibody_xval.scenarios.catalogue.blocks.breakaway import BREAKAWAY
from multibody_xval.scenarios.catalogue.blocks.held import STATIC_HOLD
from multibody_xval.scenarios.catalogue.blocks.published import PUBLISHED
from multibody_xval.scenarios.catalogue.blocks.static_friction import STATIC_ABOVE_KINETIC
from multibody_xval.scenarios.catalogue.blocks.thrown import STOPPING_DISTANCE
from multibody_xval.scenarios.catalogue.chains import broadband
from multibody_xval.scenarios.catalogue.chains import steady_states as chains
from multibody_xval.scenarios.catalogue.chains.closed_forms import (
    DEN_HARTOG,
    FRICTIONLESS_LIMIT,
    LOCKED_LIMIT,
    ONE_CONTACT,
)
from multibody_xval.scenarios.catalogue.chains.free_decay import FREE_DECAY
from multibody_xval.scenarios.catalogue.chains.long_run import LONG_RUN
from multibody_xval.scenarios.catalogue.chains.normal_forces import MODULATED_NORMAL_FORCE
from multibody_xval.scenarios.catalogue.numbers import COLUMNS, numbers
from multibody_xval.scenarios.catalogue.scenario import Scenario, steps_a_row
from multibody_xval.scenarios.model import REFERENCE, AnyCase, Config, Result, Run, failed
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, TOO_LARGE, UNKNOWN
from multibody_xval.scenarios.store import Stored
from tests.scenarios.in_this_process import OTHER, SHARES, changed_block, judged_copy, only, pressed, result_of

CLOSED, OPENS = "a = 0.5, Ω = 2 ω, η_r = 0.7", "a = 1.5, Ω = 2 ω, η_r = 0.5"
PULSE = broadband.RICKER_PULSE.cases["μλ_N/(k_c U0) = 0.03"]


def small(scenario: Scenario) -> Scenario:
    """Give the cases of few cells."""
    return replace(scenario, cases={name: case for name, case in scenario.cases.items() if case.cells < 5})


SMALL = {
    "unit cell": only(chains.UNIT_CELL, "friction 0.1, η_r 0.45"),
    "figure 3": only(chains.FIGURE3, "friction 0.6, η_r 0.9"),
    "15 cells": only(chains.LONG_CHAIN, "15 cells"),
    "wide range": small(chains.WIDE_RANGE),
    "graded": only(chains.GRADED_CHAIN, "η_r 0.6"),
    "without friction": FRICTIONLESS_LIMIT,
    "locked": only(LOCKED_LIMIT, "η_r 1.1"),
    "den Hartog": DEN_HARTOG,
    "one contact": only(ONE_CONTACT, "6 masses"),
    "normal force": only(MODULATED_NORMAL_FORCE, CLOSED, OPENS),
    "decay": only(FREE_DECAY, "inner masses let go"),
    "pulse": replace(broadband.RICKER_PULSE, cases=broadband.followed(PULSE.drive, 40, (0.03,))),
    "thrown": only(STOPPING_DISTANCE, "1 g, 1.23 m/s"),
    "held": only(STATIC_HOLD, "1 kg, load 0.99"),
    "pulled": only(BREAKAWAY, "1 g, 0.5 ms"),
    "static above kinetic": only(STATIC_ABOVE_KINETIC, "1 kg, 1.5"),
    "published": PUBLISHED,
    "160 periods": LONG_RUN,
}  # fmt: skip
"""Some cases of every kind but scenes, which the reference does not run."""

both = pytest.mark.parametrize("config", [SHARES, OTHER])


def everywhere(table: pd.DataFrame) -> set[str]:
    """Give the quantities that deviate in every case that has them."""
    return {name for name, own in table.groupby("quantity") if (own.verdict == DEVIATES).all()}


@both
@pytest.mark.parametrize("name", SMALL)
def test_a_sound_copy_of_the_scheme_agrees(name: str, config: Config) -> None:
    scenario, table = SMALL[name], judged_copy(SMALL[name], config)
    assert set(table.verdict) == {AGREES}
    assert (set(table.case), list(table.columns)) == (set(scenario.cases), COLUMNS)
    assert set(table.quantity) >= {own.name for own in scenario.quantities if own.of is None}
    if name == "normal force":
        opens = table[(table.case == OPENS) & (table.quantity == "transmittance")]
        assert set(opens.exact_kind) == {"extrapolated"}, "no exact motion has contacts that open"
        assert table.groupby("case").judged.any().to_dict() == {CLOSED: config == SHARES, OPENS: False}


def stronger(factor: float) -> Callable[[AnyCase], AnyCase]:
    """Multiply friction by a factor."""

    def change(case: AnyCase) -> AnyCase:
        if isinstance(case, BlockMotion):
            return pressed(factor)(case)
        assert case.friction_profile == 1  # type: ignore[union-attr]
        return replace(case, friction_profile=factor)

    return change


def coefficients(static: float, kinetic: float) -> Callable[[AnyCase], AnyCase]:
    """Multiply static friction over kinetic friction, and kinetic friction, by factors."""
    return lambda case: changed_block(
        replace(case, static_ratio=max(1.0, static * case.static_ratio)), normal_force=kinetic
    )


T, SERIES, FLIGHTS = {"transmittance"}, {"series", "η_r 0.9–1.35"}, {"time in the air", "largest gap"}
HEAT, JUMP = {"heat of contacts", "energy left", "offsets"}, {"breakaway", "jump"}

MISTAKES = [
    ("unit cell", stronger(1.001), T, set()),
    ("unit cell", stronger(1.01), T, T),
    ("figure 3", stronger(1.001), T, T),
    ("15 cells", stronger(1.001), T, T),
    ("wide range", stronger(1.001), T, set()),
    ("wide range", stronger(1.01), T, T),
    ("den Hartog", stronger(1.001), T, set()),
    ("den Hartog", stronger(1.05), T, T),
    ("one contact", stronger(1.001), T, set()),
    ("one contact", stronger(1.05), T, T),
    ("graded", lambda own: replace(own, friction_ratio=own.friction_ratio[::-1]), {*T, "missed", "stuck fraction"}, T),
    ("without friction", lambda own: replace(own, friction_ratio=0.01), T, T),
    ("locked", lambda own: replace(own, friction_ratio=0.5), T, T),
    ("normal force", lambda own: replace(own, modulation=0.9 * own.modulation), T | FLIGHTS, T | FLIGHTS),
    ("decay", stronger(1.001), HEAT, set()),
    ("decay", stronger(0.99), HEAT, HEAT),
    ("pulse", stronger(1.01), SERIES, SERIES),
    ("thrown", stronger(0.99), {"distance"}, {"distance"}),
    ("thrown", stronger(1.01), {"distance"}, {"distance"}),
    ("held", stronger(0.98), {"sag"}, {"sag"}),
    ("pulled", stronger(0.99), {"breakaway"}, {"breakaway"}),
    ("pulled", stronger(1.01), {"breakaway"}, {"breakaway"}),
    ("static above kinetic", coefficients(1 / 1.5, 1.0), JUMP, JUMP),
    ("static above kinetic", coefficients(1.01, 1.0), JUMP, JUMP),
    ("static above kinetic", coefficients(1 / 1.02, 1.02), {"jump"}, {"jump"}),
    ("published", stronger(0.97), {"value"}, {"value"}),
]
"""What a copy does otherwise, and by which quantities that is found: at equal steps, and next to the exact value."""


@pytest.mark.parametrize(("name", "change", "shared", "other"), MISTAKES)
def test_a_mistake_is_found(name: str, change, shared: set[str], other: set[str]) -> None:
    for config, expected in ((SHARES, shared), (OTHER, other)):
        found = everywhere(judged_copy(SMALL[name], config, change))
        assert found >= expected
        assert expected or not found, "it is found: the table should say so"


STEPS = 400


def later(part: float) -> Callable[[Result], Result]:
    """Let contacts stick and slip later by a part of the period."""
    return lambda own: replace(own, transitions=tuple((cell, at + part, to) for cell, at, to in own.transitions))


def turned(steps: float) -> Callable[[Result], Result]:
    """Give a motion of the right size with a wrong phase."""
    return lambda own: replace(own, transmittance=cmath.exp(-2j * cmath.pi * steps / STEPS) * own.transmittance)


def stretched(part: float) -> Callable[[Result], Result]:
    def spoil(own: Result) -> Result:
        return replace(own, series={name: tuple((1 + part) * x for x in row) for name, row in own.series.items()})

    return spoil


SPOILT = [
    ("unit cell", lambda own: replace(own, transitions=own.transitions[:-1]), {"missed"}),
    ("unit cell", lambda own: replace(own, transitions=(*own.transitions, (1, own.transitions[0][1] + 0.05, "stick"))),
     {"spurious"}),
    ("unit cell", later(4 / STEPS), {"time"}),
    ("unit cell", lambda own: replace(own, stuck=(own.stuck[0] + 0.03,)), {"stuck fraction"}),
    ("unit cell", turned(1.0), {"transmittance"}),
    ("normal force", later(4 / STEPS), {"time"}),
    ("160 periods", stretched(0.05), {"series"}),
]  # fmt: skip


@both
@pytest.mark.parametrize(("name", "spoil", "expected"), SPOILT)
def test_what_is_wrong_with_a_result_is_told_apart(name: str, spoil, expected: set[str], config: Config) -> None:
    """Transitions that are missed, made up or late; contacts that stick too long; a base that moves late."""
    table = judged_copy(SMALL[name], config, spoil=spoil)
    assert set(table[table.verdict == DEVIATES].quantity) == expected


@pytest.mark.parametrize(("name", "spoil"), [("without friction", turned(0.01)), ("160 periods", stretched(1e-6))])
def test_little_is_found_at_equal_steps(name: str, spoil) -> None:
    """A base that is late by a hundredth of a step; a millionth of a long motion, as round-off grows with its steps."""
    assert everywhere(judged_copy(SMALL[name], SHARES, spoil=spoil)) == {own.name for own in SMALL[name].quantities}


@both
def test_a_block_that_drifts_deviates_whatever_the_preset(config: Config) -> None:
    """By 1 µm/s, while 1e-8 of it is what roundings leave."""
    scenario = replace(STATIC_HOLD, cases={"held": STATIC_HOLD.cases["1 kg, load 0.9"]})
    case = scenario.cases["held"]
    slip = tuple(case.slip / case.scale - 1e-6 * time / case.scale for time in case.row_times)
    table = judged_copy(scenario, config, spoil=lambda own: replace(own, series=own.series | {"slip": slip}))
    own = table.set_index("quantity")
    assert own.verdict["drift"] == DEVIATES
    assert own.value["drift"] == pytest.approx(1.0, rel=1e-6)
    assert own.value["growth of drift"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_a_bound_that_is_a_hundredth_off_is_found_beside_the_largest_accuracy_that_is_stated(factor: float) -> None:
    stated = Config("exudyn-regularised", "contact")
    assert stated.preset.accuracy_of("transmittance") == LARGEST_ACCURACY
    (row,) = judged_copy(only(PUBLISHED, "sdnd104-1.01"), stated, pressed(factor)).itertuples()
    assert row.verdict == DEVIATES
    assert row.distance > 5 * row.allowed


@pytest.mark.parametrize("name", ["unit cell", "decay", "pulse", "thrown"])
def test_without_the_ruler_a_number_is_unknown_and_of_a_failed_run_there_is_none(name: str) -> None:
    scenario = SMALL[name]
    runs = scenario.own_runs(OTHER).values()
    table = numbers(scenario, [Stored(run, "1", result_of(Run(REFERENCE, run.case, run.steps))) for run in runs])
    closed = {own.name for own in scenario.quantities if own.step_error is not None}
    assert set(table.quantity[table.verdict == UNKNOWN]) == set(table.quantity) - closed
    crashed = judged_copy(scenario, OTHER, spoil=lambda _: failed("it crashed"))
    assert (set(crashed.verdict), set(crashed.reason)) == ({"failed"}, {"it crashed"})
    assert crashed.error.isna().all()


def test_a_time_step_that_leaves_out_what_friction_does_shows_nothing() -> None:
    assert set(judged_copy(replace(SMALL["decay"], steps=steps_a_row(1)), OTHER).verdict) == {AGREES, TOO_LARGE}
