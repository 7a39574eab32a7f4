"""Numbers of scenarios: a sound copy of the scheme agrees in every kind of case, and what is off deviates."""

import re
from dataclasses import replace

import pytest

from multibody_xval.scenarios.cases.motions import BlockMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.blocks import held, thrown
from multibody_xval.scenarios.catalogue.chains import broadband, free_decay
from multibody_xval.scenarios.catalogue.chains import steady_states as chains
from multibody_xval.scenarios.catalogue.motion_tables import series
from multibody_xval.scenarios.catalogue.numbers import COLUMNS, numbers
from multibody_xval.scenarios.catalogue.scenes import held_boxes, scene
from multibody_xval.scenarios.model import REFERENCE, AnyCase, Config, Result, Run, Status, failed
from multibody_xval.scenarios.result_tables import full_name
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, UNKNOWN
from multibody_xval.scenarios.store import Stored
from reference_lcp.chain.transient import QUIET, RickerPulse
from tests.scenarios.in_this_process import OTHER, SHARES, judged_copy, only, pressed, quantities, result_of

PULSE = RickerPulse(0.01, broadband.RESONATOR_FREQUENCY, QUIET / broadband.RESONATOR_FREQUENCY)

SMALL = {
    "steady states": only(chains.UNIT_CELL, "friction 0.1, η_r 0.45"),
    "free decay": only(free_decay.FREE_DECAY, "inner masses let go"),
    "a pulse": replace(broadband.RICKER_PULSE, cases=broadband.followed(PULSE, 40, (0.03,))),
    "a block that is thrown": only(thrown.STOPPING_DISTANCE, "1 g, 1.23 m/s"),
    "a block that is held": only(held.STATIC_HOLD, "1 kg, load 0.9"),
}
"""A case or two of every kind but scenes, which the reference does not run."""


@pytest.mark.parametrize("config", [SHARES, OTHER])
@pytest.mark.parametrize("kind", SMALL)
def test_a_sound_copy_of_the_scheme_agrees(kind, config) -> None:
    table = judged_copy(SMALL[kind], config)
    assert set(table.verdict) == {AGREES}
    assert list(table.columns) == COLUMNS
    assert set(table.quantity) == {own.name for own in SMALL[kind].quantities if own.of is None}


WRONG_BOUND = {
    "steady states": "transmittance",
    "free decay": "heat of contacts",
    "a pulse": "series",
    "a block that is thrown": "distance",
}
"""Quantities that show a wrong bound."""


@pytest.mark.parametrize("kind", WRONG_BOUND)
def test_friction_that_is_a_hundredth_too_large_deviates_at_equal_steps(kind) -> None:
    def stronger(case: AnyCase) -> AnyCase:
        if isinstance(case, BlockMotion):
            return pressed(1.01)(case)
        return replace(case, friction_ratio=1.01 * case.friction_ratio)  # type: ignore[union-attr, operator]

    assert WRONG_BOUND[kind] in quantities(judged_copy(SMALL[kind], SHARES, stronger))


@pytest.mark.parametrize("config", [SHARES, OTHER])
def test_a_block_that_drifts_deviates_whatever_the_preset(config) -> None:
    """By 1 µm/s, while 1e-8 of it is what roundings leave."""
    case = held.STATIC_HOLD.cases["1 kg, load 0.9"]
    scenario = replace(held.STATIC_HOLD, cases={"held": case})
    slip = tuple(case.slip / case.scale - 1e-6 * time / case.scale for time in case.row_times)
    table = judged_copy(scenario, config, spoil=lambda own: replace(own, series=own.series | {"slip": slip}))
    own = table.set_index("quantity")
    assert own.verdict["drift"] == DEVIATES
    assert own.value["drift"] == pytest.approx(1.0, rel=1e-6)
    assert own.value["growth of drift"] == pytest.approx(0.0, abs=1e-6)


STEPS = 400

SPOILT = {
    "missed": lambda own: replace(own, transitions=own.transitions[:-1]),
    "spurious": lambda own: replace(own, transitions=(*own.transitions, (1, own.transitions[0][1] + 0.05, "stick"))),
    "time": lambda own: replace(own, transitions=tuple((cell, at + 4 / STEPS, to) for cell, at, to in own.transitions)),
    "stuck fraction": lambda own: replace(own, stuck=(own.stuck[0] + 0.03,)),
}


