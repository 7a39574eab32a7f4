"""What a shorter time constant of contacts changes in the scenes of MuJoCo's recipe: the worst numbers, over all steps.

``python docs/scenes/solref.py`` writes ``solref.csv`` in two minutes. No preset has the option; it is written into the
scenes' models.
"""

from pathlib import Path
from unittest.mock import patch

import pandas as pd

from multibody_xval.engines.mujoco import scene as scenes
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.worst_numbers import printed_number
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import Config
from multibody_xval.scenarios.store import Stored

NAMES = (
    "slope-hold", "stack-hold", "heavy-on-light", "grip", "held-while-shaken", "slope-slide", "slide-to-stop",
    "conveyor", "pushed-from-rest", "spin",
)  # fmt: skip

TIMES = (0.02, 0.014, 0.01)
"""First numbers of `solref`, MuJoCo's own first [s]."""

SHOWN = 1.0
"""Least number, in its unit, that has a row; drifts always have one."""


def worst(name: str, time: float) -> pd.Series:
    """Give the worst number of each quantity of a scene."""
    own, recipe = scenes.contact_model, Config("mujoco", "contact", "recommended")

    def written(*given: object) -> str:
        return own(*given).replace("<geom ", f'<geom solref="{time} 1" ')  # type: ignore[arg-type]

    with patch.object(scenes, "contact_model", written):
        runs = [run for run in SCENARIOS[name].runs([recipe]) if run.config == recipe]
        stored = [Stored(run, "1", run_batch([run])[0]) for run in runs]
    found = numbers(SCENARIOS[name], stored, [recipe])
    titles = name + ", " + found.quantity + " [" + found.unit + "]"
    return found.value.abs().groupby(titles, sort=False).max()


if __name__ == "__main__":
    table = pd.DataFrame({f"solref {time:g}": pd.concat([worst(name, time) for name in NAMES]) for time in TIMES})
    table = table[(table.max(axis=1) >= SHOWN) | table.index.str.contains("drift")]
    table.map(printed_number).rename_axis("number").to_csv(Path(__file__).with_suffix(".csv"))
