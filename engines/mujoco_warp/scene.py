"""Scenes as users of MuJoCo Warp write them: MuJoCo's models, one world, its step recorded as a graph."""

from collections.abc import Callable
from typing import Any

from multibody_xval.engines.interface.scene import (
    ArmScene,
    ContactScene,
    JointScene,
    SceneSetting,
    SteppedWorld,
    Vector,
    along,
)
from multibody_xval.engines.mujoco.scene import contact_world, joint_world
from multibody_xval.engines.mujoco_warp.worlds import import_mujoco_warp
from multibody_xval.engines.shared.warp_worlds import PROCESSOR, import_warp, recorded_after

MOST_CONTACTS, MOST_ROWS = 64, 300
"""Memory of a world: three boxes that lie flat have 12 contacts, with four rows each."""


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    model, start = contact_world(scene, setting)
    place, speed = model.joint("box").qposadr[0], model.joint("box").dofadr[0]
    data, step = _world(model, start)

    def state() -> Any:
        coordinates = data.qpos.numpy()[0]
        turned = coordinates[place + 3 : place + 7]
        return coordinates[place : place + 3], turned, data.qvel.numpy()[0, speed : speed + 3]

    def launch(velocity: Vector, spin: float) -> None:
        speeds = data.qvel.numpy()
        speeds[0, speed : speed + 6] = *velocity, 0.0, 0.0, spin
        data.qvel.assign(speeds)

    def push(force: float) -> None:
        forces = (data.qfrc_applied if scene.shaker else data.xfrc_applied).numpy()
        if scene.shaker:  # its joint is the last one
            forces[0, -1] = force
            data.qfrc_applied.assign(forces)
        else:
            forces[0, -1, :3] = along(scene, force)
            data.xfrc_applied.assign(forces)

    return SteppedWorld(step, state, launch, push=push)


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints."""
    data, step = _world(*joint_world(scene, setting))

    def state() -> Any:
        return (data.qpos.numpy()[0],)

    return SteppedWorld(step, state)


def _world(model: Any, start: Any) -> tuple[Any, Callable[[], object]]:
    """Give the data of one world on Warp, and what takes a step: the second one is recorded, and repeated."""
    warp, engine = import_warp(), import_mujoco_warp()
    with warp.ScopedDevice(PROCESSOR):
        batched = engine.put_model(model)
        data = engine.put_data(model, start, nworld=1, nconmax=MOST_CONTACTS, njmax=MOST_ROWS)
    batched.opt.warn_overflow = 0
    return data, recorded_after(1, lambda: engine.step(batched, data))
