"""Scenes as users of Siconos write them, served by `worker` in a Python that has it: bodies, and Bullet's contacts."""

from types import SimpleNamespace
from typing import Any

import numpy as np
from siconos import kernel
from siconos.mechanics import collision
from siconos.mechanics.collision import bullet

END = 1e9
"""After which Siconos would take no step [s]."""

MARGIN = 0.02
"""Of a box, over its shortest side, as Siconos's `mechanics_run` sets it; its own one is larger than small boxes."""

UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def scene(given: dict[str, Any]) -> Any:
    """Build a scene from what `engines.siconos.scene` sends of it, and the options of its preset."""
    grip, belt = float(given["grip"]), float(given["belt"])
    system = kernel.NonSmoothDynamicalSystem(0.0, END)
    contacts = bullet.SiconosBulletCollisionManager(bullet.SiconosBulletOptions())
    contacts.insertNonSmoothLaw(kernel.NewtonImpactFrictionNSL(0.0, 0.0, float(given["friction"]), 3), 0, 0)
    if grip:
        contacts.insertStaticContactorSet(box(given["size"].tolist()[0]), [*given["wall"].tolist(), 1.0, 0.0, 0.0, 0.0])
    elif not belt:
        contacts.insertStaticContactorSet(shape(collision.SiconosPlane()), plane_pose(given["normal"]))
    bodies, weight = [], np.zeros(3)
    sizes, masses = given["size"].tolist(), given["mass"].tolist()
    places, turns = given["place"].tolist(), given["orientation"].tolist()
    velocities = given["velocity"].tolist()
    for size, mass, place, turned, velocity in zip(sizes, masses, places, turns, velocities):
        squares = np.array(size) ** 2
        inertia = np.diag(mass / 12 * (np.sum(squares) - squares))
        weight = np.array([0.0, 0.0, -mass * float(given["gravity"])])
        bodies.append(collision.RigidBodyDS([*place, *turned], [*velocity, 0.0, 0.0, 0.0], mass, inertia))
        bodies[-1].setContactors(box(size))
        bodies[-1].setFExtPtr(weight)
        system.insertDynamicalSystem(bodies[-1])
    if belt:
        bodies[0].setBoundaryConditions(kernel.BoundaryCondition([0, 1, 2, 3, 4, 5], [belt, 0.0, 0.0, 0.0, 0.0, 0.0]))
    if grip:
        bodies[0].setFExtPtr(np.array([-grip, 0.0, 0.0]))
        bodies[0].setBoundaryConditions(kernel.BoundaryCondition([1, 2, 3, 4, 5], [0.0, 0.0, 0.0, 0.0, 0.0]))
    integrator = kernel.MoreauJeanOSI(float(given["theta"]))
    clock = kernel.TimeDiscretisation(0.0, float(given["time_step"]))
    stepping = kernel.TimeStepping(system, clock, integrator, kernel.FrictionContact(3))
    stepping.insertInteractionManager(contacts)

    def step() -> None:
        stepping.computeOneStep()
        stepping.nextStep()

    def state() -> Any:
        return bodies[-1].q()[:3], bodies[-1].q()[3:], bodies[-1].velocity()[:3]

    def launch(velocity: Any, spin: float) -> None:
        bodies[-1].velocity()[:] = *velocity, 0.0, 0.0, spin
        bodies[-1].swapInMemory()  # a step begins from there

    def push(force: float) -> None:
        bodies[-1].setFExtPtr(weight + force * np.array(given["forward"].tolist()))

    return SimpleNamespace(step=step, state=state, launch=launch, push=push)


def box(size: Any) -> Any:
    """Give a box as a set of one contactor."""
    solid = collision.SiconosBox(*size)
    solid.setInsideMargin(MARGIN * min(size))
    return shape(solid)


def shape(form: Any) -> Any:
    """Give a set of one contactor."""
    contactors = collision.SiconosContactorSet()
    contactors.push_back(collision.SiconosContactor(form))
    return contactors


def plane_pose(normal: Any) -> Any:
    """Give place and orientation of a plane through the origin: its own normal is z."""
    x, y, z = normal.tolist()
    half = UPRIGHT * (1 + z) + np.array([0.0, -y, x, 0.0])
    return [0.0, 0.0, 0.0, *(half / np.linalg.norm(half)).tolist()]
