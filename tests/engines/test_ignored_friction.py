"""A friction that an engine reads and does not use: a block on a slide, in each engine's own interface, glides freely.

Rows of ``docs/how_to/fix_creep.md``. A test that fails tells that a version of an engine has begun to use it.
"""

import logging
import warnings
from functools import partial
from tempfile import NamedTemporaryFile

import numpy as np
import pytest

FRICTION, MASS, TIME_STEP, STEPS = 3.0, 2.0, 1e-3, 10
"""[N], [kg], [s]; few steps, for some of these engines take milliseconds for each."""

LOADS = (0.5 * FRICTION, 1.1 * FRICTION)
"""Below and above the friction."""

SINGLE = 1e-6
"""Of a velocity: single precision rounds each of ten steps by 6e-8."""

SAPIEN_PART = 2e-3
"""Of a velocity: what a step leaves of it enters the friction of the next one."""

MASS_AND_INERTIA = f"""<inertial><mass value="{MASS}"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"""

URDF = f"""<robot name="slide"><link name="ground"/><link name="block">{MASS_AND_INERTIA}</link>
    <joint name="slide" type="prismatic"><parent link="ground"/><child link="block"/><axis xyz="1 0 0"/>
    <limit lower="-1e6" upper="1e6" effort="1e9" velocity="1e9"/>
    <dynamics damping="0" friction="{FRICTION}"/></joint></robot>"""

SDF = f"""<sdf version="1.9"><model name="slide"><link name="block"><inertial><mass>{MASS}</mass>
    <inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link>
    <joint name="slide" type="prismatic"><parent>world</parent><child>block</child><axis><xyz>1 0 0</xyz>
    <limit><lower>-1e6</lower><upper>1e6</upper></limit>
    <dynamics><damping>0</damping><friction>{FRICTION}</friction></dynamics></axis></joint></model></sdf>"""

MJCF = f"""<mujoco model="slide"><worldbody><body name="block"><inertial pos="0 0 0" mass="{MASS}" diaginertia="1 1 1"/>
    <joint name="slide" type="slide" axis="1 0 0" frictionloss="{FRICTION}"/></body></worldbody></mujoco>"""


def drake_velocity(kind: str, load: float) -> float:
    """Velocity [m/s] at the end of the steps of a file that Drake parses."""
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    builder = DiagramBuilder()
    plant = builder.AddSystem(MultibodyPlant(TIME_STEP))
    plant.mutable_gravity_field().set_gravity_vector([0, 0, 0])
    Parser(plant).AddModelsFromString({"urdf": URDF, "xml": MJCF, "sdf": SDF}[kind], kind)
    if kind == "urdf":
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("ground"))
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.get_applied_generalized_force_input_port().FixValue(context, [load])
    simulator.AdvanceTo(STEPS * TIME_STEP)
    return float(plant.GetVelocities(context)[0])


def newton_velocity(solver: str, load: float) -> float:
    """Velocity [m/s] at the end of the steps of one of Newton's solvers."""
    import newton
    import warp as wp

    wp.config.quiet = True
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    block = builder.add_link(mass=MASS, inertia=wp.mat33(np.eye(3, dtype=np.float32)))
    slide = builder.add_joint_prismatic(
        -1, block, axis=newton.Axis.X, limit_lower=-1e9, limit_upper=1e9, armature=0.0, friction=FRICTION
    )
    builder.add_articulation([slide])
    if solver == "SolverVBD":
        builder.color()
    model = builder.finalize(device="cpu")
    assert model.joint_friction.numpy() == FRICTION
    step = getattr(newton.solvers, solver)(model).step
    before, after, control = model.state(), model.state(), model.control()
    newton.eval_fk(model, before.joint_q, before.joint_qd, before)
    for _ in range(STEPS):
        before.clear_forces()
        control.joint_f.assign(np.array([load], np.float32))
        step(before, after, control, None, TIME_STEP)
        if solver != "SolverFeatherstone":
            # Of solvers that move bodies and not joints.
            newton.eval_ik(model, after, after.joint_q, after.joint_qd)
        before, after = after, before
    return float(before.joint_qd.numpy()[0])


