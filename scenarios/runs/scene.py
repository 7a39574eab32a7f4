"""Tasks with a scene: what users build, let settle, launch and follow; and how one is run."""

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from multibody_xval.engines.interface.engine import EngineNotInstalled
from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.scene import (
    ArmScene,
    ContactScene,
    JointScene,
    Scene,
    SceneSetting,
    SceneWorld,
    Vector,
    formulation_of,
)
from multibody_xval.engines.interface.variant import GENERAL
from multibody_xval.scenarios.runs.failures import results_together
from multibody_xval.scenarios.runs.parameters import left_out
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.task import SOME, Task
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray, checked_count, checked_scalar

ROWS = 100
"""Rows that are kept of a motion, at most."""

EXPLODED = 1e4
"""A position [m] or an angle [rad] beyond is an explosion: nothing falls or turns as far within the scenes' times."""


@dataclass(frozen=True, kw_only=True)
class Tone:
    """A force on a box that swings as a sine, from the start."""

    force: float
    """Its amplitude, down the plane [N]."""
    frequency: float
    """[Hz]."""

    def __post_init__(self) -> None:
        checked_scalar("force", self.force)
        checked_scalar("frequency", self.frequency, "> 0")


def swinging(tones: Sequence[Tone], time: float) -> float:
    """Give the force of tones at a time [N]."""
    return sum(tone.force * math.sin(2 * math.pi * tone.frequency * time) for tone in tones)


@dataclass(frozen=True, kw_only=True)
class SceneTask(Task):
    """The motion of one scene, in an engine as its users call it."""

    scene: Scene
    time_step: float
    """[s]."""
    time: float
    """How long the motion is followed, after settling and launch [s]."""
    settling: float = 0.0
    """How long the scene is left alone before [s]."""
    launch: Vector = (0.0, 0.0, 0.0)
    """Velocity that the followed box then gets, along the plane, across and off it [m/s]."""
    spin: Annotated[float, left_out(0.0)] = 0.0
    """Angular velocity about the vertical that it then gets [rad/s]."""
    sleeping: Annotated[bool, left_out(False)] = False
    """Bodies may be put to sleep, as far as the engine does so as it comes."""
    shake: Annotated[tuple[Tone, ...], left_out(())] = ()
    """Forces on the followed box, or on its shaker, from the start to the end."""

    def __post_init__(self) -> None:
        checked_scalar("time_step", self.time_step, "> 0")
        checked_scalar("time", self.time, "> 0")
        checked_scalar("settling", self.settling, ">= 0")
        checked_count("steps", self.steps)

    @property
    def steps(self) -> int:
        """Steps of the motion that is followed."""
        return round(self.time / self.time_step)

    @property
    def series(self) -> Mapping[str, int]:
        """Name and length of what is kept of the motion; see `_series`."""
        of_box = ("along", "across", "off", "speed along", "speed across", "speed off", "highest", "turn")
        motion = of_box if isinstance(self.scene, ContactScene) else ("joint 1",)
        ways = {ContactScene: 3, JointScene: 1, ArmScene: SOME}[type(self.scene)]
        rows = len(kept_rows(self.steps))
        return {"time": rows, "from the start": ways} | dict.fromkeys(motion, rows)

    def unsupported_reason(self) -> str | None:
        """Give the reason why the variant has no such scene, as far as that is known without building it."""
        variant, needed = self.variant, formulation_of(self.scene)
        if Formulation(variant.formulation) is not needed:
            return f"formulation = {variant.formulation}; allowed in this scene: {needed}"
        if variant.unchanged.preset_name not in GENERAL:
            return f"preset = {variant.preset_name} is for the chain; allowed in scenes: {', '.join(GENERAL)}"
        if isinstance(self.scene, ContactScene) and self.scene.shaker and not engine(variant.engine).scene_shakers:
            return f"shaker = {self.scene.shaker.mass:g} kg in a box; allowed in {variant.engine}: none"
        return engine(variant.engine).scene_gap(needed)


def run_scenes(tasks: Sequence[SceneTask]) -> list[Result]:
    """Run scenes one by one; one that explodes diverges, and one that an engine fails at is blocked."""
    return results_together(tasks, lambda task: task, lambda alike: [followed(task, built(task)) for task in alike])


def built(task: SceneTask) -> SceneWorld:
    """Build the scene of a task.

    Raises
    ------
    ParameterError
        If the engine cannot represent it.
    EngineNotInstalled
        If the engine cannot be used here, or not with the preset.
    """
    variant = task.variant
    reason = task.unsupported_reason()
    if reason is not None:
        raise ParameterError(reason)
    missing = variant.unavailable_reason
    if missing is not None:
        raise EngineNotInstalled(f"{variant.engine}: {missing}")
    return engine(variant.engine).scene_world(task.scene, SceneSetting(variant.preset, task.time_step, task.sleeping))


