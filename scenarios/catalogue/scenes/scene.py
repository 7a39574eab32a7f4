"""What scenes share: how long they are watched, what counts as none, and what roundings leave.

There is no chain, and nothing is chosen for one: a preset may only have options that can be copied into any model.
"""

from typing import Any

from multibody_xval.engines.interface.scene import ContactScene, Scene
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.scenario import ROUNDINGS, round_off
from multibody_xval.scenarios.model import AnyCase, Run

SETTLING = 1.0
"""How long bodies are left alone before they are measured [s]."""

HOLDING = 2.0
"""How long what should hold is watched [s]."""

NONE = {
    "drift": 0.1,  # µm/s, µrad/s: a tenth of the slowest that has to be found, 1 mm in three hours
    "sag": 1.0,  # mm, mrad: bodies that are put in touch settle by less
    "friction": 0.1,  # %, and with it of distances and times: a tenth of what has to be found
    "stop": 0.1,  # mrad, mm: a tenth of the angle that counts as a sag
    "lift": 0.1,  # mm: a thousandth of half the side of a box
    "wander": 0.1,  # mm: likewise
    "turn": 0.1,  # °: 2 mm on a way of 1 m
}
"""The largest number of a scene that counts as none."""

SOURCE = "Coulomb's law for rigid bodies: closed forms."


def watched(scene: Scene, time: float = HOLDING, **more: Any) -> SceneMotion:
    """Give a scene that settles, and is watched [s]."""
    return SceneMotion(scene=scene, time=time, settling=SETTLING, **more)


def box_scene(case: AnyCase) -> ContactScene:
    """Give the scene of a case, which is of boxes."""
    assert isinstance(case, SceneMotion), "a scene"
    assert isinstance(case.scene, ContactScene), "a scene of boxes"
    return case.scene


def time_step(run: Run) -> float:
    """Give the time step of a scene [s]."""
    return run.of(SceneMotion).time / run.steps


def no_drift(run: Run, size: float = 1.0, time: float = HOLDING) -> float:
    """Give the drift that counts as none [µm/s], where positions are as large as this `size` [m] or angles [rad]."""
    return NONE["drift"] + 1e6 * ROUNDINGS * round_off(run) * size / time
