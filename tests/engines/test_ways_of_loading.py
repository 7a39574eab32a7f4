"""Own defaults of engines by the way a model is loaded, and that their recipes hold a box on a slope in each."""

import math
from pathlib import Path

import numpy as np
import pytest

from multibody_xval.engines.sapien.joint import import_sapien
from multibody_xval.reports.reproducers.recipe import recipe_text

SIZE, MASS, FRICTION, SLOPE, GRAVITY = (0.16, 0.12, 0.08), 2.3, 0.6, 0.35, 9.81
"""[m], [kg], 1, [rad], [m/s²]: friction has 0.61 of its bound to hold."""

HALF = [side / 2 for side in SIZE]

PULL = [GRAVITY * math.sin(SLOPE), 0, -GRAVITY * math.cos(SLOPE)]

URDF = f"""<robot name="box"><link name="box"><inertial><mass value="{MASS}"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="{SIZE[0]} {SIZE[1]} {SIZE[2]}"/></geometry>
    <drake:proximity_properties xmlns:drake="http://drake.mit.edu"><drake:mu_static value="{FRICTION}"/>
    <drake:mu_dynamic value="{FRICTION}"/></drake:proximity_properties></collision></link></robot>"""

MJCF = f"""<mujoco model="box"><worldbody><body name="box" pos="0 0 {HALF[2]}">
    <geom type="box" size="{HALF[0]} {HALF[1]} {HALF[2]}" mass="{MASS}"/></body></worldbody></mujoco>"""


def bullet_drift(way: str, folder: Path, *, recipe: bool) -> tuple[float, float]:
    """Give the drift over two seconds [m/s] and the mass [kg] of a box that is created or loaded."""
    import pybullet as bullet
    from pybullet_utils.bullet_client import BulletClient

    client = BulletClient(bullet.DIRECT)
    client.setGravity(*PULL)
    (folder / "box.urdf").write_text(URDF)
    (folder / "box.xml").write_text(MJCF)
    shape = client.createCollisionShape(client.GEOM_BOX, halfExtents=HALF)
    ways = {
        "createMultiBody": lambda: client.createMultiBody(MASS, shape, basePosition=[0, 0, HALF[2]]),
        "loadURDF": lambda: client.loadURDF(str(folder / "box.urdf"), [0, 0, HALF[2]]),
        "loadMJCF": lambda: client.loadMJCF(str(folder / "box.xml"))[0],
    }
    box = ways[way]()
    mass = client.getDynamicsInfo(box, -1)[0]
    ground = client.createCollisionShape(client.GEOM_BOX, halfExtents=[5, 5, 1])
    for body in (client.createMultiBody(0, ground, basePosition=[0, 0, -1]), box):
        client.changeDynamics(body, -1, lateralFriction=FRICTION**0.5)
        if recipe:
            client.changeDynamics(body, -1, linearDamping=0, angularDamping=0)
            client.changeDynamics(body, -1, frictionAnchor=1)
    if recipe:
        client.setPhysicsEngineParameter(solverResidualThreshold=0, numSolverIterations=50)
    places = []
    for steps in (240, 480):
        for _ in range(steps):
            client.stepSimulation()
        places.append(client.getBasePositionAndOrientation(box)[0])
    client.disconnect()
    return math.dist(places[0][:2], places[1][:2]) / 2, mass


@pytest.mark.needs("pybullet")
@pytest.mark.parametrize("way", ["createMultiBody", "loadURDF", "loadMJCF"])
def test_pybullet_s_recipe_holds_a_box_however_it_is_loaded(way, tmp_path) -> None:
    drift, mass = bullet_drift(way, tmp_path, recipe=False)
    assert drift > 5e-6
    assert bullet_drift(way, tmp_path, recipe=True)[0] < 0.01e-6
    assert mass == pytest.approx(MASS if way != "loadMJCF" else 1000 * np.prod(SIZE))


def drake_drift(*, recipe: bool) -> float:
    """Give the drift of a box that is parsed over a second [m/s], with what the recipe has for bodies of files."""
    from pydrake import all as drake

    builder, step = drake.DiagramBuilder(), 0.001
    plant, scene_graph = drake.AddMultibodyPlantSceneGraph(builder, step)
    plant.mutable_gravity_field().set_gravity_vector(PULL)
    ground = drake.ProximityProperties()
    drake.AddContactMaterial(friction=drake.CoulombFriction(FRICTION, FRICTION), properties=ground)
    if recipe:
        config, side = drake.SceneGraphConfig(), min(SIZE)
        lines = (
            recipe_text("drake").partition("    config = SceneGraphConfig()\n")[2].partition("No value serves all.")[0]
        )
        names = {"config": config, "side": side, "scene_graph": scene_graph}
        exec("\n".join(map(str.strip, lines.splitlines())), names)
        drake.AddRigidHydroelasticProperties(1.0, ground)
    plant.RegisterCollisionGeometry(plant.world_body(), drake.RigidTransform(), drake.HalfSpace(), "ground", ground)
    drake.Parser(plant).AddModelsFromString(URDF, "urdf")
    plant.Finalize()
    if recipe:
        plant.set_stiction_tolerance(1e-5)
    simulator, box = drake.Simulator(builder.Build()), plant.GetBodyByName("box")
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetFreeBodyPose(context, box, drake.RigidTransform([0, 0, HALF[2]]))
    places = []
    for end in (0.5, 1.5):
        simulator.AdvanceTo(end)
        places.append(plant.EvalBodyPoseInWorld(context, box).translation())
    return math.dist(places[0], places[1])


@pytest.mark.needs("drake")
def test_drake_s_recipe_holds_a_box_of_a_file_by_a_patch_of_contact() -> None:
    """A patch drifts by the stiction velocity times t / √(1 − t²) of the part t of its bound."""
    part = math.tan(SLOPE) / FRICTION
    assert drake_drift(recipe=True) == pytest.approx(1e-5 * part / math.sqrt(1 - part**2), rel=0.02)
    assert drake_drift(recipe=False) > 100e-6


@pytest.mark.needs("sapien")
def test_sapien_s_loaded_links_have_a_joint_friction_and_a_damping_that_no_file_states(tmp_path) -> None:
    sapien = import_sapien()

    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    file = tmp_path / "two.urdf"
    file.write_text(
        f'<robot name="two"><link name="a">{inertial}</link><link name="b">{inertial}'
        '<collision><geometry><box size=".1 .1 .1"/></geometry></collision></link>'
        '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>'
    )
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])  # bodies do not keep it
    robot = scene.create_urdf_loader().load(str(file))
    (joint,), link = robot.active_joints, robot.links[-1]
    assert joint.friction == pytest.approx(0.05)
    assert (link.get_linear_damping(), link.get_angular_damping()) == pytest.approx((0.05, 0.05))
    assert link.collision_shapes[0].physical_material.static_friction == pytest.approx(0.3)
