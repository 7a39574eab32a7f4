"""Numbers of scenarios: a sound copy of the scheme agrees in every kind of case, and what is off deviates."""

from collections.abc import Callable
from dataclasses import replace

import pandas as pd
import pytest

from multibody_xval.scenarios.cases.motions import BlockMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.blocks import held, thrown
from multibody_xval.scenarios.catalogue.chains import broadband, free_decay
from multibody_xval.scenarios.catalogue.chains import steady_states as chains
from multibody_xval.scenarios.catalogue.motion_tables import series
from multibody_xval.scenarios.catalogue.numbers import COLUMNS, numbers
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.catalogue.scenes import held_boxes, scene
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import REFERENCE, AnyCase, Config, Result, Run, Status, failed
from multibody_xval.scenarios.result_tables import full_name
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, UNKNOWN
from multibody_xval.scenarios.store import Stored
from reference_lcp.chain.transient import QUIET, RickerPulse

SHARES, OTHER, DEFAULT = Config("mujoco"), Config("drake"), Config("mujoco", preset_name="default")
"""A judged preset that shares the scheme, one that does not, and one that is measured."""


def only(scenario: Scenario, *names: str) -> Scenario:
    return replace(scenario, cases={name: scenario.cases[name] for name in names})


SHORT_PULSE = replace(
    broadband.RICKER_PULSE,
    cases=broadband.followed(
        RickerPulse(0.01, broadband.RESONATOR_FREQUENCY, QUIET / broadband.RESONATOR_FREQUENCY), 40, (0.03,)
    ),
)

SMALL = {
    "steady states": only(chains.UNIT_CELL, "friction 0.1, η_r 0.45"),
    "free decay": only(free_decay.FREE_DECAY, "inner masses let go"),
    "a pulse": SHORT_PULSE,
    "a block that is thrown": only(thrown.STOPPING_DISTANCE, "1 g, 1.23 m/s"),
    "a block that is held": only(held.STATIC_HOLD, "1 kg, load 0.9"),
}
"""A case of every kind but scenes, which the reference does not run."""


def results(runs: list[Run]) -> list[Stored]:
    return [Stored(run, "1", run_batch([run])[0]) for run in runs]


@pytest.fixture(scope="module")
def ruled() -> dict[str, list[Stored]]:
    """Results of the ruler by scenario."""
    return {name: results([run for run in own.runs([OTHER]) if run.config != OTHER]) for name, own in SMALL.items()}


def copies(
    scenario: Scenario, config: Config, change: Callable[[AnyCase], AnyCase] = lambda case: case
) -> list[Stored]:
    """Results of a copy of the scheme that steps changed cases, said to be those of a configuration."""
    runs = list(scenario.own_runs(config).values())
    return [Stored(run, "1", run_batch([Run(REFERENCE, change(run.case), run.steps)])[0]) for run in runs]


def table_of(scenario: Scenario, ruled: list[Stored], own: list[Stored]) -> pd.DataFrame:
    table = numbers(scenario, [*ruled, *own])
    return table[table.engine != "reference"]


def verdicts(table: pd.DataFrame) -> dict[str, str]:
    return dict(zip(table.quantity, table.verdict, strict=True))


@pytest.mark.parametrize("config", [SHARES, OTHER])
@pytest.mark.parametrize("kind", SMALL)
def test_a_sound_copy_of_the_scheme_agrees(ruled, kind, config) -> None:
    table = table_of(SMALL[kind], ruled[kind], copies(SMALL[kind], config))
    assert set(table.verdict) == {AGREES}
    assert list(table.columns) == COLUMNS
    asked = [own.name for own in SMALL[kind].quantities if own.of is None]
    assert table.quantity.tolist() == asked


def stronger(case: AnyCase) -> AnyCase:
    """Friction that is a hundredth too large."""
    if isinstance(case, BlockMotion):
        return replace(case, block=replace(case.block, normal_force=1.01 * case.block.normal_force))
    return replace(case, friction_ratio=1.01 * case.friction_ratio)  # type: ignore[union-attr, operator]