def pybullet_velocity(load: float, motor_force: float = 0.0) -> float:
    """Velocity [m/s] at the end of the steps of a URDF file in PyBullet, under a motor of so much force."""
    import pybullet

    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setTimeStep(TIME_STEP, physicsClientId=client)
        with NamedTemporaryFile("w", suffix=".urdf") as file:
            file.write(URDF)
            file.flush()
            robot = pybullet.loadURDF(file.name, useFixedBase=True, physicsClientId=client)
        assert pybullet.getJointInfo(robot, 0, physicsClientId=client)[7] == FRICTION
        pybullet.changeDynamics(robot, 0, linearDamping=0, angularDamping=0, jointDamping=0, physicsClientId=client)
        velocity = pybullet.VELOCITY_CONTROL
        pybullet.setJointMotorControl2(robot, 0, velocity, targetVelocity=0, force=motor_force, physicsClientId=client)
        for _ in range(STEPS):
            pybullet.setJointMotorControl2(robot, 0, pybullet.TORQUE_CONTROL, force=load, physicsClientId=client)
            pybullet.stepSimulation(physicsClientId=client)
        return float(pybullet.getJointState(robot, 0, physicsClientId=client)[1])
    finally:
        pybullet.disconnect(client)


def sapien_velocity(coefficient: float, load: float) -> float:
    """Velocity [m/s] at the end of the steps in SAPIEN, with its solver as installed."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of drawing, which is not needed
        import sapien
        from sapien import physx

    physx.set_scene_config()  # of the process: as installed, whatever has run before
    physx.set_body_config()
    system = physx.PhysxCpuSystem()
    system.timestep = TIME_STEP
    builder = sapien.Scene([system]).create_articulation_builder()
    ground = builder.create_link_builder()
    block = builder.create_link_builder(ground)
    for link in (ground, block):
        link.set_mass_and_inertia(MASS, sapien.Pose(), np.ones(3))
    block.set_joint_properties("prismatic", [[-np.inf, np.inf]], sapien.Pose(), sapien.Pose(), 0.0, 0.0)
    articulation = builder.build(fix_root_link=True)
    for link in articulation.get_links():
        link.set_linear_damping(0.0)
        link.disable_gravity = True
    joint = articulation.get_active_joints()[0]
    joint.set_friction(coefficient)
    joint.set_armature(np.zeros(1))
    for _ in range(STEPS):
        articulation.set_qf(np.array([load], dtype=np.float32))
        system.step()
    return float(articulation.get_qvel()[0])


def free(load: float) -> float:
    """Velocity [m/s] at the end of the steps without friction."""
    return load * STEPS * TIME_STEP / MASS


READ = {
    "drake urdf": (partial(drake_velocity, "urdf"), "does not currently support non-zero joint friction"),
    "drake xml": (
        partial(drake_velocity, "xml"),
        "'frictionloss' found in a 'joint' tag is currently unsupported and will be ignored",
    ),
    "drake sdf": (partial(drake_velocity, "sdf"), ""),
    "pybullet urdf": (pybullet_velocity, ""),
    **{f"newton {own}": (partial(newton_velocity, own), "")
       for own in ("SolverXPBD", "SolverFeatherstone", "SolverSemiImplicit", "SolverVBD")},
}  # fmt: skip
"""Where a friction is written: the velocity of the block, and what the engine says of it, nothing mostly."""


@pytest.mark.parametrize(
    "where",
    [pytest.param(own, marks=[pytest.mark.needs(own.split()[0]), *[pytest.mark.slow] * own.startswith("newton")])
     for own in READ],
)  # fmt: skip
def test_a_friction_that_an_engine_has_read_is_not_used(where: str, caplog, capfd) -> None:
    velocity, message = READ[where]
    with caplog.at_level(logging.WARNING):
        assert list(map(velocity, LOADS)) == pytest.approx(list(map(free, LOADS)), rel=SINGLE)
    said = caplog.text + "".join(capfd.readouterr())
    assert message in said if message else "friction" not in said


@pytest.mark.needs("pybullet")
def test_a_motor_of_that_force_holds_the_block_below_it_and_slows_it_above() -> None:
    held, slowed = (pybullet_velocity(load, FRICTION) for load in LOADS)
    assert held == 0
    assert slowed == pytest.approx(free(LOADS[1] - FRICTION))


@pytest.mark.needs("sapien")
def test_friction_of_sapien_takes_the_same_part_of_every_load() -> None:
    """And so has no bound: 1 + n_v / n_p of the coefficient."""
    for coefficient in (0.05, 0.5):
        for load in (LOADS[0], 100 * FRICTION):
            left = sapien_velocity(coefficient, load) / free(load)
            assert left == pytest.approx(1 - 1.1 * coefficient, rel=SAPIEN_PART)