@pytest.mark.parametrize("config", [SHARES, OTHER])
@pytest.mark.parametrize("name", SPOILT)
def test_missed_spurious_and_late_transitions_and_contacts_that_stick_too_long_are_told_apart(name, config) -> None:
    assert quantities(judged_copy(SMALL["steady states"], config, spoil=SPOILT[name])) == {name}


@pytest.mark.parametrize("kind", ["steady states", "free decay", "a pulse", "a block that is thrown"])
def test_without_the_ruler_a_number_is_unknown_and_of_a_failed_run_there_is_none(kind) -> None:
    runs = list(SMALL[kind].own_runs(OTHER).values())
    own = [Stored(run, "1", result_of(Run(REFERENCE, run.case, run.steps))) for run in runs]
    table = numbers(SMALL[kind], own)
    closed = {quantity.name for quantity in SMALL[kind].quantities if quantity.step_error is not None}
    assert set(table.quantity[table.verdict == UNKNOWN]) == set(table.quantity) - closed
    crashed = judged_copy(SMALL[kind], OTHER, spoil=lambda _: failed("it crashed"))
    assert (set(crashed.verdict), set(crashed.reason)) == ({"failed"}, {"it crashed"})
    assert crashed.error.isna().all()


SLOPE = replace(held_boxes.SLOPE_HOLD, cases={"load 0.5": held_boxes.SLOPE_HOLD.cases["load 0.5"]})


def box(config: Config, drift: float, sag: float = 0.0) -> Stored:
    """Give the result of a box that has drifted along the slope by so many µm/s, and moved by so many mm at first."""
    run = list(SLOPE.own_runs(config).values())[-1]
    way = 1e-6 * drift * scene.HOLDING
    series = {"along": (way,), "across": (0.0,), "off": (1.0,), "from the start": (1e-3 * sag, 0.0, 1.0)}
    return Stored(run, "1", Result(status=Status.FINISHED, series=series))


RECIPE, SOFT = Config("pybullet", "contact", "recommended"), Config("mujoco", "contact", "recommended")
"""Without a stated drift, and with one of 0.5 µm/s."""


@pytest.mark.parametrize(
    ("config", "drift", "sag", "expected"),
    [
        (RECIPE, 0.05, 0.5, (AGREES, AGREES)),
        (RECIPE, 0.2, 0.5, (DEVIATES, AGREES)),
        (RECIPE, 0.05, 1.1, (AGREES, DEVIATES)),
        (SOFT, 0.55, 0.5, (AGREES, AGREES)),
        (SOFT, 0.7, 1.1, (DEVIATES, DEVIATES)),
    ],
)
def test_a_box_on_a_slope_stays_where_it_is(config, drift, sag, expected) -> None:
    table = numbers(SLOPE, [box(config, drift, sag)])
    assert tuple(table.verdict) == expected
    assert table.value.tolist() == pytest.approx([drift, sag])
    assert set(table.exact_kind) == {"closed form"}
    assert table.judged.all()


def test_scenes_are_judged_of_recipes_alone() -> None:
    default = Config("mujoco", "contact", "default")
    assert not numbers(SLOPE, [box(default, 0.0)]).judged.any()
    assert SCENARIOS["slope-hold"].configs(["mujoco"]) == [default, SOFT]


def test_series_are_a_row_a_number() -> None:
    table = series([SLOPE], [box(RECIPE, 1.0)], {full_name(RECIPE)})
    along = table[table.series == "along"]
    assert along[["case", "row", "value"]].to_numpy().tolist() == [["load 0.5, 1 ms", 1, 2e-6]]


def test_all_runs_of_the_ruler_are_planned() -> None:
    """A number of a run that was planned is never unknown for want of another run."""
    for scenario in SCENARIOS.values():
        runs = scenario.runs([RECIPE if next(iter(scenario.cases.values())).cells == 0 else OTHER])
        assert len(set(runs)) == len(runs)
        steps = {run.steps for run in runs if run.config == REFERENCE}
        own = {run.steps for run in runs if run.config == OTHER}
        assert steps >= {factor * count for count in own for factor in (1, 2, 4, 8)} or not steps


def test_every_scenario_says_what_it_asks_and_is_found_under_its_name() -> None:
    for name, scenario in SCENARIOS.items():
        assert scenario.name == name
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", name)
        assert scenario.question.endswith("?")
        assert scenario.source
        assert scenario.expects
        names = [quantity.name for quantity in scenario.quantities]
        assert len(set(names)) == len(names) > 0
        assert len(set(scenario.cases.values())) == len(scenario.cases) > 0
