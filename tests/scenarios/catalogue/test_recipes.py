"""Recipes: what they change spoils no other scene, and what they say of the chain is what was measured there."""

from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.reports.formatting import significant
from multibody_xval.reports.reproducers.recipe import recipe_text
from multibody_xval.scenarios.catalogue import recipes
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.recipes import spoilt, study
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import Config
from multibody_xval.scenarios.running.evaluate import Means
from multibody_xval.scenarios.store import Stored

ACCURACY = Path(__file__).parents[3] / "docs" / "accuracy.md"


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


def measured(config: Config) -> pd.DataFrame:
    """Numbers of scenes, run in this process."""
    tables = []
    for scene in (SCENARIOS[name] for name in ("heavy-on-light", "stack-hold", "grip")):
        runs = scene.own_runs(config).values()
        tables.append(numbers(scene, [Stored(run, "1", run_batch([run])[0]) for run in runs]))
    return pd.concat(tables, ignore_index=True)


@pytest.mark.needs("sapien")
def test_sapien_s_recipe_spoils_no_scene_and_one_correction_less_does() -> None:
    recipe = Config("sapien", "contact", "recommended")
    before = measured(replace(recipe, preset_name="default"))
    assert spoilt(measured(recipe), before).empty
    one_less = recipe.changed("solver_velocity_iterations", 0)
    assert spoilt(measured(one_less), before).case.str.startswith("100 kg on 1 kg").any()


def test_mujoco_s_recipe_says_what_it_is_worth_on_the_chain() -> None:
    cells = {
        tuple(own[1:4]): own
        for line in ACCURACY.read_text(encoding="utf-8").splitlines()
        if len(own := [cell.strip() for cell in line.split("|")]) > 16
    }
    text = " ".join(recipe_text("mujoco").split())
    joint = [significant(float(cells["mujoco", "joint", preset][6])) for preset in ("default", "recommended")]
    assert f"off by {joint[0]} dB as installed and by {joint[1]} with this" in text
    periodic = [cells["mujoco", "contact", preset][15].partition("/") for preset in ("default", "recommended")]
    assert f"{periodic[0][0]} and {periodic[1][0]} of {periodic[0][2]} motions repeat" in text
