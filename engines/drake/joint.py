"""Drake's joint formulation: actuators that hold the inner masses, with at most the friction bound.

What both formulations share stands first: a plant with its load and its records, advanced in one call.
"""

import itertools
from abc import abstractmethod
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.units import Units
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.schemes.sequential import LaneModel
from reference_lcp.validation import FloatArray, checked_count


class Diagram:
    """A plant under a load from a table, and logs if they are to be kept: all of a step happens in Drake.

    `built` are a plant that is finalised, the output port of the forces of what rubs, ``None`` where nothing does, and
    what always acts on every coordinate; `outer`, `inner` and `across` the numbers of joints among the coordinates:
    of outer masses on the one before, of inner masses on their outer one, and across the motion, where there are such.
    """

    def __init__(self, builder: Any, built: tuple[Any, Any, FloatArray], time_step: float, *, record: bool):
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.primitives import LogVectorOutput

        self.plant, forces, constant_force = built
        self.outer, self.inner, self.across = (_numbers(self.plant, name) for name in ("outer", "inner", "across"))
        self._time_step = time_step
        self._source = self._add_load(builder, constant_force)
        ports = [self.plant.get_state_output_port(), *([] if forces is None else [forces])]
        self._logs = [LogVectorOutput(port, builder, time_step) for port in ports] if record else []
        self._diagram = builder.Build()
        self._simulator = Simulator(self._diagram)
        self._context = self._simulator.get_mutable_context()
        self._plant_context = self.plant.GetMyMutableContextFromRoot(self._context)

    def advance(self, vector: FloatArray, loads: FloatArray) -> FloatArray:
        """Take a step under each load, from coordinates and their velocities; give those at the end."""
        from pydrake.trajectories import PiecewisePolynomial

        steps = loads.shape[0]
        # A step reads its load at its start: there is one value from half a step before it to half a step after.
        breaks = self._time_step * (np.arange(steps + 1) - 0.5)
        table = np.append(loads, loads[-1])[None]
        self._source.UpdateTrajectory(PiecewisePolynomial.ZeroOrderHold(breaks, table))
        self._step(vector, steps)
        return np.array(self.plant.GetPositionsAndVelocities(self._plant_context))

    def recorded(self, *, sampled: bool) -> tuple[FloatArray, FloatArray]:
        """Give what the last run logged at the ends of its steps: coordinates with velocities, and forces.

        Forces are those that the plant kept from the step before where they are sampled, else of the step that begins.
        """
        rows = [log.FindLog(self._context).data().T for log in self._logs]
        motion: FloatArray = rows[0][1:]
        if len(rows) == 1:
            return motion, np.zeros((motion.shape[0], 0))
        return motion, rows[1][1:] if sampled else rows[1][:-1]

    def _step(self, vector: FloatArray, steps: int) -> None:
        """Start anew, with nothing left of earlier runs, and advance."""
        self._context.SetTime(0.0)
        self.plant.SetPositionsAndVelocities(self._plant_context, vector)
        for log in self._logs:
            log.FindMutableLog(self._context).Clear()
        self._simulator.Initialize()
        try:
            self._simulator.AdvanceTo(steps * self._time_step)
        except RuntimeError as problem:
            step = round(self._context.get_time() / self._time_step)
            raise RuntimeError(f"drake stopped in step {step} of {steps}: {problem}") from problem

    def _add_load(self, builder: Any, constant_force: FloatArray) -> Any:
        """Add a table in time, whose value acts on the first outer mass, beside the forces that never change."""
        from pydrake.systems.primitives import AffineSystem, TrajectorySource
        from pydrake.trajectories import PiecewisePolynomial

        coordinates = constant_force.size
        on_first = np.zeros((coordinates, 1))
        on_first[self.outer[0]] = 1
        source = builder.AddSystem(TrajectorySource(PiecewisePolynomial(np.zeros((1, 1)))))
        forces = builder.AddSystem(
            AffineSystem(
                A=np.zeros((0, 0)), B=np.zeros((0, 1)), f0=np.zeros(0),
                C=np.zeros((coordinates, 0)), D=on_first, y0=constant_force,
            )
        )  # fmt: skip
        builder.Connect(source.get_output_port(), forces.get_input_port())
        builder.Connect(forces.get_output_port(), self.plant.get_applied_generalized_force_input_port())
        return source


