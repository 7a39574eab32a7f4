"""Scenes as users of Newton write them: bodies, and with SolverSteel drives of bounded effort as dry friction.

SolverXPBD, SolverVBD and SolverKamino keep the places of bodies, not those of joints, and have contacts alone.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from multibody_xval.engines.interface.scene import (
    FINGER,
    FINGER_MASS,
    GROUND,
    LEVEL,
    LINK_INERTIA,
    LINK_LENGTH,
    LINK_MASS,
    ArmScene,
    ContactScene,
    JointScene,
    Quaternion,
    SceneSetting,
    SteppedWorld,
    Vector,
    along,
)
from multibody_xval.engines.newton.worlds import NO_GRAVITY, STATE, import_newton
from multibody_xval.engines.shared.warp_worlds import PROCESSOR, import_warp, recorded_after

STEP = 1 / 240
"""Of Newton's own examples with rigid contacts [s]; a solver has no default."""

BELT_MASS = 1e5
"""Of a belt that slides, whatever acts on it [kg]."""

SOLVER = (
    "drive_mode", "friction_anchor_beta", "iterations", "dynamics_solver", "sparse_jacobian", "sparse_dynamics",
)  # fmt: skip
"""Options that solvers take by their names."""

MATERIAL = ("ke", "kd")
"""Options of surfaces, by Newton's names: stiffness [N/m] and damping [N s/m]."""

BEYOND = 1e6
"""Limit of a joint that has none [rad], [m]."""


def solver_of(setting: SceneSetting) -> str:
    """Give the name of the solver that a preset is of."""
    options = setting.preset.options
    return str(options["solver"].value) if "solver" in options else "SolverSteel"


def set_of(setting: SceneSetting, names: Sequence[str]) -> dict[str, Any]:
    """Give those of these options that a preset has."""
    return {name: setting.preset[name] for name in names if name in setting.preset.options}


def _stepped(model: Any, setting: SceneSetting) -> tuple[Any, Any, Any, Callable[[], object]]:
    """Give a state, the forces in joints and those on bodies, and what takes a step, which is recorded as a graph."""
    newton, warp = import_newton(), import_warp()
    kind, options = solver_of(setting), set_of(setting, SOLVER)
    if kind == "SolverXPBD":
        solver = newton.solvers.SolverXPBD(model, **options)
    elif kind == "SolverVBD":
        solver = newton.solvers.SolverVBD(model, **options)
    elif kind == "SolverKamino":
        solver = newton.solvers.SolverKamino(model, config=newton.solvers.SolverKamino.Config(**options))
    else:
        solver = newton.solvers.SolverSteel(model, **options)
    now, after, control = model.state(), model.state(), model.control()
    newton.eval_fk(model, model.joint_q, model.joint_qd, now)
    pushes = warp.zeros_like(now.body_f)
    pipeline = newton.CollisionPipeline(model) if model.shape_count else None
    contacts = pipeline.contacts() if pipeline else None

    def advance() -> None:
        now.clear_forces()
        warp.copy(now.body_f, pushes)
        if pipeline:
            pipeline.collide(now, contacts)
        solver.step(now, after, control, contacts, setting.time_step)
        for name in STATE:
            warp.copy(getattr(now, name), getattr(after, name))

    return now, control.joint_f, pushes, recorded_after(2, advance)


def _finalized(builder: Any, setting: SceneSetting) -> Any:
    """Give the model; SolverVBD needs its bodies in groups."""
    if solver_of(setting) == "SolverVBD":
        builder.color()
    return builder.finalize(device=PROCESSOR)


def _set_rates(model: Any, now: Any, begin: int, rates: Sequence[float]) -> None:
    """Set velocities of joints from this one on."""
    values = now.joint_qd.numpy()
    values[begin : begin + len(rates)] = rates
    now.joint_qd.assign(values)
    import_newton().eval_fk(model, now.joint_q, now.joint_qd, now)


def _set_rate(now: Any, body: int, rate: Sequence[float]) -> None:
    """Set the velocity of a body, and its angular velocity."""
    rates = now.body_qd.numpy()
    rates[body] = rate
    now.body_qd.assign(rates)


def _carrying(now: Any, body: int, speed: float, time_step: float, advance: Callable[[], object]) -> Callable[[], None]:
    """Give what moves a kinematic body along x, as its user has to, and takes a step."""
    _set_rate(now, body, [speed, 0.0, 0.0, 0.0, 0.0, 0.0])

    def step() -> None:
        places = now.body_q.numpy()
        places[body, 0] += speed * time_step
        now.body_q.assign(places)
        advance()

    return step


