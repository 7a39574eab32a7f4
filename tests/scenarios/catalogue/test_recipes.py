"""Recipes: what they change spoils no other scene, and what they say of the chain is what was measured there."""

from dataclasses import replace
from pathlib import Path

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.formatting import significant
from multibody_xval.reports.reproducers.recipe import recipe_text
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.scenes.base import CREEP
from multibody_xval.scenarios.catalogue.scenes.recipes import Measurement, option_sets
from multibody_xval.scenarios.runs.store import opened_store
from tests.scenarios.in_process import evaluator, findings

ACCURACY = Path(__file__).parents[3] / "docs" / "accuracy.md"


def measured(variant: Variant, *names: str) -> Measurement:
    found = tuple(each for name in names for each in findings(CATALOGUE[name], variant))
    return Measurement(variant, (), found, (), 1.0)


@pytest.mark.parametrize("name", ["drake", "genesis", "mujoco", "newton", "ode", "pybullet", "rapier"])
def test_a_set_of_options_is_the_engine_as_it_comes_but_for_these(name: str) -> None:
    recommended = Variant(name, "contact", "recommended")
    installed = replace(recommended, preset_name="default").preset
    recipe = recommended.preset.changed_from(installed)
    sets = {names: own for names, own in option_sets(recommended).items() if set(names) <= set(recipe)}
    assert len(sets) == 2 ** len(recipe) > 1
    for names, variant in sets.items():
        assert {option: variant.preset[option] for option in names} == {
            option: recommended.preset[option] for option in names
        }
        assert set(variant.preset.changed_from(installed)) == set(names)


def creep_of(variant: Variant, name: str) -> float:
    """Give the largest creep at the engine's own step [µm/s]."""
    found = findings(CATALOGUE[name], variant)
    return max(abs(each.value) for each in found if each.metric is CREEP and "own step" in str(each.case))


@pytest.mark.needs("sapien")
def test_sapien_s_recipe_spoils_no_scene_and_one_correction_less_does() -> None:
    recommended = Variant("sapien", "contact", "recommended")
    scenes = ("heavy-on-light", "stack-hold", "grip")
    installed = measured(replace(recommended, preset_name="default"), *scenes)
    assert measured(recommended, *scenes).spoils(installed) == []
    spoilt = measured(recommended.changed("solver_velocity_iterations", 0), *scenes).spoils(installed)
    assert "100 kg on 1 kg" in {str(each.case).partition(",")[0] for each in spoilt}


@pytest.mark.needs("sapien")
def test_sapien_s_projected_solver_holds_stacks_and_drops_what_is_gripped() -> None:
    installed = Variant("sapien", "contact", "default")
    projected = installed.changed("enable_tgs", False).changed("solver_position_iterations", 50)
    assert creep_of(projected, "slope-hold") < 0.1
    assert creep_of(installed, "slope-hold") > 100
    assert creep_of(projected, "heavy-on-light") < 1000 < creep_of(installed, "heavy-on-light")
    assert creep_of(installed, "grip") < 1000
    assert creep_of(projected, "grip") > 1e6, "it falls"


def test_mujoco_s_recipe_says_what_it_is_worth_on_the_chain() -> None:
    rows = {
        tuple(cells[1:4]): cells
        for line in ACCURACY.read_text(encoding="utf-8").splitlines()
        if len(cells := [cell.strip() for cell in line.split("|")]) > 16
    }
    text = " ".join(recipe_text("mujoco").split())
    joint = [significant(float(rows["mujoco", "joint", preset][6])) for preset in ("default", "recommended")]
    assert f"off by {joint[0]} dB as installed and by {joint[1]} with this" in text
    certified = [rows["mujoco", "contact", preset][15].partition("/") for preset in ("default", "recommended")]
    assert f"{certified[0][0]} and {certified[1][0]} of {certified[0][2]} motions repeat" in text


@pytest.mark.needs("drake")
def test_no_one_modulus_of_drake_slides_and_holds_what_is_heavy() -> None:
    recommended = Variant("drake", "contact", "recommended")
    stiffer = recommended.changed("hydroelastic_modulus", 2e7)
    heavy, slide = CATALOGUE["heavy-on-light"], CATALOGUE["slope-slide"]
    steep = [case for case in slide.cases if case.name == "μ 0.8, load 3"]
    with opened_store(None) as store, evaluator(store) as running:
        creep = [heavy.judged([own], heavy.cases, running)[0].value for own in (recommended, stiffer)]
        off = [slide.judged([own], steep, running)[0].value for own in (recommended, stiffer)]
    assert abs(creep[1]) < 2e3 < abs(creep[0]), "it falls with the softer one"
    assert abs(off[0]) < 20 < abs(off[1]), "it tips over with the stiffer one [%]"
