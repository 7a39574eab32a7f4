"""Writes `answers.csv`: the worst number of every scene, as installed and with the recipe, and what that costs a step.

``python docs/scenes/answers.py [STORE]`` runs what the store lacks, for all engines that are installed: ten minutes.
"""

import sys
from pathlib import Path

import pandas as pd

from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.scenarios.catalogue.scenes.recipes import recipe_results
from multibody_xval.scenarios.runs import TIME_LIMIT
from multibody_xval.scenarios.runs.dask_cluster import executor_for
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.store import opened_store

ANSWERS = Path(__file__).with_name("answers.csv")

COLUMNS = ("engine", "number", "default", "recommended")


def answers(name: str, evaluator: Evaluator) -> list[tuple[str, str, float, float]]:
    """Give the rows of an engine: numbers of scenes, then costs."""
    numbers, costs = recipe_results(name, evaluator)
    rows = [(name, number, own["default"], own["recommended"]) for number, own in numbers.items()]
    return rows + [(name, f"cost of a step, {kind} [×]", 1.0, ratio) for kind, ratio in costs.items()]


def main(store: str | None = None) -> None:
    """Write the table."""
    rows = []
    with (
        opened_store(Path(store) if store else None) as stored,
        Evaluator(stored, executor_for(None, TIME_LIMIT, None)) as evaluator,
    ):
        for name in engine_names():
            if engine(name).scene_worlds and engine(name).unavailable_reason() is None:
                rows += answers(name, evaluator)
    pd.DataFrame(rows, columns=list(COLUMNS)).to_csv(ANSWERS, index=False, float_format="%.4g", lineterminator="\n")


if __name__ == "__main__":
    main(*sys.argv[1:2])