def _numbers(plant: Any, kind: str) -> NDArray[np.intp]:
    """Give the numbers of the joints ``KIND 0``, ``KIND 1``, … of one coordinate, as far as there are any."""
    names = itertools.takewhile(plant.HasJointNamed, (f"{kind} {cell}" for cell in itertools.count()))
    return np.array([plant.GetJointByName(name).position_start() for name in names], dtype=np.intp)


class DrakeLane(LaneModel):
    """One chain as a plant of Drake.

    The outer masses follow each other in a row of sliding joints, and each inner mass slides on its outer one: every
    spring and every dashpot of the chain is then one of a joint.
    """

    def __init__(self, lane: Lane, preset: Preset):
        self.lane = lane
        self._preset = preset
        # With dt as unit of time a step begins at a whole number.
        self._units = Units.in_steps(preset["units"], lane)
        self._time_step = lane.time_step / self._units.time
        self._chain = self._units.scaled(lane.chain)
        self._rubbing = np.flatnonzero(self._chain.friction_bound > 0)
        self._diagrams: dict[bool, Diagram] = {}

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; see `LaneModel.run`."""
        diagram = self._diagram(record=True)
        end = diagram.advance(self._vector(state), self._loads(start, steps))
        motion, forces = diagram.recorded(sampled=self._preset["output ports"] == "sampled")
        position, velocity = np.split(motion, 2, axis=1)
        friction, normal_force = self._contact_forces(diagram, forces)
        return Trajectory(
            self.lane.times(start, steps),
            _absolute(diagram, position) * self._units.length,
            _absolute(diagram, velocity) * self._units.velocity,
            friction,
            normal_force,
            self._internal_state(diagram, end),
        )

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, without logs."""
        diagram = self._diagram()
        end = diagram.advance(self._vector(state), self._loads(start, steps))
        position, velocity = (_absolute(diagram, half) for half in np.split(end[None], 2, axis=1))
        return self._units.state(position, velocity, self._internal_state(diagram, end))

    def close(self) -> None:
        """Let go of the diagrams; the next use builds them again."""
        self._diagrams.clear()

    @abstractmethod
    def _build(self, builder: Any) -> tuple[Any, Any, FloatArray]:
        """Add masses, joints and friction to a `DiagramBuilder`; gives what `Diagram` takes."""

    @abstractmethod
    def _contact_forces(self, diagram: Diagram, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give friction and normal force of every contact [N] from rows of the port of forces."""

    def _across(self, state: State) -> FloatArray:
        """Coordinates across the motion, then their velocities, shape (2, k)."""
        return np.zeros((2, 0))

    def _internal_state(self, diagram: Diagram, vector: FloatArray) -> FloatArray | None:
        """Give what a state has to carry beside positions and velocities."""
        return None

    def _cells(self, plant: Any, inner_mass: FloatArray) -> Iterator[tuple[int, Any, Any]]:
        """Add the sliders of cell after cell; gives each cell with its bodies, the second one of `inner_mass`."""
        chain, outer = self._chain, plant.world_body()
        for cell in range(chain.cells):
            springs = (
                (chain.chain_stiffness[cell], chain.chain_damping[cell]),
                (chain.inner_stiffness[cell], chain.inner_damping[cell]),
            )
            outer = _add_slider(plant, f"outer {cell}", outer, chain.outer_mass[cell], springs[0], self.lane.axis)
            yield cell, outer, _add_slider(plant, f"inner {cell}", outer, inner_mass[cell], springs[1], self.lane.axis)

    def _diagram(self, *, record: bool = False) -> Diagram:
        from pydrake.systems.framework import DiagramBuilder

        if record not in self._diagrams:
            builder = DiagramBuilder()
            self._diagrams[record] = Diagram(builder, self._build(builder), self._time_step, record=record)
        return self._diagrams[record]

    def _loads(self, start: int, steps: int) -> FloatArray:
        return self.lane.loads(start, checked_count("steps", steps)) / self._units.force

    def _vector(self, state: State) -> FloatArray:
        """Give Drake's coordinates and their velocities."""
        diagram = self._diagram()
        absolute = np.stack([state.positions[0] / self._units.length, state.velocities[0] / self._units.velocity])
        outer, inner = np.split(absolute, 2, axis=1)
        coordinates = np.zeros((2, diagram.plant.num_positions()))
        coordinates[:, diagram.outer] = np.diff(outer, axis=1, prepend=0.0)
        coordinates[:, diagram.inner] = inner - outer
        coordinates[:, diagram.across] = self._across(state)
        return coordinates.ravel()


def set_options(plant: Any, preset: Preset) -> None:
    """Set what holds for the whole plant."""
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -preset["gravity"]])
    plant.SetUseSampledOutputPorts(preset["output ports"] == "sampled")


