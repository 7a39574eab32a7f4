"""ODE, served by `worker` in a Python that has pyode: sliders with motors, or spheres and boxes pressed on plates.

A run builds its world anew: nothing is left of earlier runs. Springs, dashpots and the drive are forces that are
computed here at the start of each step.
"""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import ode

LOW_STOP, HIGH_STOP, VELOCITY, STOP_ERP, STOP_CFM = 0, 1, 2, 9, 10
"""Numbers of parameters in ODE 0.16; some of pyode's constants are those of an older one."""

ALONG = (1.0, 0.0, 0.0)
"""Axis of the row."""

STOP_BEYOND = 1e8
"""Motion over the displacement scale at which a run ends: further on, ODE would end the process."""


def versions() -> dict[str, str]:
    """Give the version of ODE; pyode states none, so that it is Debian's, or the one in the name of the library."""
    query = shutil.which("dpkg-query")
    if query is not None:
        command = [query, "-W", "-f=${Version}", "libode8"]
        debian = subprocess.run(command, capture_output=True, text=True, check=False).stdout
        if debian:
            return {"engine": debian.split(":")[-1].split("-")[0]}
    loaded = {line.split()[-1] for line in Path("/proc/self/maps").read_text().splitlines() if "libode." in line}
    return {"engine": " ".join(sorted(Path(name).name for name in loaded)) or "of unknown version"}


class EngineLane:
    """One chain; `parameters` are what `engines.isolated.out_of_process` sends of it, and the options of its preset."""

    def __init__(self, parameters: dict[str, Any]):
        self._parameters = parameters

    def run(
        self, position: Any, velocity: Any, loads: Any, record: bool, normal_load: Any = None, across: Any = None
    ) -> dict[str, Any]:
        """Advance; gives position, velocity, friction and, for contacts, normal force and gaps, one row a step."""
        kind = ContactModel if str(self._parameters["formulation"]) == "contact" else JointModel
        model = kind(self._parameters, record)
        model.put(position.tolist(), velocity.tolist(), across)
        return model.run(loads, normal_load)


