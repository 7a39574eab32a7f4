"""ODE, served by `worker` in a Python that has pyode: sliders with motors, or spheres and boxes pressed on plates.

A run builds its world anew: nothing is left of earlier runs. Springs, dashpots and the drive are forces that are
computed here at the start of each step.
"""

import functools
import shutil
import struct
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import ode

LOW_STOP, HIGH_STOP, VELOCITY, STOP_ERP, STOP_CFM = 0, 1, 2, 9, 10
"""Numbers of parameters in ODE 0.16; some of pyode's constants are those of an older one."""

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
        model = ContactModel if str(parameters["formulation"]) == "contact" else JointModel
        self._new_model = functools.partial(model, parameters)

    def run(
        self, position: Any, velocity: Any, loads: Any, record: bool, normal_load: Any = None, across: Any = None
    ) -> dict[str, Any]:
        """Advance; gives position, velocity, friction and, for contacts, normal force and gaps, one row a step."""
        model = self._new_model(position, velocity, record)
        if normal_load is not None:
            model.modulate(normal_load)
        return model.run(loads, across)


class JointModel:
    """Outer masses that slide in the world, on each an inner one whose slider has a motor of target velocity zero."""

    before_step: Any = None
    """What is to be done before a step."""

    def __init__(self, given: dict[str, Any], position: Any, velocity: Any, record: bool):
        """Build a world in this state; forces of joints are measured if they are to be recorded."""
        self._given = given
        self._record = record
        self.time_step = float(given["time_step"])
        self._bound = given["normal"] * given["coefficient"]
        self._cells = len(self._bound)
        self._has_springs = str(given.get("springs")) == "stops"
        self._axis = (*given["axis"].tolist(), 0.0)
        self.world = ode.World()
        self.world.setCFM(float(given["cfm"]))
        self.world.setERP(float(given["erp"]))
        masses = given["mass"].tolist()
        self._bodies = [self._new_body(mass, place) for mass, place in zip(masses, self._places())]
        sliding = [(outer, ode.environment) for outer in self._bodies[: self._cells]]
        # A joint ends with its last reference.
        self._guides = list(self._sprung()) if self._has_springs else [self._slider(*pair) for pair in sliding]
        self._add_friction()
        self._set_state(position.tolist(), velocity.tolist())

    def run(self, loads: Any, across: Any = None) -> dict[str, Any]:
        """Take a step for every load; a motion that diverges ends, and its last row is repeated."""
        self._getters = [body.getPosition for body in self._bodies] + [body.getLinearVel for body in self._bodies]
        if self._axis[1]:
            self._getters = [functools.partial(self._turned, get) for get in self._getters]
        coordinates = len(self._getters)
        rows = np.zeros((len(loads) + 1, coordinates + (self._measures if self._record else 0)))
        rows[0, :coordinates] = [get()[0] for get in self._getters]
        taken = self._take(loads, rows)
        rows[taken + 1 :] = rows[taken]
        position, velocity, measured = np.split(rows[1:], [coordinates // 2, coordinates], axis=1)
        return {"position": position, "velocity": velocity, **(self._named(measured) if self._record else {})}

    def _turned(self, get: Any) -> tuple[float]:
        """Give the part along the row of what a getter gives in the world."""
        return (float(np.dot(self._axis, get())),)

    def modulate(self, normal_load: Any) -> None:
        """Let every step begin with setting what its motors can do at most."""
        bounds, fmax = iter((normal_load * self._given["coefficient"]).tolist()), int(self._given["fmax"])

        def before() -> None:
            for motor, bound in zip(self._motors, next(bounds)):
                motor.setParam(fmax, bound)

        self.before_step = before

    def _take(self, loads: Any, rows: Any) -> int:
        """Take a step for every load, from the first row on, and fill the others; gives how many were taken."""
        step, time_step, before = self.world.step, self.time_step, self.before_step
        getters, pushes = self._getters, list(zip([body.setForce for body in self._bodies], self._pressing()))
        matrix = -np.hstack([self._given["stiffness"], self._given["damping"]])
        if self._has_springs:
            # The load on cell 1 is the only force.
            matrix, pushes = np.zeros_like(matrix[:1]), pushes[:1]
        # These take a third of the time of np.dot, and of giving an array a list.
        product, force = matrix.dot, np.empty(len(pushes))
        write, buffer, place = struct.Struct(f"{rows.shape[1]}d").pack_into, memoryview(rows).cast("B"), 0
        limit, (x, y, _) = STOP_BEYOND * float(self._given["length"]), self._axis
        for load, now in zip(loads.tolist(), rows[:, : len(getters)]):
            product(now, force)
            forces = force.tolist()
            forces[0] += load
            for value, (push, across) in zip(forces, pushes):
                push((x * value, y * value, across))
            if before is not None:
                before()
            step(time_step)
            values = [get()[0] for get in getters]
            reached = sum(values)
            if self._record:
                values += self._measure()
            place += rows.strides[0]
            write(buffer, place, *values)
            if not -limit < reached < limit:
                break
        return place // int(rows.strides[0])

    def _named(self, measured: Any) -> dict[str, Any]:
        friction = np.zeros((len(measured), self._cells))
        friction[:, self._bound > 0] = measured
        return {"friction": friction}

    def _pressing(self) -> list[float]:
        """Force on every mass across its motion."""
        return [0.0] * len(self._bodies)

    def _places(self) -> list[tuple[float, float]]:
        """Where every mass is across its motion: sideways and in height."""
        return [(0.0, 0.0)] * (2 * self._cells)

    def _new_body(self, mass: float, place: tuple[float, float]) -> Any:
        """Make a mass; its inertia never enters."""
        body, inertia = ode.Body(self.world), ode.Mass()
        inertia.setParameters(mass, 0, 0, 0, mass, mass, mass, 0, 0, 0)
        body.setMass(inertia)
        body.setPosition((0.0, *place))
        return body

    def _set_state(self, position: list[float], velocity: list[float]) -> None:
        x, y, _ = self._axis
        for body, (aside, height), place, speed in zip(self._bodies, self._places(), position, velocity):
            body.setPosition((x * place, aside + y * place, height))
            body.setLinearVel((x * speed, y * speed, 0.0))

    def _slider(self, body: Any, base: Any) -> Any:
        slider = ode.SliderJoint(self.world)
        slider.attach(body, base)
        slider.setAxis(self._axis)
        return slider

    def _sprung(self) -> Iterator[Any]:
        """Hang every mass on the one before it by a slider whose stops are both at zero, and as soft as the spring."""
        outer, inner = self._bodies[: self._cells], self._bodies[self._cells :]
        for kind, bodies, bases in (("chain", outer, [ode.environment, *outer]), ("inner", inner, outer)):
            stiffness, damping = self._given[kind + "_stiffness"], self._given[kind + "_damping"]
            for body, base, k, c in zip(bodies, bases, stiffness.tolist(), damping.tolist()):
                slider = self._slider(body, base)
                # After the stiffness and damping of constraints in ODE's manual.
                implicit = self.time_step * k + c
                slider.setParam(STOP_ERP, self.time_step * k / implicit)
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
        motor.setAxis(0, 0, self._axis)
        return motor

    def _add_friction(self) -> None:
        """Put motors between outer and inner masses."""
        self._motors = []
        for cell, bound in enumerate(self._bound.tolist()):
            motor = self._motor(self._bodies[self._cells + cell], self._bodies[cell])
            motor.setParam(VELOCITY, 0.0)
            motor.setParam(int(self._given["fmax"]), bound)
            motor.setFeedback(self._record)
            self._motors.append(motor)
        # ODE measures no motor of zero force: what its record held before would be taken for friction.
        self._feedbacks = [motor.getFeedback for motor, bound in zip(self._motors, self._bound) if bound > 0]
        self._measures = len(self._feedbacks)

    def _measure(self) -> list[float]:
        """Give the friction in the last step on every inner mass that rubs."""
        return [feedback()[0][0] for feedback in self._feedbacks]


class ContactModel(JointModel):
    """Spheres or boxes on plates, which press each other; every step finds its contacts and makes joints of them."""

    def __init__(self, given: dict[str, Any], position: Any, velocity: Any, record: bool):
        self._scale = float(given["length"])
        self._half, self._reach = float(given["box"]) * self._scale, float(given["plate"]) * self._scale
        self._constant_normal_load = True
        super().__init__(given, position, velocity, record)
        self.world.setContactSurfaceLayer(float(given["surface_layer"]) * self._scale)

    def run(self, loads: Any, across: Any = None) -> dict[str, Any]:
        """Take a step for every load, while every inner mass is on its plate.

        Where contacts may open, `across` holds their gaps at the start and, below, the rates of these.
        """
        gaps = None if across is None else self._record_gaps(across.reshape(2, -1))
        rows = super().run(loads)
        if gaps is not None:
            rows["gap"], rows["gap_rate"] = gaps(len(loads))
        self._drop_contacts()
        outer, inner = np.split(rows["position"], 2, axis=1)
        reach = self._reach - self._half
        if np.any(np.abs(inner - outer)[:, self._bound > 0] > reach):
            raise RuntimeError("an inner mass has left the plate of its outer one")
        return rows

    def _record_gaps(self, across: Any) -> Any:
        """Open the contacts, and note their gaps before every step; gives what turns the notes into rows."""
        inner = self._bodies[self._cells :]
        rest = [height for _, height in self._places()[self._cells :]]
        self._open(rest, across)
        notes: list[Any] = []
        set_normal_load = self.before_step

        def note() -> None:
            heights = [body.getPosition()[2] - height for body, height in zip(inner, rest)]
            notes.append(np.array([heights, [body.getLinearVel()[2] for body in inner]]))

        def before() -> None:
            note()
            set_normal_load()

        def rows(steps: int) -> Any:
            note()
            every = notes[1:] + notes[-1:] * (steps + 1 - len(notes))
            return np.array(every).swapaxes(0, 1)

        self.before_step = before
        return rows

    def _open(self, rest: list[float], across: Any) -> None:
        """Put inner masses where their gaps, and the rates of these, are those in `across`, shape (2, n)."""
        for body, height, above, rate in zip(self._bodies[self._cells :], rest, *across.tolist()):
            along, aside, _ = body.getPosition()
            body.setPosition((along, aside, height + above))
            body.setLinearVel((*body.getLinearVel()[:2], rate))

    def modulate(self, normal_load: Any) -> None:
        """Let every step begin with pressing the masses of every cell together, in place of the constant force."""
        normal_loads = iter(np.where(self._bound > 0, normal_load, 0.0).tolist())
        find_contacts = self.before_step
        self._constant_normal_load = False
        pairs = list(zip(self._bodies[: self._cells], self._bodies[self._cells :]))

        def before() -> None:
            for (outer, inner), value in zip(pairs, next(normal_loads)):
                outer.addForce((0.0, 0.0, value))
                inner.addForce((0.0, 0.0, -value))
            find_contacts()

        self.before_step = before

    def _named(self, measured: Any) -> dict[str, Any]:
        friction, normal = np.split(measured, 2, axis=1)
        return {"friction": friction, "normal": np.where(self._bound > 0, normal, self._given["normal"])}

    def _pressing(self) -> list[float]:
        pressing = np.where((self._bound > 0) & self._constant_normal_load, self._given["normal"], 0.0)
        return np.concatenate([pressing, -pressing]).tolist()

    def _places(self) -> list[tuple[float, float]]:
        half, depth = self._half, float(self._given["depth"]) * self._scale
        asides = [cell * float(self._given["spacing"]) * self._scale for cell in range(self._cells)]
        return [(aside, height) for height in (-half, half - depth) for aside in asides]

    def _add_friction(self) -> None:
        """Give all masses their shapes; before a step, contacts have to be found."""
        edge, length = 2 * self._half, 2 * self._reach
        self._contacts = ode.JointGroup()
        self._rubbing = []
        for cell in np.flatnonzero(self._bound > 0).tolist():
            outer, inner = self._bodies[cell], self._bodies[self._cells + cell]
            plate = ode.GeomBox(None, lengths=(length, length if self._axis[1] else edge, edge))
            sphere = str(self._given["shape"]) == "sphere"
            slider = ode.GeomSphere(None, edge / 2) if sphere else ode.GeomBox(None, lengths=(edge, edge, edge))
            plate.setBody(outer)
            slider.setBody(inner)
            self._rubbing.append((inner, outer, slider, plate, float(self._given["coefficient"][cell]), cell))
        self._joints: list[tuple[int, Any]] = []
        self._measures = 2 * self._cells
        self.before_step = self._find_contacts

    def _find_contacts(self) -> None:
        """Make a joint of every point at which an inner mass meets its plate."""
        world, group, mode, record = self.world, self._contacts, int(self._given["mode"]), self._record
        softness = float(self._given.get("soft_cfm", 0.0))
        mode |= ode.ContactSoftCFM if softness else 0
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
        """Give friction on every inner mass, then normal forces, in the last step: sums over points of contact."""
        measured = [0.0] * self._measures
        for cell, joint in self._joints:
            force = joint.getFeedback()[0]
            measured[cell] += self._axis[0] * force[0] + self._axis[1] * force[1]
            measured[self._cells + cell] += force[2]
        return measured

    def _new_body(self, mass: float, place: tuple[float, float]) -> Any:
        body, inertia = super()._new_body(mass, place), ode.Mass()
        turning = float(self._given["inertia"]) * mass * self._half**2
        inertia.setParameters(mass, 0, 0, 0, turning, turning, turning, 0, 0, 0)
        body.setMass(inertia)
        return body