def add_mass(plant: Any, name: str, mass: float) -> Any:
    """Add a body; nothing turns, so that its inertia never enters."""
    from pydrake.multibody.tree import SpatialInertia, UnitInertia

    return plant.AddRigidBody(name, SpatialInertia(mass, [0.0, 0.0, 0.0], UnitInertia.SolidSphere(1.0)))


def _add_slider(
    plant: Any, name: str, parent: Any, mass: float, spring: tuple[float, float], axis: tuple[float, float]
) -> Any:
    """Add a mass on a joint of this name along the row, with a spring and a dashpot of this stiffness and damping."""
    from pydrake.multibody.tree import PrismaticJoint, PrismaticSpring

    body = add_mass(plant, name, mass)
    stiffness, damping = spring
    joint = plant.AddJoint(PrismaticJoint(name, parent.body_frame(), body.body_frame(), [*axis, 0.0], damping=damping))
    plant.AddForceElement(PrismaticSpring(joint=joint, nominal_position=0.0, stiffness=stiffness))
    return body


def _absolute(diagram: Diagram, coordinates: FloatArray) -> FloatArray:
    """Turn rows of Drake's coordinates into (u, v), shape (steps, 2n); velocities likewise."""
    outer = np.cumsum(coordinates[:, diagram.outer], axis=1)
    return np.concatenate([outer, outer + coordinates[:, diagram.inner]], axis=1)


def actuator_gains(chain: Chain, time_step: float, preset: Preset) -> FloatArray:
    """Give force over relative velocity in stick of every actuator, shape (n,), in the units of what is given."""
    if "PdControllerGains.d" in preset.options:
        return np.full(chain.cells, preset["PdControllerGains.d"])
    reduced_mass = 1 / (1 / chain.outer_mass + 1 / chain.inner_mass)
    return preset["d"] * reduced_mass / time_step


def script_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give what a script prints beside options: the gain of every actuator [N s/m]."""
    return {"gain": actuator_gains(lane.chain, lane.time_step, preset)}


class DrakeJointLane(DrakeLane):
    """Friction −d ġ_T, implicit in the velocity at the end of the step, and cut off at the bound.

    A stuck contact creeps with λ_T / d. Drake limits d to 4π² m_i / (β² δt), with β = 0.1: what is stiffer
    would not be resolved by its solver in a step.
    """

    def _build(self, builder: Any) -> tuple[Any, Any, FloatArray]:
        from pydrake.multibody.plant import MultibodyPlant

        chain = self._chain
        plant = builder.AddSystem(MultibodyPlant(self._time_step))
        set_options(plant, self._preset)
        gains = actuator_gains(chain, self._time_step, self._preset)
        for cell, _, _ in self._cells(plant, chain.inner_mass):
            if chain.friction_bound[cell] > 0:
                self._add_actuator(plant, cell, float(gains[cell]))
        plant.Finalize()
        forces = self._armed(builder, plant) if self._rubbing.size else None
        return plant, forces, np.zeros(2 * chain.cells)

    def _add_actuator(self, plant: Any, cell: int, gain: float) -> None:
        from pydrake.multibody.tree import PdControllerGains

        joint = plant.GetJointByName(f"inner {cell}")
        bound = float(self._chain.friction_bound[cell])
        actuator = plant.AddJointActuator(f"friction {cell}", joint, effort_limit=bound)
        actuator.set_controller_gains(PdControllerGains(p=0.0, d=gain))

    def _armed(self, builder: Any, plant: Any) -> Any:
        """Set rest as the target of the actuators, without which they do nothing; give the port of their forces."""
        from pydrake.multibody.tree import default_model_instance
        from pydrake.systems.primitives import ConstantVectorSource

        rest = builder.AddSystem(ConstantVectorSource(np.zeros(2 * self._rubbing.size)))
        instance = default_model_instance()
        builder.Connect(rest.get_output_port(), plant.get_desired_state_input_port(instance))
        return plant.get_net_actuation_output_port(instance)

    def _contact_forces(self, diagram: Diagram, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
        friction = np.zeros((rows.shape[0], self._chain.cells))
        friction[:, self._rubbing] = rows * self._units.force
        return friction, self.lane.preloads(0, rows.shape[0])
