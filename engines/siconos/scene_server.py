"""Scenes as users of Siconos write them, served by `worker` in a Python that has it: bodies, and Bullet's contacts."""

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


class EngineLane:
    """One scene; `parameters` are what `engines.siconos.scene` sends of it, and the options of its preset."""

    def __init__(self, parameters: dict[str, Any]):
        self._given = parameters
        self._system = kernel.NonSmoothDynamicalSystem(0.0, END)
        self._contacts = bullet.SiconosBulletCollisionManager(bullet.SiconosBulletOptions())
        law = kernel.NewtonImpactFrictionNSL(0.0, 0.0, float(parameters["friction"]), 3)
        self._contacts.insertNonSmoothLaw(law, 0, 0)
        if "normal" in parameters:
            self._contacts.insertStaticContactorSet(shape(collision.SiconosPlane()), plane_pose(parameters["normal"]))
        columns = (parameters[name].tolist() for name in ("kind", "half", "mass", "place", "orientation"))
        for solid in zip(*columns):
            self._add(*solid)
        self._make_stepping()

    def _add(self, kind: str, half: Any, mass: float, place: Any, turned: Any) -> None:
        """Add a box; the last one is followed."""
        lengths = 2 * np.array(half)
        solid = collision.SiconosBox(*lengths.tolist())
        solid.setInsideMargin(MARGIN * min(lengths))
        box = shape(solid)
        if kind == "fixed":
            self._contacts.insertStaticContactorSet(box, [*place, *turned])
            return
        squares = lengths**2
        motion = np.zeros(6)
        inertia = np.diag(mass / 12 * (np.sum(squares) - squares))
        force = np.array([0.0, 0.0, -mass * float(self._given["gravity"])])
        if kind == "driven":
            motion[0] = float(self._given["belt"])
        elif kind == "pressed":
            force[:] = -float(self._given["grip"]), 0.0, 0.0
        self._body = collision.RigidBodyDS([*place, *turned], motion, mass, inertia)
        self._body.setContactors(box)
        self._body.setFExtPtr(force)
        self._own_force = force
        if kind != "free":
            held = range(6) if kind == "driven" else range(1, 6)
            self._body.setBoundaryConditions(kernel.BoundaryCondition(list(held), motion[held.start :]))
        self._system.insertDynamicalSystem(self._body)

    def _make_stepping(self) -> None:
        integrator = kernel.MoreauJeanOSI(float(self._given["theta"]))
        clock = kernel.TimeDiscretisation(0.0, float(self._given["time_step"]))
        self._stepping = kernel.TimeStepping(self._system, clock, integrator, kernel.FrictionContact(3))
        self._stepping.insertInteractionManager(self._contacts)

    def follow(self, steps: int, launch: Any, push: Any) -> Any:
        """Give the followed box a velocity, unless it is empty, and take steps under a force; gives a row a step."""
        self._body.setFExtPtr(self._own_force + push)
        if len(launch):
            *linear, spin = launch.tolist()
            self._body.velocity()[:] = *linear, 0.0, 0.0, spin
            self._body.swapInMemory()  # a step begins from there
        rows = np.empty((steps, 10))
        for row in rows:
            self._stepping.computeOneStep()
            self._stepping.nextStep()
            row[:7], row[7:] = self._body.q(), self._body.velocity()[:3]
        return rows


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
