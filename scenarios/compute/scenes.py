"""How a scene is run: let it settle, launch its box, follow it."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from multibody_xval.engines.interface.engine import EngineNotInstalled
from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.scene import (
    ContactScene,
    JointScene,
    Scene,
    SceneSetting,
    SceneWorld,
    Vector,
    formulation_of,
)
from multibody_xval.engines.interface.variant import variants_of
from multibody_xval.scenarios.cases.scene_motion import SceneMotion, swinging
from multibody_xval.scenarios.compute.driven import driven
from multibody_xval.scenarios.model import Config, Result, Run, Status, failed
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

ROWS = 100
"""Rows that are kept of a motion, at most."""

STOPPED = 1e-3
"""Velocity below which a joint that was thrown rests [rad/s], [m/s]."""

FEW, COMMON = 3, 1e-3
"""Steps that an engine is prepared with, and how long each is [s]."""

EXPLODED = 1e4
"""A position [m] or an angle [rad] beyond is an explosion: nothing falls or turns as far within the scenes' times."""


def scenes(runs: Sequence[Run]) -> list[Result]:
    """Run scenes one by one."""
    return [followed(run.of(SceneMotion), run.steps, built(run)) for run in runs]


def unsupported_reason(config: Config, scene: Scene) -> str | None:
    """Give the reason why a configuration has no such scene, as far as that is known without building it."""
    needed = formulation_of(scene)
    if Formulation(config.formulation) is not needed:
        return f"formulation = {config.formulation}; allowed in this scene: {needed}"
    if not config.runs_scenes:
        own = [each for each in variants_of(config.engine, optional=True, scenes_only=True) if each.runs_scenes]
        allowed = sorted(each.preset_name for each in own if each.formulation == config.formulation)
        return f"preset = {config.preset_name} is for the chain; allowed in scenes: {', '.join(allowed)}"
    if isinstance(scene, ContactScene) and scene.shaker and not engine(config.engine).scene_shakers:
        return f"shaker = {scene.shaker.mass:g} kg in a box; allowed in {config.engine}: none"
    return engine(config.engine).scene_gap(needed)


def built(run: Run) -> SceneWorld:
    """Build the scene of a run.

    Raises
    ------
    ParameterError
        If the engine cannot represent it.
    EngineNotInstalled
        If the engine cannot be used here, or not with the preset.
    """
    case, config = run.of(SceneMotion), run.config
    if reason := unsupported_reason(config, case.scene):
        raise ParameterError(reason)
    if missing := config.unavailable_reason:
        raise EngineNotInstalled(f"{config.engine}: {missing}")
    setting = SceneSetting(config.preset, case.time / run.steps, case.sleeping)
    return engine(config.engine).scene_world(case.scene, setting)


def prepare_scenes(config: Config) -> None:
    """Take a few steps of the simplest scene of a configuration's formulation, which compiles what all of them need."""
    scene = ContactScene() if config.formulation == Formulation.CONTACT else JointScene()
    case = SceneMotion(scene=scene, time=FEW * COMMON)
    followed(case, FEW, built(Run(config, case, FEW)))


def followed(case: SceneMotion, steps: int, world: SceneWorld) -> Result:
    """Let a world settle, launch its box, follow it, and close it."""
    step = case.time / steps
    held: dict[str, tuple[float, ...]] = {}
    try:
        settling = round(case.settling / step)
        first = _rows(case, step, world, 0, settling)[-1:] if settling else None
        if any(case.launch) or case.spin:
            world.launch(in_world(case.scene, case.launch), case.spin)
        if case.drive:
            rows, held["held"] = driven(case.scene, case.drive, step, world, steps)
        else:
            rows = _rows(case, step, world, settling, steps, case.push)
    finally:
        world.close()
    every = rows if first is None else np.concatenate([first, rows])
    if not (np.isfinite(every).all() and np.max(np.abs(every)) < EXPLODED):
        return failed("the scene exploded")
    return Result(status=Status.FINISHED, series={**dict(_series(case, step, first, rows)), **held})


def _rows(case: SceneMotion, step: float, world: SceneWorld, begin: int, steps: int, push: float = 0.0) -> FloatArray:
    """Take steps from the one with this number on, under the force at the start of each: a constant one, and tones."""
    if not (case.shake or push):
        return world.run(steps)
    rows = []
    for number in range(begin, begin + steps):
        world.push(push + swinging(case.shake, number * step))
        rows.append(world.run(1))
    return np.concatenate(rows)


def _series(
    case: SceneMotion, step: float, first: FloatArray | None, rows: FloatArray
) -> Iterator[tuple[str, tuple[float, ...]]]:
    """Give the series that are kept: at most `ROWS` rows, the last one among them.

    Of boxes, ``along``, ``across`` and ``off`` the plane [m] from where the motion began, the ``speed`` along each
    [m/s], the ``turn`` about its normal [rad], and ``highest``, off the plane so far. Of joints, ``joint 1`` and so
    on, from where the motion began; of one that is thrown, ``stop``, see `_stop`. ``from the start`` is the whole way
    since the scene was built, at the end: along, across and off the plane, or of every joint. Of a box that is driven,
    ``held`` is what `driven` gives.
    """
    kept = kept_rows(len(rows))
    yield "time", _numbers((step * np.arange(1, len(rows) + 1, dtype=np.float64))[kept])
    if not isinstance(case.scene, ContactScene):
        start = np.zeros(rows.shape[1]) if first is None else first[0]
        if isinstance(case.scene, JointScene) and case.scene.velocity:
            yield "stop", _stop(rows[:, 0], step)
            rows = np.unwrap(rows, axis=0) if case.scene.kind == "hinge" else rows
        for joint, values in enumerate((rows - start).T, 1):
            yield f"joint {joint}", _numbers(values[kept])
        yield "from the start", _numbers(rows[-1])
        return
    axes = plane_axes(case.scene)
    start = np.concatenate([case.scene.places[-1], case.scene.orientation]) if first is None else first[0]
    way, speed = (rows[:, :3] - start[:3]) @ axes.T, rows[:, 7:10] @ axes.T
    for index, name in enumerate(("along", "across", "off")):
        yield name, _numbers(way[kept, index])
        yield f"speed {name}", _numbers(speed[kept, index])
    yield "from the start", _numbers((rows[-1, :3] - case.scene.places[-1]) @ axes.T)
    yield "highest", _numbers(np.maximum.accumulate(way[:, 2])[kept])
    yield "turn", _numbers(_turns(rows[kept, 3:7], start[3:7], axes[2]))


def _stop(coordinates: FloatArray, step: float) -> tuple[float, ...]:
    """Give the end of the step from which on a joint rests [s]; nothing where it never does."""
    moving = np.flatnonzero(np.abs(np.diff(coordinates, prepend=0)) >= STOPPED * step)
    steps = int(moving[-1]) + 2 if moving.size else 1
    return (steps * step,) if steps <= len(coordinates) else ()


def _numbers(values: FloatArray) -> tuple[float, ...]:
    return tuple(values.tolist())


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