def followed(task: SceneTask, world: SceneWorld) -> Result:
    """Let a world settle, launch its box, follow it, and close it."""
    begin = time.perf_counter()
    try:
        settling = round(task.settling / task.time_step)
        first = _rows(task, world, 0, settling)[-1:] if settling else None
        if any(task.launch) or task.spin:
            world.launch(in_world(task.scene, task.launch), task.spin)
        rows = _rows(task, world, settling, task.steps)
    finally:
        world.close()
    every = rows if first is None else np.concatenate([first, rows])
    finished = np.isfinite(every).all() and np.max(np.abs(every)) < EXPLODED
    return Result(
        status=ResultStatus.FINISHED if finished else ResultStatus.DIVERGED,
        series=dict(_series(task, first, rows)) if finished else {},
        seconds=time.perf_counter() - begin,
    )


def _rows(task: SceneTask, world: SceneWorld, begin: int, steps: int) -> FloatArray:
    """Take steps from the one with this number on, under the force at the start of each where one swings."""
    if not task.shake:
        return world.run(steps)
    rows = []
    for step in range(begin, begin + steps):
        world.push(swinging(task.shake, step * task.time_step))
        rows.append(world.run(1))
    return np.concatenate(rows)


def _series(task: SceneTask, first: FloatArray | None, rows: FloatArray) -> Iterator[tuple[str, tuple[float, ...]]]:
    """Give the series that are kept: at most `ROWS` rows, the last one among them.

    Of boxes, ``along``, ``across`` and ``off`` the plane [m] from where the motion began, the ``speed`` along each
    [m/s], the ``turn`` about its normal [rad], and ``highest``, off the plane so far. Of joints, ``joint 1`` and so
    on, from where the motion began. ``from the start`` is the whole way since the scene was built, at the end: along,
    across and off the plane, or of every joint.
    """
    kept = kept_rows(task.steps)
    yield "time", tuple((task.time_step * np.arange(1, task.steps + 1))[kept])
    if not isinstance(task.scene, ContactScene):
        start = np.zeros(rows.shape[1]) if first is None else first[0]
        for joint, values in enumerate((rows - start).T, 1):
            yield f"joint {joint}", tuple(values[kept])
        yield "from the start", tuple(rows[-1])
        return
    axes = plane_axes(task.scene)
    start = np.concatenate([task.scene.places[-1], task.scene.orientation]) if first is None else first[0]
    way, speed = (rows[:, :3] - start[:3]) @ axes.T, rows[:, 7:10] @ axes.T
    for index, name in enumerate(("along", "across", "off")):
        yield name, tuple(way[kept, index])
        yield f"speed {name}", tuple(speed[kept, index])
    yield "from the start", tuple((rows[-1, :3] - task.scene.places[-1]) @ axes.T)
    yield "highest", tuple(np.maximum.accumulate(way[:, 2])[kept])
    yield "turn", tuple(_turns(rows[kept, 3:7], start[3:7], axes[2]))


def kept_rows(steps: int) -> range:
    """Give the numbers of the rows that are kept of so many steps, from zero."""
    stride = math.ceil(steps / ROWS)
    return range((steps - 1) % stride, steps, stride)


def plane_axes(scene: ContactScene) -> FloatArray:
    """Give the unit vectors along the plane, across it and off it, as rows."""
    return np.array([scene.downhill, (0.0, 1.0, 0.0), scene.normal])


def in_world(scene: Scene, vector: Vector) -> Vector:
    """Give a vector along, across and off the plane in the axes of the world."""
    if not isinstance(scene, ContactScene):
        raise ParameterError(f"launch = {vector} of a joint; allowed: of a box")
    x, y, z = np.array(vector) @ plane_axes(scene)
    return float(x), float(y), float(z)


def _turns(orientations: FloatArray, start: FloatArray, normal: FloatArray) -> FloatArray:
    """Give by how much bodies have turned about a normal since the start [rad], in (−π, π]; shape (rows,)."""
    scalar = orientations @ start
    across = np.cross(orientations[:, 1:], start[1:])
    vector = start[0] * orientations[:, 1:] - np.outer(orientations[:, 0], start[1:]) - across
    turns: FloatArray = 2 * np.arctan2(vector @ normal, scalar)
    return np.arctan2(np.sin(turns), np.cos(turns))
