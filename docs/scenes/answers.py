"""Writes `answers.csv`: the worst number of every scene, with default options and with the recipe, and its cost.

The same numbers then stand in the recipes, next to the adapters; `docs/tables.py` writes them into README and pages.

``python docs/scenes/answers.py [STORE]`` runs what the store lacks, for all engines that are installed: ten minutes.
Rows of the others stay.
"""

import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import pages
import pandas as pd

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.variant import GENERAL
from multibody_xval.reports.reproducers.recipe import recipe_file, recipe_text
from multibody_xval.scenarios.catalogue.recipes import recipe_results, scene_numbers, scenes_of
from multibody_xval.scenarios.catalogue.scenario import scene_steps, scenes_only_configs
from multibody_xval.scenarios.catalogue.worst_numbers import worst_numbers
from multibody_xval.scenarios.running.evaluate import Means

ANSWERS = Path(__file__).with_name("answers.csv")

COLUMNS = ["engine", "number", "default", "recommended", "cured"]


def answers(name: str, means: Means) -> pd.DataFrame:
    """Give the rows of an engine: numbers of scenes, then costs."""
    worst, costs = recipe_results(name, means)
    rows = [(number, own["default"], own["recommended"], own["cured"]) for number, own in worst.iterrows()]
    rows += [(f"cost of a step, {kind} [×]", 1.0, ratio, True) for kind, ratio in costs.items()]
    return pd.DataFrame([(name, *row) for row in rows], columns=COLUMNS)


def of_other_solvers(name: str, means: Means) -> pd.DataFrame:
    """Give the rows of presets that run scenes only, under their names; they have no recipe, and both columns alike."""
    rows = []
    for kind in Formulation:
        scenes = [replace(own, steps=partial(scene_steps, common=())) for own in scenes_of(kind)]
        for config in scenes_only_configs(name, kind):
            found = scene_numbers(scenes, [config], means).assign(engine=str(config))
            worst = worst_numbers(pd.concat([found.assign(preset=preset) for preset in GENERAL]))
            known = worst.droplevel("engine").dropna(subset="default")
            rows += [(str(config), number, *own[[*GENERAL, "cured"]]) for number, own in known.iterrows()]
    return pd.DataFrame(rows, columns=COLUMNS)


def main(store: str | None = None) -> None:
    """Write the table."""
    means = Means(store=Path(store) if store else None)
    here = [name for name in engine_names() if engine(name).scene_worlds and engine(name).unavailable_reason() is None]
    before = pd.read_csv(ANSWERS)
    others = before[~before.engine.str.partition(":")[0].isin(here)]
    new = [rows(name, means) for name in here for rows in (answers, of_other_solvers)]
    table = pd.concat([others, *(own for own in new if len(own))])
    table = table.sort_values("engine", kind="stable")
    table.to_csv(ANSWERS, index=False, float_format="%.4g", lineterminator="\n")
    table = pd.read_csv(ANSWERS)
    for name in here:
        page = recipe_file(engine(name))
        if page is not None:
            text = pages.with_numbers(recipe_text(name), name, table[table.engine == name])
            Path(str(page)).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:2])