WRONG_BOUND = {
    "steady states": "transmittance",
    "free decay": "heat of contacts",
    "a pulse": "series",
    "a block that is thrown": "distance",
}
"""Quantities that show a wrong bound."""


@pytest.mark.parametrize("kind", WRONG_BOUND)
def test_friction_that_is_a_hundredth_too_large_deviates_at_equal_steps(ruled, kind) -> None:
    table = table_of(SMALL[kind], ruled[kind], copies(SMALL[kind], SHARES, stronger))
    assert verdicts(table)[WRONG_BOUND[kind]] == DEVIATES


def test_friction_that_is_a_hundredth_too_large_stops_a_block_too_early_by_the_exact_motion(ruled) -> None:
    """Of a preset without a stated accuracy, beside the scheme's error of 0.25 %."""
    kind, config = "a block that is thrown", Config("pybullet", preset_name="default")
    table = table_of(SMALL[kind], ruled[kind], copies(SMALL[kind], config, stronger))
    assert table[table.quantity == "distance"].expected.tolist() == ["exact value"]
    assert verdicts(table)["distance"] == DEVIATES


def test_the_exact_values_are_those_of_textbooks(ruled) -> None:
    kind = "a block that is thrown"
    table = table_of(SMALL[kind], ruled[kind], copies(SMALL[kind], OTHER)).set_index("quantity")
    assert table.exact["distance"] == pytest.approx(1.0, abs=5e-4)  # the carrier takes a little of it
    assert table.exact["drift"] == 0
    assert table.error["distance"] == pytest.approx(table.value["distance"] - table.exact["distance"])


def test_a_block_that_drifts_deviates_whatever_the_preset(ruled) -> None:
    """By 1 µm/s, while 1e-8 of it is what roundings leave."""
    kind = "a block that is held"
    for config in (SHARES, OTHER):
        (held,) = copies(SMALL[kind], config)
        case = held.run.case
        assert isinstance(case, BlockMotion)
        slip = tuple(case.slip / case.scale - 1e-6 * time / case.scale for time in case.row_times)
        drifting = held._replace(result=replace(held.result, series=held.result.series | {"slip": slip}))
        table = table_of(SMALL[kind], ruled[kind], [drifting])
        own = table.set_index("quantity")
        assert own.verdict["drift"] == DEVIATES
        assert own.value["drift"] == pytest.approx(1.0, rel=1e-6)
        assert own.value["growth of drift"] == pytest.approx(0.0, abs=1e-6)


def changed(stored: Stored, transitions: tuple[tuple[int, float, str], ...]) -> Stored:
    return stored._replace(result=replace(stored.result, transitions=transitions))


def test_missed_spurious_and_late_transitions_are_told_apart(ruled) -> None:
    kind = "steady states"
    for config in (SHARES, OTHER):
        (sound,) = copies(SMALL[kind], config)
        known = sound.result.transitions
        fewer = changed(sound, known[:-1])
        more = changed(sound, (*known, (1, (known[0][1] + 0.05) % 1, known[0][2])))
        late = changed(sound, tuple((cell, time + 4 / sound.run.steps, mode) for cell, time, mode in known))
        wrong = {
            name: {quantity for quantity, verdict in verdicts(table_of(SMALL[kind], ruled[kind], [own])).items()
                   if verdict == DEVIATES}
            for name, own in (("fewer", fewer), ("more", more), ("late", late))
        }  # fmt: skip
        assert wrong == {"fewer": {"missed"}, "more": {"spurious"}, "late": {"time"}}


def test_a_contact_that_sticks_too_long_deviates(ruled) -> None:
    kind = "steady states"
    (sound,) = copies(SMALL[kind], OTHER)
    longer = sound._replace(result=replace(sound.result, stuck=(sound.result.stuck[0] + 0.03,)))
    assert verdicts(table_of(SMALL[kind], ruled[kind], [longer]))["stuck fraction"] == DEVIATES


