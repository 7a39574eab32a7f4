"""Effective friction: the force that keeps a box sliding, over its speed and over its direction to the world's axes."""

import math
from collections.abc import Iterable
from itertools import product

import pandas as pd

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.scene import ContactScene
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.scenario import COMMON_STEP
from multibody_xval.scenarios.catalogue.scenes.pushed_box import ANGLES, BOX
from multibody_xval.scenarios.catalogue.scenes.scene import watched
from multibody_xval.scenarios.compute.scenes import unsupported_reason
from multibody_xval.scenarios.model import Config, Run, Status
from multibody_xval.scenarios.result_tables import names_of
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.table_text import number_texts
from reference_lcp.errors import ParameterError

SPEEDS = (1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1.0)
"""[m/s]."""

STEPS = 1000
"""Of a motion: the second half is read."""

KEPT = 0.2
"""Part of the speed by which its mean may be off: else nothing is said of friction there."""

LEGEND = f"""\
How much friction does a box meet that slides? A box of 0.2 × 0.1 × 0.1 m and 1 kg on the flat, μ = 0.5, is pushed along
its long side, at an angle to the world's axes, so that it keeps a speed, in {STEPS} steps of the engine's own size. By
Coulomb's law the push is μ m g at every speed and angle.

- *friction*: mean of the second half over μ m g, less 1;
- *speed kept*, *aside*: mean speed along the push and across it, over the one that is to be kept. Where it is not kept
  to {KEPT:.0%}, nothing is said of friction.
"""


def driven_box(speed: float, degrees: float, step: float) -> SceneMotion:
    """Give the box of `pushed_box`, kept at a speed [m/s] at an angle to the x axis [°], in steps of this size [s]."""
    scene = ContactScene(turn=math.radians(degrees), boxes=(BOX,))
    return watched(scene, STEPS * step, drive=speed)


def map_runs(configs: Iterable[Config]) -> list[Run]:
    """Give a run for every configuration, angle and speed.

    Raises
    ------
    ParameterError
        If a configuration has no boxes that touch.
    """
    runs = []
    for config, angle, speed in product(configs, ANGLES, SPEEDS):
        own = engine(config.engine).scene_step
        case = driven_box(speed, angle, COMMON_STEP if math.isnan(own) else own)
        if (reason := unsupported_reason(config, case.scene)) is not None:
            raise ParameterError(f"engine = {config}: {reason}")
        runs.append(Run(config, case, STEPS))
    return runs


def friction_map(stored: Iterable[Stored]) -> pd.DataFrame:
    """Give a row a run.

    Columns: ``configuration``, ``engine``, ``formulation``, ``preset``, ``version``, ``speed`` [m/s], ``angle`` [°],
    ``friction``, less 1 [%], NaN where the speed is not kept; ``kept`` and ``aside``, mean speeds over ``speed``;
    ``seconds`` of a processor; ``reason`` where a run failed.
    """
    return pd.DataFrame([_row(own) for own in stored])


def _row(own: Stored) -> dict[str, object]:
    case = own.run.of(SceneMotion)
    assert isinstance(case.scene, ContactScene), "a box is driven"
    done = own.result.status is Status.FINISHED
    friction, kept, aside = own.result.series["held"] if done else (math.nan,) * 3
    return {
        **names_of(own.run.config), "version": own.version, "speed": case.drive,
        "angle": round(math.degrees(case.scene.turn)),
        "friction": 100 * (friction - 1) if abs(kept - 1) <= KEPT else math.nan, "kept": kept, "aside": aside,
        "seconds": own.result.seconds, "reason": own.result.reason,
    }  # fmt: skip


def shown(table: pd.DataFrame) -> pd.DataFrame:
    """Give a row a configuration and angle, a column a speed: friction less 1 [%]."""
    texts = number_texts(table, {"friction": "{:.3g}"})
    wide = texts.pivot(index=["configuration", "angle"], columns="speed", values="friction")
    return wide.rename(columns="{:g} m/s".format).reset_index().astype(str)


def remarks(table: pd.DataFrame) -> list[str]:
    """Say of each configuration what it has no numbers of, and why."""
    lines = []
    for name, own in table[table.friction.isna()].groupby("configuration", sort=False):
        failed = own[own.reason != ""]
        if len(failed):
            lines.append(f"{name}: {len(failed)} runs without a number: {failed.reason.iloc[0]}")
        if len(own) > len(failed):
            lines.append(f"{name}: the speed is not kept in {len(own) - len(failed)} runs")
    return lines
