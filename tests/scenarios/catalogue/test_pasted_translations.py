"""What `translate` prints, pasted into scripts that import an engine alone, leaves the differences that docs state."""

import csv
import re
from math import atan, cos, hypot, radians, sin

import numpy as np
import pandas as pd
import pytest

from multibody_xval.scenarios.catalogue.scenes.scene import NONE
from multibody_xval.scenarios.catalogue.translation import FACTOR, Translation, _config, _sought
from multibody_xval.scenarios.model import Config
from tests.programs import DOCS

SCENES = {"held": (atan(0.45), 2.0, 0.0), "slides": (atan(0.75), 2.0, 0.0), "stops": (0.0, 2.25, 3.0)}
"""Slope, time [s] and first speed [m/s], 30° off x, of a cube of 1 kg and 0.2 m that was at rest for a second."""

TWO_DIGITS = 0.05
"""Part by which a printed number is off at most."""


def motion(scene, step, advance, row, launch):
    """Wait for a second, launch, and advance: rows of time, place and orientation (w, x, y, z)."""
    _, time, speed = SCENES[scene]
    for _ in range(round(1 / step)):
        advance()
    rows = [[0.0, *row()]]
    if speed:
        launch([speed * cos(radians(30)), speed * sin(radians(30)), 0.0])
    for number in range(1, round(time / step) + 1):
        advance()
        rows.append([number * step, *row()])
    return np.array(rows)


def mujoco_cube(scene, text, mu, normal, tilt):
    import mujoco

    quat = " ".join(map(str, tilt))
    model = mujoco.MjModel.from_xml_string(f"""<mujoco>{text}<default><geom friction="{mu}"/></default><worldbody>
        <geom type="plane" size="50 50 1" quat="{quat}"/><body pos="{" ".join(map(str, 0.1 * normal))}" quat="{quat}">
        <freejoint/><geom type="box" size=".1 .1 .1" mass="1"/></body></worldbody></mujoco>""")
    data = mujoco.MjData(model)
    launch = lambda velocity: np.copyto(data.qvel[:3], velocity)  # noqa: E731
    return motion(scene, 0.002, lambda: mujoco.mj_step(model, data), data.qpos.copy, launch)


def sapien_cube(scene, text, mu, normal, tilt):
    import sapien

    exec(text)
    world, rub = sapien.Scene([sapien.physx.PhysxCpuSystem()]), sapien.physx.PhysxMaterial(mu, mu, 0.0)
    ground, builder = world.create_actor_builder(), world.create_actor_builder()
    ground.add_box_collision(sapien.Pose(-normal, tilt), [50, 50, 1], rub)
    ground.build_static()
    builder.add_box_collision(half_size=[0.1, 0.1, 0.1], material=rub, density=1 / 0.2**3)
    builder.set_initial_pose(sapien.Pose(0.1 * normal, tilt))
    cube = builder.build().find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
    row = lambda: [*cube.entity_pose.p, *cube.entity_pose.q]  # noqa: E731
    return motion(scene, 0.01, world.step, row, cube.set_linear_velocity)


def pybullet_cube(scene, text, mu, normal, tilt):
    import pybullet as p

    p.connect(p.DIRECT)
    p.setGravity(0, 0, -9.81)
    for mass, half, place in ((0, [50, 50, 1], -normal), (1, [0.1, 0.1, 0.1], 0.1 * normal)):
        shape = p.createCollisionShape(p.GEOM_BOX, halfExtents=half)
        body = p.createMultiBody(mass, shape, -1, place, [*tilt[1:], tilt[0]])
        exec(text)

    def row():
        place, (x, y, z, w) = p.getBasePositionAndOrientation(body)
        return [*place, w, x, y, z]

    rows = motion(scene, 1 / 240, p.stepSimulation, row, lambda velocity: p.resetBaseVelocity(body, velocity))
    p.disconnect()
    return rows


def moved(scene, config, factor):
    """Paste what is printed for a configuration into the script of its engine: time, way and turn."""
    text, slope = Translation(config, factor, pd.DataFrame()).text, SCENES[scene][0]
    normal, tilt = np.array([sin(slope), 0.0, cos(slope)]), np.array([cos(slope / 2), 0.0, sin(slope / 2), 0.0])
    rows = globals()[f"{config.engine}_cube"](scene, text, 0.5 * factor, normal, tilt)
    turn = 2 * np.arctan2(rows[:, 7], rows[:, 4])
    return rows[:, 0], rows[:, 1:4] - rows[0, 1:4], turn - turn[0]


def apart(one, other):
    """The largest distance at the times of both, at the corners too [mm]."""
    times = np.linspace(0, one[0][-1], round(20 * one[0][-1]) + 1)  # ends of steps of all engines
    (way, turn), (way_other, turn_other) = (
        ([np.interp(times, own[0], own[1][:, axis]) for axis in range(3)], np.interp(times, own[0], own[2]))
        for own in (one, other)
    )
    between = np.linalg.norm(np.subtract(way, way_other), axis=0) + hypot(0.1, 0.1) * np.abs(turn - turn_other)
    return 1e3 * np.max(between)


def differences():
    """Give what docs state: both engines with options and factors of friction, the scene, and what is left [mm]."""
    with (DOCS / "results/translations.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            wanted, name = Config.parse(row["wanted"]), row["engine"]
            if not {f"{wanted.engine}_cube", f"{name}_cube"} <= globals().keys():
                continue
            first, recipe, _ = _sought(wanted.engine)
            changed = dict(own.split(" = ") for own in row["options"].split(", "))
            factor = {FACTOR: float(changed.pop(FACTOR, 1.0))}
            one = _config(wanted.engine, first if wanted.preset_name == "default" else recipe)
            other = _config(name, _sought(name)[0] | changed | factor)
            for scene in SCENES:
                left = float(re.search("→ (.*) of", row[scene])[1].replace(",", ""))
                marks = pytest.mark.needs(wanted.engine, name)
                yield pytest.param(one, other, scene, left, marks=marks, id=f"{wanted}-{name}-{scene}")


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:Failed to find system libvulkan")
@pytest.mark.parametrize(("one", "other", "scene", "left"), list(differences()))
def test_pasted_options_leave_the_differences_of_docs(one, other, scene, left) -> None:
    assert apart(moved(scene, *one), moved(scene, *other)) == pytest.approx(left, rel=TWO_DIGITS, abs=NONE["wander"])
