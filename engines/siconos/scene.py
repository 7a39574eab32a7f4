"""Scenes as users of Siconos write them, as data from which `scene_server` builds them in another Python."""

from pathlib import Path

from multibody_xval.engines.interface.scene import ContactScene, SceneSetting
from multibody_xval.engines.isolated.out_of_process import ServedScene
from multibody_xval.engines.shared.solids import solids

STEP = 0.0005
"""Of Siconos's `mechanics_run`, where none is given [s]."""

SERVER = Path(__file__).with_name("scene_server.py")


def contacts(scene: ContactScene, setting: SceneSetting) -> ServedScene:
    """Build a scene with contacts: the followed box comes last."""
    stepping = {"time_step": setting.time_step, "theta": setting.preset["theta"]}
    return ServedScene("siconos", SERVER, {**solids(scene), **stepping})
