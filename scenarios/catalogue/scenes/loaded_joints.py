"""Joints that friction holds: one under a load, and the hinges of an arm under gravity."""

from dataclasses import replace
from functools import partial
from typing import Any

from multibody_xval.engines.interface.scene import GRAVITY, LINK_LENGTH, LINK_MASS, ArmScene, JointScene
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.scenario import Scenario, at_rest, scene_steps
from multibody_xval.scenarios.catalogue.scenes.scene import HOLDING, NONE, SOURCE, no_drift, watched
from multibody_xval.scenarios.model import Result, Run


def is_slide(case: SceneMotion) -> bool:
    """Whether a case is a joint that slides."""
    return isinstance(case.scene, JointScene) and case.scene.kind == "slide"


def drift(result: Result, run: Run) -> float:
    """Read the mean velocity of the joint that moves most [µm/s], [µrad/s]."""
    ways = [way[-1] for name, way in result.series.items() if name.startswith("joint")]
    return 1e6 * max(map(abs, ways)) / run.of(SceneMotion).time


def without_friction(case: SceneMotion, _exact: float) -> float:
    """Give the mean velocity that its load would give a joint of 1 kg m² or 1 kg [µrad/s], [µm/s]."""
    assert isinstance(case.scene, JointScene), "a joint"
    return 1e6 * case.scene.load * (case.settling + case.time / 2)


joint_drift = partial(at_rest, read=drift, resolution=no_drift)

TURNING = joint_drift(
    name="turning", unit="µrad/s", of=lambda case: not is_slide(case),
    meaning=f"Mean angular velocity over {HOLDING:g} s of a hinge that friction should hold.",
)  # fmt: skip

CREEP: dict[str, Any] = {"accuracy": "creep", "effect": without_friction}
"""Of one joint: what is stated of its drift is a part of this."""

JOINT_HOLD = Scenario(
    name="joint-hold",
    question="Does a joint with dry friction stay where it is under a load?",
    expects="no motion",
    source=SOURCE,
    cases={
        f"{kind}, load {load:g}": watched(JointScene(kind=kind, friction=bound, load=load * bound))
        for kind, bound in (("hinge", 1.0), ("slide", 5.0))
        for load in (0.3, 0.9)
    },
    held_out={
        "hinge, load 0.7": watched(JointScene(friction=0.2, load=0.14)),
        "slide, load 0.7": watched(JointScene(kind="slide", friction=40.0, load=28.0)),
    },
    quantities=(
        replace(TURNING, **CREEP),
        joint_drift(
            name="drift", unit="µm/s", of=is_slide, **CREEP,
            meaning=f"Mean velocity over {HOLDING:g} s of a joint that friction should hold.",
        ),
    ),
    steps=scene_steps,
)  # fmt: skip


def arm(links: int, load: float = 0.9) -> ArmScene:
    """Give an arm whose hinges are loaded by gravity with a part of their bounds."""
    beyond = (sum(link - hinge + 0.5 for link in range(hinge, links)) for hinge in range(links))
    return ArmScene(friction=tuple(GRAVITY * LINK_MASS * LINK_LENGTH * lever / load for lever in beyond))


ARM_HOLD = replace(
    JOINT_HOLD,
    name="arm-hold",
    question="Does an arm whose hinges have dry friction stay stretched out under gravity?",
    cases={f"{links} hinges, load 0.9": watched(arm(links)) for links in (1, 2, 3, 6)},
    held_out={"4 hinges, load 0.7": watched(arm(4, 0.7))},
    quantities=(
        TURNING,
        at_rest(
            name="turned", unit="mrad", resolution=NONE["sag"],
            read=lambda result, _run: 1e3 * max(map(abs, result.series["from the start"])),
            meaning="Angle of a hinge that friction should hold since the scene was built: an arm may rest after a "
            "fall.",
        ),
    ),
)  # fmt: skip

SCENARIOS = (JOINT_HOLD, ARM_HOLD)