class JointModel:
    """Outer masses that slide in the world, on each an inner one whose slider has a motor of target velocity zero."""

    def __init__(self, given: dict[str, Any], record: bool):
        """Build a world at rest; forces of joints are measured if they are to be recorded."""
        self._given, self._record = given, record
        self._bound = given["normal"] * given["coefficient"]
        self._cells = len(self._bound)
        self._has_springs = str(given.get("springs")) == "stops"
        self._time_step = float(given["time_step"])
        self.world = ode.World()
        self.world.setCFM(float(given["cfm"]))
        self.world.setERP(float(given["erp"]))
        bodies = [self._new_body(mass, place) for mass, place in zip(given["mass"].tolist(), self._places())]
        self._bodies, self._outer, self._inner = bodies, bodies[: self._cells], bodies[self._cells :]
        # A joint ends with its last reference.
        self._guides = list(self._sprung() if self._has_springs else self._guided())
        self._add_friction()

    def put(self, position: list[float], velocity: list[float], _across: Any) -> None:
        """Give the masses a state."""
        for body, (aside, height), place, speed in zip(self._bodies, self._places(), position, velocity):
            body.setPosition((place, aside, height))
            body.setLinearVel((speed, 0.0, 0.0))

    def run(self, loads: Any, normal_load: Any) -> dict[str, Any]:
        """Take a step for every load; a motion that diverges ends, and its last row is repeated."""
        motion, count = self._motion(), 2 * len(self._bodies)
        rows = np.zeros((len(loads) + 1, count + len(self._measure())))
        rows[0, :count] = motion()
        taken = self._take(loads, normal_load, motion, rows)
        rows[taken + 1 :] = rows[taken]
        position, velocity, measured = np.split(rows[1:], [count // 2, count], axis=1)
        return {"position": position, "velocity": velocity, **self._named(measured)}

    def _take(self, loads: Any, normal_load: Any, motion: Any, rows: Any) -> int:
        """Take a step for every load, from the first row on, and fill the others; gives how many were taken."""
        pushes, count = [body.setForce for body in self._bodies], 2 * len(self._bodies)
        matrix = -np.hstack([self._given["stiffness"], self._given["damping"]])
        if self._has_springs:
            # The load on cell 1 is the only force.
            matrix, pushes = np.zeros_like(matrix[:1]), pushes[:1]
        limit, force = STOP_BEYOND * float(self._given["length"]), np.empty(len(pushes))
        pressing = self._press(self._given["normal"])
        for number, load in enumerate(loads.tolist()):
            if normal_load is not None:
                pressing = self._press(normal_load[number])
            matrix.dot(rows[number, :count], force)
            force[0] += load
            for value, across, push in zip(force.tolist(), pressing, pushes):
                push((value, 0.0, across))
            self._meet()
            self.world.step(self._time_step)
            moved = motion()
            rows[number + 1] = moved + self._measure()
            if not -limit < sum(moved) < limit:
                return number + 1
        return len(loads)

    def _motion(self) -> Any:
        """Give what reads positions and velocities along the row."""
        getters = [body.getPosition for body in self._bodies] + [body.getLinearVel for body in self._bodies]
        return lambda: [get()[0] for get in getters]

    def _press(self, normal_load: Any) -> list[float]:
        """Set what motors can do at most; gives the force on every mass across its motion."""
        for motor, bound in zip(self._motors, (normal_load * self._given["coefficient"]).tolist()):
            motor.setParam(int(self._given["fmax"]), bound)
        return [0.0] * len(self._bodies)

    def _meet(self) -> None:
        """Do what a step begins with."""

    def _measure(self) -> list[float]:
        """Give the friction in the last step on every inner mass; ODE measures no motor that never has a force."""
        return [feedback()[0][0] if feedback else 0.0 for feedback in self._feedbacks]

    def _named(self, measured: Any) -> dict[str, Any]:
        return {"friction": measured} if self._record else {}

    def _places(self) -> list[tuple[float, float]]:
        """Where every mass is across its motion: sideways and in height."""
        return [(0.0, 0.0)] * (2 * self._cells)

    def _new_body(self, mass: float, place: tuple[float, float]) -> Any:
        """Make a mass; its inertia never enters."""
        body, inertia = ode.Body(self.world), ode.Mass()
        turning = self._inertia(mass)
        inertia.setParameters(mass, 0, 0, 0, turning, turning, turning, 0, 0, 0)
        body.setMass(inertia)
        body.setPosition((0.0, *place))
        return body

    def _inertia(self, mass: float) -> float:
        return mass

    def _slider(self, body: Any, base: Any) -> Any:
        slider = ode.SliderJoint(self.world)
        slider.attach(body, base)
        slider.setAxis(ALONG)
        return slider

    def _guided(self) -> Iterator[Any]:
        """Let outer masses slide in the world."""
        return (self._slider(outer, ode.environment) for outer in self._outer)

    def _sprung(self) -> Iterator[Any]:
        """Hang every mass on the one before it by a slider whose stops are both at zero, and as soft as the spring."""
        rows = ("chain", self._outer, [ode.environment, *self._outer]), ("inner", self._inner, self._outer)
        for kind, bodies, bases in rows:
            stiffness, damping = self._given[kind + "_stiffness"], self._given[kind + "_damping"]
            for body, base, k, c in zip(bodies, bases, stiffness.tolist(), damping.tolist()):
                slider = self._slider(body, base)
                # After the stiffness and damping of constraints in ODE's manual.
                implicit = self._time_step * k + c
                slider.setParam(STOP_ERP, self._time_step * k / implicit)
                slider.setParam(STOP_CFM, 1 / implicit)
                slider.setParam(LOW_STOP, 0.0)
                slider.setParam(HIGH_STOP, 0.0)
                yield slider

    def _motor(self, body: Any, base: Any) -> Any:
        """Make the joint whose motor is to be the friction; one with a spring has none beside its stops."""
        if not self._has_springs:
            return self._slider(body, base)
        motor = ode.LMotor(self.world)
        motor.attach(body, base)
        motor.setNumAxes(1)
        motor.setAxis(0, 0, ALONG)
        return motor

    def _add_friction(self) -> None:
        """Put motors between outer and inner masses."""
        self._motors = [self._motor(*pair) for pair in zip(self._inner, self._outer)]
        for motor in self._motors:
            motor.setParam(VELOCITY, 0.0)
            motor.setFeedback(self._record)
        rub = zip(self._motors, self._bound)
        self._feedbacks = [motor.getFeedback if bound > 0 else None for motor, bound in rub] if self._record else []


class ContactModel(JointModel):
    """Spheres or boxes on plates, which press each other; every step finds its contacts and makes joints of them."""

    def __init__(self, given: dict[str, Any], record: bool):
        self._scale = float(given["length"])
        self._half, self._reach = float(given["box"]) * self._scale, float(given["plate"]) * self._scale
        super().__init__(given, record)
        self.world.setContactSurfaceLayer(float(given["surface_layer"]) * self._scale)

    def put(self, position: list[float], velocity: list[float], across: Any) -> None:
        """Give the masses a state; where contacts open, `across`, shape (2, n), has their gaps and gap rates."""
        super().put(position, velocity, across)
        self._opens = across is not None
        if across is None:
            return
        for body, above, rate in zip(self._inner, *across.tolist()):
            along, aside, height = body.getPosition()
            body.setPosition((along, aside, height + above))
            body.setLinearVel((*body.getLinearVel()[:2], rate))

    def run(self, loads: Any, normal_load: Any) -> dict[str, Any]:
        """Take a step for every load, while every inner mass is on its plate."""
        rows = super().run(loads, normal_load)
        self._drop_contacts()
        outer, inner = np.split(rows["position"], 2, axis=1)
        if np.any(np.abs(inner - outer)[:, self._bound > 0] > self._reach - self._half):
            raise RuntimeError("an inner mass has left the plate of its outer one")
        return rows

    def _press(self, normal_load: Any) -> list[float]:
        """Press the masses of every cell together."""
        pressing = np.where(self._bound > 0, normal_load, 0.0)
        return np.concatenate([pressing, -pressing]).tolist()

    def _places(self) -> list[tuple[float, float]]:
        half, depth = self._half, float(self._given["depth"]) * self._scale
        asides = [cell * float(self._given["spacing"]) * self._scale for cell in range(self._cells)]
        return [(aside, height) for height in (-half, half - depth) for aside in asides]

    def _inertia(self, mass: float) -> float:
        return float(self._given["inertia"]) * mass * self._half**2

    def _add_friction(self) -> None:
        """Give all masses their shapes; in every step, contacts have to be found."""
        edge, length = 2 * self._half, 2 * self._reach
        self._contacts, self._rubbing = ode.JointGroup(), []
        self._joints: list[tuple[int, Any]] = []
        for cell in np.flatnonzero(self._bound > 0).tolist():
            outer, inner = self._outer[cell], self._inner[cell]
            plate = ode.GeomBox(None, lengths=(length, edge, edge))
            sphere = str(self._given["shape"]) == "sphere"
            slider = ode.GeomSphere(None, edge / 2) if sphere else ode.GeomBox(None, lengths=(edge, edge, edge))
            plate.setBody(outer)
            slider.setBody(inner)
            self._rubbing.append((inner, outer, slider, plate, float(self._given["coefficient"][cell]), cell))
        self._softness = float(self._given.get("soft_cfm", 0.0))
        self._mode = int(self._given["mode"]) | (ode.ContactSoftCFM if self._softness else 0)

    def _meet(self) -> None:
        """Make a joint of every point at which an inner mass meets its plate."""
        world, group, mode, softness, record = self.world, self._contacts, self._mode, self._softness, self._record
        self._drop_contacts()
        for inner, outer, slider, plate, coefficient, cell in self._rubbing:
            for contact in ode.collide(slider, plate):
                contact.setMode(mode)
                contact.setMu(coefficient)
                contact.setSoftCFM(softness)
                joint = ode.ContactJoint(world, group, contact)
                joint.attach(inner, outer)
                if record:
                    joint.setFeedback(True)
                    self._joints.append((cell, joint))

    def _drop_contacts(self) -> None:
        """Empty the group; a measured joint that is destroyed by it takes the process along when pyode lets it go."""
        for _, joint in self._joints:
            joint.setFeedback(False)
        self._joints.clear()
        self._contacts.empty()

    def _measure(self) -> list[float]:
        """Give gaps and their rates where contacts open; friction and normal forces, sums over points of contact."""
        gaps = self._gaps() if self._opens else []
        if not self._record:
            return gaps
        forces = [0.0] * (2 * self._cells)
        for cell, joint in self._joints:
            force = joint.getFeedback()[0]
            forces[cell] += force[0]
            forces[self._cells + cell] += force[2]
        return gaps + forces

    def _gaps(self) -> list[float]:
        heights = [height for _, height in self._places()[self._cells :]]
        gaps = [body.getPosition()[2] - height for body, height in zip(self._inner, heights)]
        return gaps + [body.getLinearVel()[2] for body in self._inner]

    def _named(self, measured: Any) -> dict[str, Any]:
        rows: dict[str, Any] = {}
        if self._opens:
            rows["gap"], rows["gap_rate"], measured = np.split(measured, [self._cells, 2 * self._cells], axis=1)
        if self._record:
            rows["friction"], normal = np.split(measured, 2, axis=1)
            rows["normal"] = np.where(self._bound > 0, normal, self._given["normal"])
        return rows
