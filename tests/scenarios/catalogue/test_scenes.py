"""Scenes as users write them: closed forms, and engines that are wrong by little."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.scenes.spinning_box import CORNERS, UNIFORM
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES
from tests.scenarios.point_mass import Wrong, point_mass_numbers

SCENES = [name for name, own in SCENARIOS.items() if isinstance(next(iter(own.cases.values())), SceneMotion)]
HOLDING = ("slope-hold", "stack-hold", "heavy-on-light", "grip", "held-while-shaken", "joint-hold", "arm-hold")
SLIDING = ("slope-slide", "slide-to-stop", "conveyor", "pushed-from-rest")


def each_of(names):
    """Parametrise a test: by default a box that may slide and a joint that may turn."""
    slow = {name: [] if name in ("slope-hold", "arm-hold") else [pytest.mark.slow] for name in names}
    return pytest.mark.parametrize("name", [pytest.param(name, marks=own) for name, own in slow.items()])


def off(table: pd.DataFrame) -> pd.DataFrame:
    return table[table.verdict != AGREES]


@pytest.mark.parametrize("name", SCENES)
def test_coulomb_s_law_in_euler_s_steps_agrees_with_every_scene(name) -> None:
    scenario = SCENARIOS[name]
    table = point_mass_numbers(replace(scenario, cases={**scenario.cases, **scenario.held_out}))
    assert set(table.verdict) == {AGREES}
    assert set(table.exact_kind) == {"closed form"}


@each_of(HOLDING)
def test_drift_of_a_micrometre_a_second_is_found_in_everything_that_should_hold(name) -> None:
    table = point_mass_numbers(SCENARIOS[name], Wrong(drift=1e-6))
    drifts = table[table.quantity.isin(["drift", "turning"])]
    assert set(drifts.verdict) == {DEVIATES}


def test_no_preset_states_a_drift_that_would_hide_a_micrometre_a_second() -> None:
    each_engine = [engine(name).capabilities.presets for name in engine_names()]
    stated = [own.accuracy_of("drift") for presets in each_engine for each in presets.values() for own in each.values()]
    assert max(stated) <= 0.5
    creep = [own.accuracy_of("creep") for presets in each_engine for each in presets.values() for own in each.values()]
    load = 0.9 * 2  # of the hinge, which without friction would have this mean velocity [rad/s]
    assert 1e6 * load * max(creep) < 1


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.99, 1.01])
@pytest.mark.parametrize("name", SLIDING)
def test_friction_that_is_wrong_by_a_hundredth_is_found_in_everything_that_slides(name, factor) -> None:
    """Where Euler's own step is a smaller error than that: at 1 ms, and not at 1 m/s."""
    table = point_mass_numbers(SCENARIOS[name], Wrong(friction=factor))
    fine = table[table.case.str.endswith("1 ms")]
    slow = set(fine.case[fine.case.str.startswith("1 m/s, 1 ms")])
    assert set(off(fine).case) | slow == set(fine.case)
    assert len(off(fine))


@pytest.mark.parametrize(("friction", "sound"), [(1.01, False), (1.0, True), (UNIFORM / CORNERS, True), (0.53, False)])
def test_torque_that_no_pressure_can_make_is_found(friction, sound) -> None:
    """More than at the corners, or less than under a uniform pressure: the latter is 0.541 of the former."""
    table = point_mass_numbers(SCENARIOS["spin"], Wrong(friction=friction))
    fine = table[table.case.str.endswith("1 ms")].set_index("quantity")
    assert set(off(fine).index) == (set() if sound else {"torque"})
    lowest = 100 * (UNIFORM / CORNERS - 1)
    assert fine.exact["torque"] == pytest.approx(np.clip(fine.value["torque"], lowest, 0.0))


@each_of([name for name in HOLDING if name not in ("joint-hold", "held-while-shaken")])
def test_what_falls_at_once_and_rests_is_found(name) -> None:
    """It does not drift when that is measured."""
    table = point_mass_numbers(SCENARIOS[name], Wrong(fall=0.01))
    assert len(off(table))
    assert set(off(table).quantity) <= {"sag", "turned"}
