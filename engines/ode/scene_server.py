"""Scenes as users of ODE write them, served by `worker` in a Python that has pyode: geoms in a space, and joints."""

import math
from types import SimpleNamespace
from typing import Any

import ode


def scene(given: dict[str, Any]) -> Any:
    """Build a scene from what `engines.ode.scene` sends of it, and the options that its preset changes."""
    return boxes(given) if "size" in given else joints(given)


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


def boxes(given: dict[str, Any]) -> Any:
    """Build boxes that are fixed, driven, on a slider or free; every step finds their contacts and makes joints."""
    grip, belt = float(given["grip"]), float(given["belt"])
    world, space, contacts = new_world(given), ode.HashSpace(), ode.JointGroup()
    still = [] if belt else [add_wall(space, given) if grip else add_plane(space, given)]
    bodies, geoms = add_boxes(world, space, given)
    if belt:
        bodies[0].setKinematic()
        bodies[0].setLinearVel((belt, 0.0, 0.0))
    sliders = [add_slider(world, bodies[0])] if grip else []
    touch = joint_maker(world, contacts, given)

    def step() -> None:
        space.collide(None, touch)
        if grip:
            bodies[0].addForce((-grip, 0.0, 0.0))
        world.step(float(given["time_step"]))
        contacts.empty()

    def state() -> Any:
        return bodies[-1].getPosition(), bodies[-1].getQuaternion(), bodies[-1].getLinearVel()

    def launch(velocity: Any, spin: float) -> None:
        bodies[-1].setLinearVel(velocity)
        bodies[-1].setAngularVel((0.0, 0.0, spin))
        bodies[-1].enable()  # it may have been asleep

    def push(force: float) -> None:
        x, y, z = given["forward"].tolist()
        bodies[-1].addForce((force * x, force * y, force * z))

    kept = [*still, *geoms, *sliders]  # pyode drops what nothing holds
    return SimpleNamespace(step=step, state=state, launch=launch, push=push, kept=kept)


def add_plane(space: Any, given: dict[str, Any]) -> Any:
    """Add the plane on which boxes are."""
    return ode.GeomPlane(space, tuple(given["normal"].tolist()), 0.0)


def add_wall(space: Any, given: dict[str, Any]) -> Any:
    """Add a box of the size of the first one that stands still: it has no body."""
    wall = ode.GeomBox(space, tuple(given["size"].tolist()[0]))
    wall.setPosition(given["wall"].tolist())
    return wall


def add_boxes(world: Any, space: Any, given: dict[str, Any]) -> tuple[list[Any], list[Any]]:
    """Add boxes of uniform density; gives their bodies and their geoms."""
    bodies, geoms = [], []
    columns = [given[name].tolist() for name in ("size", "mass", "place", "orientation")]
    for size, mass, place, turned in zip(*columns):
        geom, body, inertia = ode.GeomBox(space, tuple(size)), ode.Body(world), ode.Mass()
        inertia.setBoxTotal(mass, *size)
        body.setMass(inertia)
        body.setPosition(place)
        body.setQuaternion(turned)
        geom.setBody(body)
        bodies.append(body)
        geoms.append(geom)
    return bodies, geoms


def add_slider(world: Any, body: Any) -> Any:
    """Let a body move along x alone."""
    slider = ode.SliderJoint(world)
    slider.attach(body, ode.environment)
    slider.setAxis((1.0, 0.0, 0.0))
    return slider


def joint_maker(world: Any, contacts: Any, given: dict[str, Any]) -> Any:
    """Give what makes a joint of every point in which two geoms touch."""
    friction, mode = float(given["friction"]), int(given["mode"])
    soft = "soft_cfm" in given

    def touch(_: Any, one: Any, other: Any) -> None:
        pair = one.getBody(), other.getBody()
        if pair == (None, None):
            return
        for contact in ode.collide(one, other):
            contact.setMu(friction)
            contact.setMode(mode | ode.ContactSoftCFM if soft else mode)
            if soft:
                contact.setSoftCFM(float(given["soft_cfm"]))
            ode.ContactJoint(world, contacts, contact).attach(*pair)

    return touch


def joints(given: dict[str, Any]) -> Any:
    """Build a joint in the world, with a load, or hinges in a row; motors of velocity zero and bounded force."""
    slides = str(given["kind"]) == "slide"
    load = tuple((float(given["load"]) * given["axis"]).tolist())
    world, base, motors, bodies = new_world(given), ode.environment, [], []
    if float(given["damping"]):  # of bodies that are made from now on
        part = 1 - math.exp(-float(given["damping"]) * float(given["time_step"]))  # in a step, of an inertia of 1
        world.setLinearDamping(part)
        world.setAngularDamping(part)
    places, anchors, bounds = given["place"].tolist(), given["anchor"].tolist(), given["friction"].tolist()
    for place, anchor, bound in zip(places, anchors, bounds):
        body, inertia = ode.Body(world), ode.Mass()
        inertia.setParameters(float(given["mass"]), 0, 0, 0, *given["inertia"].tolist(), 0, 0, 0)
        body.setMass(inertia)
        body.setPosition(place)
        joint = ode.SliderJoint(world) if slides else ode.HingeJoint(world)
        joint.attach(body, base)
        if not slides:
            joint.setAnchor(anchor)
        joint.setAxis(tuple(given["axis"].tolist()))
        joint.setParam(ode.ParamVel, 0.0)
        joint.setParam(int(given["fmax"]), bound)  # dParamFMax of ODE 0.16; pyode's constant is another's
        motors.append(joint)
        bodies.append(body)
        base = body
    velocity = tuple((float(given["velocity"]) * given["axis"]).tolist())
    if any(velocity) and slides:
        bodies[0].setLinearVel(velocity)
    elif any(velocity):
        bodies[0].setAngularVel(velocity)

    def step() -> None:
        if any(load) and slides:
            bodies[0].addForce(load)
        elif any(load):
            bodies[0].addTorque(load)
        world.step(float(given["time_step"]))

    def state() -> Any:
        return ([joint.getPosition() if slides else joint.getAngle() for joint in motors],)

    return SimpleNamespace(step=step, state=state)