def _pose(place: Vector, turned: Quaternion = LEVEL) -> Any:
    warp = import_warp()
    w, x, y, z = turned
    return warp.transform(warp.vec3(*place), warp.quat(x, y, z, w))


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    newton = import_newton()
    builder = newton.ModelBuilder()
    reduced, material = solver_of(setting) == "SolverSteel", set_of(setting, MATERIAL)

    def add_box(body: int, half: Sequence[float], mass: float = 0.0, pose: Any = None) -> None:
        density = mass / float(np.prod(2 * np.array(half)))
        surface = newton.ModelBuilder.ShapeConfig(density=density, mu=scene.friction, **material)
        builder.add_shape_box(body, xform=pose, hx=half[0], hy=half[1], hz=half[2], cfg=surface)

    def add_slider(half: Sequence[float], mass: float, place: Vector) -> None:
        body = builder.add_link(xform=_pose(place))
        add_box(body, half, mass)
        limits = {"limit_lower": -BEYOND, "limit_upper": BEYOND}
        joint = builder.add_joint_prismatic(
            -1, body, axis=newton.Axis.X, parent_xform=_pose(place), armature=0.0, friction=0.0, **limits
        )
        builder.add_articulation([joint])

    for mass, half, place in scene.stack:
        body = builder.add_body(xform=_pose(place, scene.orientation))
        add_box(body, half, mass)
    if scene.grip:
        reach, height = scene.finger
        add_box(-1, FINGER, pose=_pose((-reach, 0.0, height)))
        add_slider(FINGER, FINGER_MASS, (reach, 0.0, height))
    elif scene.belt and reduced:
        add_slider((20.0, 1.0, 0.1), BELT_MASS, (0.0, 0.0, -0.1))
    elif scene.belt:
        belt = builder.add_body(xform=_pose((0.0, 0.0, -0.1)), is_kinematic=True)
        add_box(belt, (20.0, 1.0, 0.1), BELT_MASS)
    else:
        x, y, z = scene.normal
        add_box(-1, (GROUND, GROUND, 1.0), pose=_pose((-x, -y, -z), scene.tilt))
    model = _finalized(builder, setting)
    now, loads, pushes, step = _stepped(model, setting)
    if scene.grip:
        forces = loads.numpy()
        forces[-1] = -scene.grip
        loads.assign(forces)
    if scene.belt and reduced:
        _set_rates(model, now, len(now.joint_qd) - 1, [scene.belt])
    elif scene.belt:
        step = _carrying(now, belt, scene.belt, setting.time_step, step)

    def state() -> Any:
        x, y, z, i, j, k, w = now.body_q.numpy()[body]
        return (x, y, z), (w, i, j, k), now.body_qd.numpy()[body, :3]

    def launch(velocity: Vector, spin: float) -> None:
        if reduced:
            _set_rates(model, now, 6 * body, [*velocity, 0.0, 0.0, spin])
        else:
            _set_rate(now, body, [*velocity, 0.0, 0.0, spin])

    def push(force: float) -> None:
        forces = pushes.numpy()
        forces[body, :3] = along(scene, force)
        pushes.assign(forces)

    return SteppedWorld(step, state, launch, push=push)


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints."""
    newton, warp = import_newton(), import_warp()
    single = isinstance(scene, JointScene)
    builder = newton.ModelBuilder(gravity=NO_GRAVITY) if single else newton.ModelBuilder()
    bounds = [scene.friction] if isinstance(scene, JointScene) else scene.friction
    centre, diagonal = (0.0, (1.0, 1.0, 1.0)) if single else (LINK_LENGTH / 2, LINK_INERTIA)
    slides = isinstance(scene, JointScene) and scene.kind == "slide"
    add = builder.add_joint_prismatic if slides else builder.add_joint_revolute
    axis = newton.Axis.X if slides else newton.Axis.Z if single else newton.Axis.Y
    before, chain = -1, []
    for index, bound in enumerate(bounds):
        inertia = warp.mat33(*np.diag(diagonal).ravel().tolist())
        link = builder.add_link(mass=LINK_MASS, com=warp.vec3(centre, 0.0, 0.0), inertia=inertia)
        drive = {"target_ke": 0.0, "target_kd": setting.preset["target_kd"], "effort_limit": bound}
        chain.append(add(
            before, link, axis=axis, parent_xform=_pose((LINK_LENGTH if index else 0.0, 0.0, 0.0)), armature=0.0,
            damping=scene.damping, limit_lower=-BEYOND, limit_upper=BEYOND,
            actuator_mode=newton.JointTargetMode.VELOCITY, **drive,
        ))  # fmt: skip
        before = link
    builder.add_articulation(chain)
    model = builder.finalize(device=PROCESSOR)
    now, loads, _, step = _stepped(model, setting)
    if isinstance(scene, JointScene):
        _set_rates(model, now, 0, [scene.velocity])
        loads.assign(np.array([scene.load], np.float32))

    def state() -> Any:
        return (now.joint_q.numpy(),)

    return SteppedWorld(step, state)
