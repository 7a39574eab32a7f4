"""How near boxes of two engines come by a translation of friction: a row for each pair, from the command's own search.

``python docs/results/translations.py [STORE]`` measures it and writes ``translations.csv``.
"""

import sys
from pathlib import Path

import pandas as pd

from multibody_xval.engines.interface.changed_options import value_text
from multibody_xval.scenarios.catalogue.translation import translated
from multibody_xval.scenarios.catalogue.worst_numbers import printed_number
from multibody_xval.scenarios.model import Config
from multibody_xval.scenarios.running.evaluate import Means

PAIRS = (
    ("mujoco:contact:default", "sapien"), ("sapien:contact:default", "mujoco"), ("mujoco:contact:default", "newton"),
    ("drake:contact:recommended", "pybullet"), ("pybullet:contact:default", "sapien"),
    ("mujoco:contact:default", "pybullet"),
)  # fmt: skip

SHOWN = {
    "held": "slope-hold, load 0.9", "slides": "slope-slide, μ 0.5, load 1.5", "stops": "slide-to-stop, 3 m/s, 30° off",
    "pushed at 45°": "pushed-from-rest, 1.2 μmg, 45°", "spun": "spin, 20 rad/s",
}  # fmt: skip


def row(wanted: str, name: str, means: Means) -> dict[str, str]:
    """Give a row: how far apart boxes come with default options, with those that are found, and on what way [mm]."""
    found = translated(Config.parse(wanted), name, means)
    options = [f"{option} = {value_text(value)}" for option, (value, _) in found.options.items()]
    table = found.table.set_index("scene")
    apart = {
        title: "{} → {} of {}".format(*map(printed_number, table.loc[scene, ["default", "found", "way"]]))
        for title, scene in SHOWN.items()
    }
    return {"wanted": wanted, "engine": name, "options": ", ".join(options) or "its own", **apart}


if __name__ == "__main__":
    means = Means(store=Path(sys.argv[1]) if len(sys.argv) > 1 else None, workers=1)
    table = pd.DataFrame([row(*pair, means) for pair in PAIRS])
    table.to_csv(Path(__file__).with_suffix(".csv"), index=False)
