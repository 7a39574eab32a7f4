"""Recipes are pages beside the adapters: their options are those of the presets, their numbers those of a command."""

import importlib.util
import json
import math
import re
import sys
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.engines.interface.presets import Formulation, OfStep
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.recipe import app
from multibody_xval.reports.formatting import significant
from multibody_xval.reports.reproducers.recipe import blocks, by_hand, recipe_file, recipe_text
from multibody_xval.scenarios.catalogue import recipes
from multibody_xval.scenarios.catalogue.scenario import COMMON_STEP
from multibody_xval.scenarios.catalogue.worst_numbers import printed_number, with_recipe
from multibody_xval.scenarios.running.evaluate import Means

DOCS = Path(__file__).parents[3] / "docs"

WITH_PAGE = [name for name in engine_names() if recipe_file(engine(name))]


def pages():
    """Import what writes the numbers, as the command does."""
    spec = importlib.util.spec_from_file_location("pages", DOCS / "scenes" / "pages.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def written(value: object) -> str:
    """Write an option as recipes do."""
    if isinstance(value, tuple):
        return " ".join(map(written, value))
    return f"{value:g}".replace("e+0", "e").replace("e-0", "e-") if isinstance(value, float) else str(value)


def lines_of(name: str) -> str:
    """Give what is to be written in one's own model."""
    return recipe_text(name).split("```")[1].lower().replace(",", "")


@pytest.mark.parametrize("name", WITH_PAGE)
def test_recipe_has_every_option_that_its_presets_change(name) -> None:
    adapter, text = engine(name), lines_of(name)
    step = adapter.scene_step if Formulation.CONTACT in adapter.scene_worlds else COMMON_STEP
    for presets in adapter.capabilities.presets.values():
        if "recommended" in presets:
            own = presets["recommended"]
            for option in own.changed_from(presets["default"]):
                if option not in DERIVED:
                    value = own.value(option, step)
                    assert re.search(rf"(?<![\d.]){re.escape(written(value).lower())}(?![\d.])", text), option
                    if isinstance(own.options[option].value, OfStep):
                        assert own.options[option].value.text.lower() in text


DERIVED = {"joints"}  # Rapier's are inserted into a set that has the value in its name


@pytest.mark.parametrize("name", WITH_PAGE)
def test_below_it_stand_the_numbers_of_the_table_that_the_command_writes(name) -> None:
    rows = pd.read_csv(DOCS / "scenes" / "answers.csv")
    assert recipe_text(name) == pages().with_numbers(recipe_text(name), name, rows[rows.engine == name])


@pytest.mark.parametrize(
    ("name", "few", "cured"),
    [
        pytest.param(name, few, cured, id=name, marks=pytest.mark.needs(name))
        for name, few, cured in (
            ("mujoco", ("slope-hold", "stack-hold", "conveyor", "joint-hold"), 7 * [True]),
            ("pybullet", ("joint-hold", "arm-hold"), [True, True, False, False]),
        )
    ],
)
def test_the_command_measures_the_numbers_of_a_page(name, few, cured, monkeypatch) -> None:
    """PyBullet's recipe cures a joint and no arm."""
    scenes_of = recipes.scenes_of
    monkeypatch.setattr(recipes, "scenes_of", lambda kind: [own for own in scenes_of(kind) if own.name in few])
    monkeypatch.setattr(recipes, "step_ratio", lambda *_: 1.0)
    worst, _ = recipes.recipe_results(name, Means(workers=1))
    assert worst.cured.tolist() == cured
    for number, own in worst.iterrows():
        default, recommended = (float(f"{value:.4g}") for value in (own.default, own.recommended))  # as in answers.csv
        row = " | ".join([number, printed_number(default), with_recipe(recommended, cured=own.cured)])
        assert f"| {row} |" in recipe_text(name)


WORST = {
    "cured [mm]": (2.0, 0.0, True), "not [mm]": (2.0, 1.0, False), "neither [ms]": (math.inf, math.nan, True),
    "wrong [mm]": (1.0, -math.inf, False),
}  # fmt: skip


@pytest.mark.needs("mujoco")
def test_numbers_that_a_recipe_leaves_beyond_what_is_allowed_are_called_not_cured(monkeypatch, capsys) -> None:
    table = pd.DataFrame.from_dict(WORST, orient="index", columns=["default", "recommended", "cured"])
    monkeypatch.setattr(recipes, "recipe_results", lambda *_: (table, {}))
    assert run_command(app, ["mujoco"]) == 0
    printed = [line.split() for line in capsys.readouterr().out.splitlines()]
    rows = [["cured", "[mm]", "2", "0"], ["not", "[mm]", "2", "1", "(not", "cured)"], ["neither", "[ms]", "never", "–"]]
    assert [row for row in printed if row in rows] == rows
    assert printed[-1][:2] == ["Not", "cured:"]
    assert run_command(app, ["mujoco", "--json"]) == 0
    scenes = json.loads(capsys.readouterr().out)["scenes"]
    assert [tuple(own.values()) for own in scenes.values()] == [
        (2.0, 0.0, True), (2.0, 1.0, False), ("never", None, True), (1.0, "failed", False),
    ]  # fmt: skip


@pytest.mark.parametrize("name", WITH_PAGE)
def test_what_is_to_be_pasted_is_printed_unbroken_and_sentences_in_80_columns(capsys, name) -> None:
    assert run_command(app, [name, "--no-run"]) == 0
    out, page = capsys.readouterr().out, by_hand(recipe_text(name))
    code = [line for line in "\n".join(blocks(page)).splitlines() if line.startswith(" ")]
    lines = iter(out.splitlines())
    assert all(line in lines for line in code), "in their order"
    assert max(len(line) for line in out.splitlines() if line not in code) <= 80
    words = page.partition("\n")[2].replace("```text", "").replace("```", "")
    assert out.replace("*", "").split() == words.replace("*", "").split(), "no word is lost, and none is added"


def test_mujoco_s_recipe_says_what_it_is_worth_on_the_chain() -> None:
    cells = pd.read_csv(DOCS / "results/accuracy.csv").set_index(["engine", "formulation", "preset"])
    text = " ".join(recipe_text("mujoco").split())
    joint = [
        significant(cells.loc[("mujoco", "joint", preset), "map, 800 [dB]"]) for preset in ("default", "recommended")
    ]
    assert f"off by {joint[0]} dB by default and by {joint[1]} with this" in text
    periodic = [
        cells.loc[("mujoco", "contact", preset), "periodic"].partition("/") for preset in ("default", "recommended")
    ]
    counts = f"{periodic[0][0]} (default) and {periodic[1][0]} (recipe) of {periodic[0][2]} cases become periodic"
    assert counts in text
