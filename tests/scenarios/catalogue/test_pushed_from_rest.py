"""A box that is pushed from rest: numbers of plain scripts, and friction that is wrong by its direction."""

import math
from pathlib import Path

import numpy as np
import pytest

from multibody_xval.scenarios.catalogue.scenes.pushed_box import ANGLES, PUSHED_FROM_REST, from_rest, way_pushed
from multibody_xval.scenarios.catalogue.scenes.scene import box_scene
from multibody_xval.scenarios.catalogue.scenes.sliding_boxes import in_plane
from multibody_xval.scenarios.model import Config, Run
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES
from multibody_xval.scenarios.running.evaluate import Means, computed
from tests.scenarios.point_mass import Wrong, point_mass_numbers

STEPS, STEP = 60, 1 / 240
"""Of the push, in the plain scripts; a step [s]."""

EXACT = 31.77
"""Way under 10 m/s², in such steps of semi-implicit Euler [mm]."""

BULLET = "pybullet:contact:recommended:frictionAnchor=0"

PYRAMID = (31.84, 49.41 + 19.9j, 70.23 + 14.95j, 78.18)
"""Ways along the push, and aside as imaginary parts, in a script that imports MuJoCo alone, by angle [mm]: a box of
0.2 × 0.1 × 0.1 m with default options, pushed with 1.2 μ m g. The closed form is that of engines that push it straight.
"""


def ways(name: str) -> np.ndarray:
    """Give ways along and aside in the scenes, by angle, over the exact one in steps; shape (angles,)."""
    cases = [from_rest(1.2, angle) for angle in ANGLES]
    stored = computed([Run(Config.parse(name), case, STEPS) for case in cases], Means())
    places = np.array([in_plane(own.result)[-1] @ [1, 1j] for own in stored])
    straight = [complex(*box_scene(case).forward[:2]) * way_pushed(case) for case in cases]
    return places / straight * STEPS / (STEPS + 1)


@pytest.mark.needs("mujoco")
def test_mujoco_pushes_a_box_as_far_as_in_a_script_that_imports_it_alone() -> None:
    assert EXACT * ways("mujoco:contact:default") == pytest.approx(np.array(PYRAMID), abs=0.002 * EXACT)


BOX = """<robot name="box"><link name="box">
<contact><lateral_friction value="0.8"/></contact>
<inertial><mass value="1"/><inertia ixx="0.00167" iyy="0.00417" izz="0.00417" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.2 0.1 0.1"/></geometry></collision>
</link></robot>"""
"""The box of the plain script as a URDF."""


def plain_bullet(
    degrees: float,
    load: float,
    gravity: float,
    plane: bool,
    maximal: bool = False,
    urdf: tuple[str, bool] | None = None,
) -> complex:
    """Push a box in plain PyBullet, without its damping; gives the way along and aside [m].

    A URDF is a file, and whether the box is in maximal coordinates.
    """
    import pybullet as p

    client = p.connect(p.DIRECT)
    try:
        p.setGravity(0, 0, -gravity)
        p.setTimeStep(STEP)
        p.setPhysicsEngineParameter(solverResidualThreshold=0)
        if plane:
            ground = p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE))
        else:
            slab = p.createCollisionShape(p.GEOM_BOX, halfExtents=[50, 50, 1])
            ground = p.createMultiBody(0, slab, -1, [0, 0, -1], useMaximalCoordinates=maximal)
        shape, turn = p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.1, 0.05, 0.05]), math.radians(degrees)
        turned = [0, 0, math.sin(turn / 2), math.cos(turn / 2)]
        if urdf:
            box = p.loadURDF(urdf[0], [0, 0, 0.05], turned, useMaximalCoordinates=urdf[1])
        else:
            box = p.createMultiBody(1, shape, -1, [0, 0, 0.05], turned, useMaximalCoordinates=maximal)
        for body in (ground, box):
            p.changeDynamics(body, -1, lateralFriction=math.sqrt(0.5), linearDamping=0, angularDamping=0)
        for _ in range(120):
            p.stepSimulation()
        begin, force = p.getBasePositionAndOrientation(box)[0], 0.5 * load * gravity
        for _ in range(STEPS):
            place = p.getBasePositionAndOrientation(box)[0]
            p.applyExternalForce(box, -1, [force * math.cos(turn), force * math.sin(turn), 0], place, p.WORLD_FRAME)
            p.stepSimulation()
        way = np.subtract(p.getBasePositionAndOrientation(box)[0], begin)
        return complex(*way[:2]) / complex(math.cos(turn), math.sin(turn))
    finally:
        p.disconnect(client)


@pytest.mark.needs("pybullet")
def test_plain_pybullet_pushes_a_box_on_its_plane_too_far_and_aside_between_the_axes() -> None:
    """As the documentation says; with anchors, damping or a box as ground by other numbers."""
    found = [1e3 * plain_bullet(angle, 1.2, 10.0, plane=True) for angle in ANGLES]
    assert found == pytest.approx([32.69 + 0.19j, 33.58 + 4.87j, 37.37 + 4.53j, 40.4 + 0.63j], abs=0.01)
    assert 1e3 * plain_bullet(45, 1.06, 10.0, plane=True) == pytest.approx(17.48 + 0.53j, abs=0.01)


@pytest.mark.needs("pybullet")
def test_scene_pushes_a_box_as_far_as_plain_pybullet_on_the_same_ground() -> None:
    """And in maximal coordinates PyBullet pushes it as far in every direction, as its recipe says."""
    exact = 0.2 * 0.5 * 9.81 * STEP**2 * STEPS * (STEPS + 1) / 2
    plain, cured = (np.array([plain_bullet(own, 1.2, 9.81, False, maximal) for own in ANGLES]) / exact
                    for maximal in (False, True))  # fmt: skip
    assert ways(BULLET) == pytest.approx(plain, abs=1e-3)
    assert abs(plain[3] - 1) > 0.2
    assert cured == pytest.approx(np.ones(4), abs=1e-3)


@pytest.mark.needs("pybullet")
def test_box_of_a_urdf_needs_maximal_coordinates_as_its_ground_does(tmp_path: Path) -> None:
    """Pushed at 45° with 1.06 μ m g, in which the coefficient of the file counts no more."""
    file = tmp_path / "box.urdf"
    file.write_text(BOX, encoding="utf-8")
    exact = 0.06 * 0.5 * 9.81 * STEP**2 * STEPS * (STEPS + 1) / 2
    ways_of = [abs(plain_bullet(45, 1.06, 9.81, False, True, (str(file), own))) / exact for own in (True, False)]
    assert ways_of == pytest.approx([1.0, 1.718], abs=1e-3)


def test_friction_that_acts_aside_is_found_in_every_direction() -> None:
    """A twentieth of the bound turns the way by as much of the push, whose part across balances it then."""
    table = point_mass_numbers(PUSHED_FROM_REST, Wrong(aside=0.05))
    fine = table[table.case.str.endswith("1 ms")]
    assert set(fine.verdict) == {DEVIATES}
    assert fine.value[fine.case.str.startswith("1.2")].tolist() == pytest.approx([100 * 0.05 / 1.2] * 4, rel=0.06)
    sound = point_mass_numbers(PUSHED_FROM_REST)
    assert set(sound.verdict) == {AGREES}
