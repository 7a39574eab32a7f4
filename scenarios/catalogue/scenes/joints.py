"""Joints that friction holds: one under a load, and the hinges of an arm under gravity."""

from collections.abc import Mapping

import numpy as np

from multibody_xval.engines.interface.scene import GRAVITY, LINK_LENGTH, LINK_MASS, ArmScene, JointScene
from multibody_xval.scenarios.catalogue.scenes.base import (
    CREEP,
    HOLDING,
    Measured,
    SceneCase,
    SceneScenario,
    creep,
    sag,
)
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.scene import SceneTask
from multibody_xval.scenarios.verdicts.finding import Metric

TURNING = Metric("turning", "µrad/s", f"Mean angular velocity over {HOLDING:g} s of a hinge that friction should hold.")


TURNED = Metric("turned", "mrad", "Angle of a hinge that friction should hold since the scene was built.")


class JointHold(SceneScenario):
    """A joint with dry friction stays where it is under a load below the bound."""

    name = "joint-hold"
    metrics = (TURNING, CREEP)
    cases = tuple(
        SceneCase(
            name=f"{kind}, load {load:g}", scene=JointScene(kind=kind, friction=bound, load=load * bound), time=HOLDING
        )
        for kind, bound in (("hinge", 1.0), ("slide", 5.0))
        for load in (0.3, 0.9)
    )
    held_out = (
        SceneCase(name="hinge, load 0.7", scene=JointScene(friction=0.2, load=0.14), time=HOLDING),
        SceneCase(name="slide, load 0.7", scene=JointScene(kind="slide", friction=40.0, load=28.0), time=HOLDING),
    )

    def numbers(self, case: SceneCase, task: SceneTask, series: NamedNumbers) -> Mapping[Metric, Measured]:
        """Read the creep of the joint."""
        assert isinstance(task.scene, JointScene), "a joint is loaded"
        metric = TURNING if task.scene.kind == "hinge" else CREEP
        return {metric: creep(task, np.array(series["joint 1"]))}


def arm(links: int, load: float = 0.9) -> ArmScene:
    """Give an arm whose hinges are loaded by gravity with a part of their bounds."""
    beyond = (sum(link - hinge + 0.5 for link in range(hinge, links)) for hinge in range(links))
    return ArmScene(friction=tuple(GRAVITY * LINK_MASS * LINK_LENGTH * lever / load for lever in beyond))


class ArmHold(SceneScenario):
    """An arm whose hinges have enough friction stays stretched out under gravity."""

    name = "arm-hold"
    metrics = (TURNING, TURNED)
    cases = tuple(SceneCase(name=f"{links} hinges, load 0.9", scene=arm(links), time=HOLDING) for links in (1, 2, 3, 6))
    held_out = (SceneCase(name="4 hinges, load 0.7", scene=arm(4, 0.7), time=HOLDING),)

    def numbers(self, case: SceneCase, task: SceneTask, series: NamedNumbers) -> Mapping[Metric, Measured]:
        """Read the creep of the hinge that turns most, and how far any has turned: it may rest after a fall."""
        turned = max((np.array(way) for name, way in series.items() if "joint" in name), key=lambda way: abs(way[-1]))
        return {TURNING: creep(task, turned), TURNED: sag(max(series["from the start"], key=abs))}
