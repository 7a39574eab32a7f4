"""Scenes as users of ODE write them, as data from which `scene_server` builds them in another Python."""

from pathlib import Path
from typing import Any

import numpy as np

from multibody_xval.engines.interface.scene import (
    GRAVITY,
    LINK_INERTIA,
    LINK_LENGTH,
    LINK_MASS,
    ArmScene,
    ContactScene,
    JointScene,
    SceneSetting,
)
from multibody_xval.engines.isolated.out_of_process import ServedScene
from multibody_xval.engines.shared.solids import solids

STEP = 0.01
"""Chosen [s]: ODE has no default."""

SERVER = Path(__file__).with_name("scene_server.py")


def contacts(scene: ContactScene, setting: SceneSetting) -> ServedScene:
    """Build a scene with contacts: the followed box comes last."""
    return _served(solids(scene), setting, "mode", "soft_cfm")


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> ServedScene:
    """Build a scene with joints."""
    moving = {"damping": scene.damping, "velocity": scene.velocity}
    if isinstance(scene, JointScene):
        axis = (0.0, 0.0, 1.0) if scene.kind == "hinge" else (1.0, 0.0, 0.0)
        body = {"mass": 1.0, "inertia": (1.0, 1.0, 1.0), "place": np.zeros((1, 3)), "anchor": np.zeros((1, 3))}
        acting = {"kind": scene.kind, "axis": axis, "friction": (scene.friction,), "load": scene.load, "gravity": 0.0}
        return _served({**body, **acting, **moving}, setting, "fmax")
    link = np.array([LINK_LENGTH, 0.0, 0.0])
    anchors = np.outer(np.arange(scene.links), link)
    links = {"mass": LINK_MASS, "inertia": LINK_INERTIA, "anchor": anchors, "place": anchors + link / 2}
    acting = {"kind": "hinge", "axis": (0.0, 1.0, 0.0), "friction": scene.friction, "load": 0.0, "gravity": GRAVITY}
    return _served({**links, **acting, **moving}, setting, "fmax")


def _served(given: dict[str, Any], setting: SceneSetting, *options: str) -> ServedScene:
    changed = {name: setting.changed(name) for name in ("cfm", "erp", *options)}
    of_preset = {name: value for name, value in changed.items() if value is not None}
    stepping = {"time_step": setting.time_step, "sleeping": setting.sleeping}
    return ServedScene("ode", SERVER, {**given, **of_preset, **stepping})
