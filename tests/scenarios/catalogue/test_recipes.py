"""Recipes: what they hold while it is shaken, that they spoil no other scene, and the options that a study finds."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from multibody_xval.scenarios.catalogue import recipes
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.recipes import spoilt, study
from multibody_xval.scenarios.catalogue.scenes.shaken_boxes import HELD_WHILE_SHAKEN, pushed
from multibody_xval.scenarios.model import Config, Run
from multibody_xval.scenarios.running.evaluate import Means, computed
from tests.installed import each_engine
from tests.scenarios.in_this_process import judged

EVERY = {**HELD_WHILE_SHAKEN.cases, **HELD_WHILE_SHAKEN.held_out}
RECIPE = Config("mujoco", "contact", "recommended")


@pytest.mark.slow
@pytest.mark.needs("mujoco")
def test_mujoco_s_recipe_holds_all_that_is_shaken_and_variations_that_it_was_not_found_with() -> None:
    table = judged(replace(HELD_WHILE_SHAKEN, cases=EVERY), RECIPE)
    assert len(table) == 3 * len(EVERY)
    assert table.value.max() < 0.25


PUSHED = ["box2d3", "dart", "mujoco", "ode", "pybullet", "pymunk", "rapier", "sapien", "siconos"]


@pytest.mark.parametrize("name", each_engine(PUSHED))
def test_force_above_the_bound_moves_the_box_in_every_engine_and_one_below_does_not(name) -> None:
    """So what is held was pushed: in half a period a force of 1.6 bounds moves a box, and does not tip it over.

    Engines do not bear each other in one process.
    """
    cases = [replace(pushed(0.0, ((part, 5),)), time=0.1, settling=0.0) for part in (1.6, 0.5)]
    runs = [Run(Config(name, "contact", "default"), case, 100) for case in cases]
    ways = [np.max(np.abs(own.result.series["along"])) for own in computed(runs, Means())]
    assert ways[0] > 1e-3
    assert ways[1] < 2e-4


@pytest.mark.needs("pybullet")
def test_a_study_finds_that_anchors_hold_a_box_on_a_slope(monkeypatch: pytest.MonkeyPatch) -> None:
    slope = SCENARIOS["slope-hold"]
    few = replace(slope, cases={"load 0.5": slope.cases["load 0.5"]}, held_out={"load 0.9": slope.cases["load 0.9"]})
    monkeypatch.setattr(recipes, "scenes_of", lambda _: [few])
    monkeypatch.setattr(recipes, "step_ratio", lambda *_: 1.0)
    recipe = Config("pybullet", "contact", "recommended").changed("linearDamping", 0.04).changed("angularDamping", 0.04)
    table = study(recipe, Means(workers=1)).set_index("options")
    assert list(table.index[:2]) == ["default options", "frictionAnchor"]
    assert table.drift["default options"] > 10
    assert table.drift["frictionAnchor"] < 0.1
    assert not table.front["default options"]


@pytest.mark.needs("sapien")
def test_sapien_s_recipe_spoils_no_scene_and_one_correction_less_does() -> None:
    scenes = [SCENARIOS[name] for name in ("heavy-on-light", "stack-hold", "grip")]
    recipe = Config("sapien", "contact", "recommended")
    less = recipe.changed("solver_velocity_iterations", 0)
    before, own, one_less = (
        pd.concat([judged(scene, config) for scene in scenes])
        for config in (replace(recipe, preset_name="default"), recipe, less)
    )
    assert spoilt(own, before).empty
    assert spoilt(one_less, before).case.str.startswith("100 kg on 1 kg").any()
