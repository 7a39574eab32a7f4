"""How far boxes are from where they should be that are pushed at an angle to their own sides, in plain MuJoCo.

``python docs/scenes/pushed_boxes.py`` writes ``pushed_boxes.csv`` in a minute. What is pasted into the model is
read from MuJoCo's recipe.
"""

import math
from pathlib import Path

import mujoco
import numpy as np
import pandas as pd

from multibody_xval.reports.reproducers.recipe import blocks, recipe_text

STEP, SECOND, QUARTER = 0.002, 500, 125
"""MuJoCo's own [s]; steps to come to rest in, and of the push."""

LOAD = 1.06
"""Of the push, over μ m g."""

BOXES = {"6 × 6 × 6": (0.03, 0.03), "6 × 6 × 10": (0.03, 0.05), "20 × 20 × 10": (0.1, 0.05)}
"""Half of side and height [m], by the size in cm."""

ANGLES = range(15, 46)
"""Of the push to a box's own sides [°]."""


def pasted(alternative: str = "") -> str:
    """Give what the recipe says to write in MJCF, with the alternative that has a text in it."""
    recipe, *others = blocks(recipe_text("mujoco"))
    lines = [line for line in recipe.partition("Or in Python")[0].splitlines() if line.startswith("    ")]
    return "\n".join([*lines, *(own for own in others if alternative and alternative in own)])


PASTED = {"default options": "", "recipe": pasted(), "harder contacts": pasted("midphase")}
"""Lines at the beginning of a model."""


def off(half: tuple[float, float], friction: float, sole: bool, degrees: float, lines: str) -> float:
    """Give the distance of a pushed box from its exact place, over its exact way [%]."""
    side, height = half
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco>{lines}<option timestep="{STEP}"/><default><geom friction="{friction} 0.005 0.0001"/></default>'
        f'<worldbody><geom type="plane" size="5 5 1"/><body pos="0 0 {height}"><freejoint/>'
        f'<geom type="box" size="{side} {side} {height}" mass="1"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, SECOND)
    begin, angle = data.qpos[:2].copy(), math.radians(degrees)
    forward = np.array([math.cos(angle), math.sin(angle), 0])
    force = LOAD * friction * 9.81 * forward
    data.xfrc_applied[1] = [*force, *(np.cross([0, 0, -height], force) if sole else np.zeros(3))]
    mujoco.mj_step(model, data, QUARTER)
    way = (LOAD - 1) * friction * 9.81 * (STEP * QUARTER) ** 2 / 2
    return 100 * float(np.linalg.norm((data.qpos[:2] - begin) / way - forward[:2]))


def row(size: str, friction: float, place: str) -> dict[str, object]:
    """Give a row: a box that is pushed at its centre or at its sole, along its sides and at an angle, at worst."""
    half, sole = BOXES[size], place == "sole"
    own = {"box [cm]": size, "μ": friction, "pushed at its": place}
    if not sole and LOAD * friction * half[1] > half[0]:
        return own | {"recipe, along its sides [%]": "tips over"}
    own["recipe, along its sides [%]"] = f"{off(half, friction, sole, 0, PASTED['recipe']):.1f}"
    for name, lines in PASTED.items():
        own[f"{name}, at 15 to 45° [%]"] = f"{max(off(half, friction, sole, angle, lines) for angle in ANGLES):.1f}"
    return own


if __name__ == "__main__":
    rows = [row(size, friction, place) for size in BOXES for friction in (0.5, 0.8) for place in ("centre", "sole")]
    pd.DataFrame(rows).to_csv(Path(__file__).with_suffix(".csv"), index=False)
