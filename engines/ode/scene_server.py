"""Scenes as users of ODE write them, served by `worker` in a Python that has pyode: geoms in a space, and joints."""

from typing import Any

import numpy as np
import ode


class EngineLane:
    """One scene; `parameters` are what `engines.ode.scene` sends of it, and the options that its preset changes."""

    def __init__(self, parameters: dict[str, Any]):
        self._scene: Any = (Boxes if "half" in parameters else Joints)(parameters)

    def follow(self, steps: int, launch: Any, push: Any) -> Any:
        """Give the followed box a velocity, unless it is empty, and take steps under a force; gives a row a step."""
        if len(launch):
            self._scene.launch(launch.tolist())
        rows = []
        for _ in range(steps):
            if push.any():
                self._scene.push(push.tolist())
            self._scene.step()
            rows.append(self._scene.state())
        return np.array(rows)


def new_world(given: dict[str, Any]) -> Any:
    """Make a world with gravity; softness and correction as they come unless they are changed."""
    world = ode.World()
    world.setGravity((0.0, 0.0, -float(given["gravity"])))
    world.setAutoDisableFlag(bool(given["sleeping"]))
    if "cfm" in given:
        world.setCFM(float(given["cfm"]))
    if "erp" in given:
        world.setERP(float(given["erp"]))
    return world


class Boxes:
    """Boxes that are fixed, driven, on a slider or free; every step finds their contacts and makes joints of them."""

    def __init__(self, given: dict[str, Any]):
        self._given = given
        self._world, self._space, self._contacts = new_world(given), ode.HashSpace(), ode.JointGroup()
        self._time_step = float(given["time_step"])
        self._friction, self._mode = float(given["friction"]), int(given["mode"])
        self._softness = float(given["soft_cfm"]) if "soft_cfm" in given else None
        self._geoms: list[Any] = []
        self._pressed: Any = None
        if "normal" in given:
            self._geoms.append(ode.GeomPlane(self._space, tuple(given["normal"].tolist()), 0.0))
        for kind, half, mass, place, turned in zip(
            given["kind"].tolist(),
            given["half"].tolist(),
            given["mass"].tolist(),
            given["place"].tolist(),
            given["orientation"].tolist(),
        ):
            self._add(kind, tuple(2 * side for side in half), mass, place, turned)

    def _add(self, kind: str, lengths: Any, mass: float, place: Any, turned: Any) -> None:
        """Add a box; the last one is followed."""
        geom = ode.GeomBox(self._space, lengths)
        self._geoms.append(geom)
        if kind == "fixed":
            geom.setPosition(place)
            return
        body, inertia = ode.Body(self._world), ode.Mass()
        inertia.setBoxTotal(mass, *lengths)
        body.setMass(inertia)
        body.setPosition(place)
        body.setQuaternion(turned)
        geom.setBody(body)
        if kind == "driven":
            body.setKinematic()
            body.setLinearVel((float(self._given["belt"]), 0.0, 0.0))
        elif kind == "pressed":
            self._slider = ode.SliderJoint(self._world)
            self._slider.attach(body, ode.environment)
            self._slider.setAxis((1.0, 0.0, 0.0))
            self._pressed = body
        self._body = body

    def _touch(self, _: Any, one: Any, other: Any) -> None:
        """Make a joint of every point at which two geoms meet."""
        bodies = one.getBody(), other.getBody()
        if bodies == (None, None):
            return
        for contact in ode.collide(one, other):
            contact.setMu(self._friction)
            contact.setMode(self._mode)
            if self._softness is not None:
                contact.setMode(self._mode | ode.ContactSoftCFM)
                contact.setSoftCFM(self._softness)
            ode.ContactJoint(self._world, self._contacts, contact).attach(*bodies)

    def step(self) -> None:
        """Find the contacts, press, and take a step."""
        self._space.collide(None, self._touch)
        if self._pressed is not None:
            self._pressed.addForce((-float(self._given["grip"]), 0.0, 0.0))
        self._world.step(self._time_step)
        self._contacts.empty()

    def state(self) -> Any:
        """Give position, orientation and velocity of the followed box."""
        return [*self._body.getPosition(), *self._body.getQuaternion(), *self._body.getLinearVel()]

    def push(self, force: Any) -> None:
        """Push the followed box in the next step."""
        self._body.addForce(force)

    def launch(self, velocity: Any) -> None:
        """Give the followed box a velocity and a spin about the vertical; it may have been asleep."""
        *linear, spin = velocity
        self._body.setLinearVel(linear)
        self._body.setAngularVel((0.0, 0.0, spin))
        self._body.enable()


class Joints:
    """One joint in the world, with a load, or hinges in a row; the motors' velocity is zero, their force bounded."""

    def __init__(self, given: dict[str, Any]):
        self._given, self._world, self._time_step = given, new_world(given), float(given["time_step"])
        self._joints, self._bodies = [], []
        self._slides = str(given["kind"]) == "slide"
        base = ode.environment
        for place, anchor, bound in zip(given["place"].tolist(), given["anchor"].tolist(), given["friction"].tolist()):
            body, inertia = ode.Body(self._world), ode.Mass()
            inertia.setParameters(float(given["mass"]), 0, 0, 0, *given["inertia"].tolist(), 0, 0, 0)
            body.setMass(inertia)
            body.setPosition(place)
            joint = (ode.SliderJoint if self._slides else ode.HingeJoint)(self._world)
            joint.attach(body, base)
            if not self._slides:
                joint.setAnchor(anchor)
            joint.setAxis(tuple(given["axis"].tolist()))
            joint.setParam(ode.ParamVel, 0.0)
            joint.setParam(int(given["fmax"]), bound)
            self._joints.append(joint)
            self._bodies.append(body)
            base = body

    def step(self) -> None:
        """Load the joint, and take a step."""
        load = tuple((float(self._given["load"]) * self._given["axis"]).tolist())
        (self._bodies[0].addForce if self._slides else self._bodies[0].addTorque)(load)
        self._world.step(self._time_step)

    def state(self) -> Any:
        """Give the coordinates."""
        return [joint.getPosition() if self._slides else joint.getAngle() for joint in self._joints]
