"""Writes `answers.csv`: the worst number of every scene, with default options and with the recipe, and its cost.

The same numbers then stand in the recipes, next to the adapters; `docs/tables.py` writes them into README and pages.

``python docs/scenes/answers.py [STORE]`` runs what the store lacks, for all engines that are installed: ten minutes.
Rows of the others stay.
"""

import sys
from pathlib import Path

import pages
import pandas as pd

from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.reports.reproducers.recipe import recipe_file, recipe_text
from multibody_xval.scenarios.catalogue.recipes import recipe_results
from multibody_xval.scenarios.running.evaluate import Means

ANSWERS = Path(__file__).with_name("answers.csv")

COLUMNS = ["engine", "number", "default", "recommended", "cured"]


def answers(name: str, means: Means) -> pd.DataFrame:
    """Give the rows of an engine: numbers of scenes, then costs."""
    worst, costs = recipe_results(name, means)
    rows = [(number, own["default"], own["recommended"], own["cured"]) for number, own in worst.iterrows()]
    rows += [(f"cost of a step, {kind} [×]", 1.0, ratio, True) for kind, ratio in costs.items()]
    return pd.DataFrame([(name, *row) for row in rows], columns=COLUMNS)


def main(store: str | None = None) -> None:
    """Write the table."""
    means = Means(store=Path(store) if store else None)
    here = [name for name in engine_names() if engine(name).scene_worlds and engine(name).unavailable_reason() is None]
    before = pd.read_csv(ANSWERS)
    table = pd.concat([before[~before.engine.isin(here)], *[answers(name, means) for name in here]])
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