@pytest.mark.parametrize("kind", ["steady states", "free decay", "a pulse", "a block that is thrown"])
def test_without_the_ruler_a_number_is_unknown(kind) -> None:
    found = verdicts(table_of(SMALL[kind], [], copies(SMALL[kind], OTHER)))
    closed = {own.name for own in SMALL[kind].quantities if own.step_error is not None}
    assert {name for name, verdict in found.items() if verdict == UNKNOWN} == set(found) - closed


def test_what_fails_has_the_status_and_the_reason_of_its_run(ruled) -> None:
    kind = "free decay"
    (run,) = SMALL[kind].own_runs(OTHER).values()
    table = table_of(SMALL[kind], ruled[kind], [Stored(run, "1", failed("it crashed"))])
    assert set(table.verdict) == {"failed"}
    assert set(table.reason) == {"it crashed"}
    assert table.error.isna().all()


def test_energies_share_the_error_of_the_step(ruled) -> None:
    kind = "free decay"
    table = table_of(SMALL[kind], ruled[kind], copies(SMALL[kind], OTHER)).set_index("quantity")
    shares = table.scheme_error[["heat of contacts", "energy left", "balance"]]
    assert shares.nunique() == 1


def box(config: Config, drift: float, sag: float = 0.0) -> Stored:
    """Give the result of a box that has drifted along the slope by so many µm/s, and moved by so many mm at first."""
    scenario = only(held_boxes.SLOPE_HOLD, "load 0.5")
    run = list(scenario.own_runs(config).values())[-1]
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
    table = numbers(only(held_boxes.SLOPE_HOLD, "load 0.5"), [box(config, drift, sag)])
    assert tuple(table.verdict) == expected
    assert table.value.tolist() == pytest.approx([drift, sag])
    assert set(table.exact_kind) == {"closed form"}


def test_series_are_a_row_a_number() -> None:
    own = box(RECIPE, 1.0)
    table = series([only(held_boxes.SLOPE_HOLD, "load 0.5")], [own], {full_name(RECIPE)})
    along = table[table.series == "along"]
    assert along[["case", "row", "value"]].to_numpy().tolist() == [["load 0.5, 1 ms", 1, 2e-6]]
    assert table[table.series == "from the start"].row.tolist() == [1, 2, 3]
    assert series([only(held_boxes.SLOPE_HOLD, "load 0.9")], [own], {full_name(RECIPE)}).empty
    assert series([held_boxes.SLOPE_HOLD], [own], {"another"}).empty


def test_scenes_are_judged_of_recipes_alone() -> None:
    scenario = only(held_boxes.SLOPE_HOLD, "load 0.5")
    table = numbers(scenario, [box(SOFT, 0.0), box(Config("mujoco", "contact", "default"), 0.0)])
    assert dict(zip(table.preset, table.judged, strict=True)) == {"recommended": True, "default": False}


def test_scenes_are_run_with_presets_that_hold_in_any_model() -> None:
    configs = SCENARIOS["slope-hold"].configs(["mujoco"])
    assert [config.preset_name for config in configs] == ["default", "recommended"]
    assert {config.formulation for config in configs} == {"contact"}


def test_all_runs_of_the_ruler_are_planned() -> None:
    """A number of a run that was planned is never unknown for want of another run."""
    for scenario in SCENARIOS.values():
        runs = scenario.runs([RECIPE if next(iter(scenario.cases.values())).cells == 0 else OTHER])
        assert len(set(runs)) == len(runs)
        steps = {run.steps for run in runs if run.config == REFERENCE}
        own = {run.steps for run in runs if run.config == OTHER}
        assert steps >= {factor * count for count in own for factor in (1, 2, 4, 8)} or not steps
