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
from reference_lcp.validation import FloatArray


class DrakeLane(LaneModel):
    """One chain as a plant of Drake, under a load from a table, with logs: all of a step happens in Drake.

    The outer masses follow each other in a row of sliding joints, and each inner mass slides on its outer one: every
    spring and every dashpot of the chain is then one of a joint. Joints are called ``outer 0``, ``inner 0`` and so on,
    and ``across 0`` where a mass has one across the motion.
    """

    def __init__(self, lane: Lane, preset: Preset):
        from pydrake import all as drake

        self.lane, self._preset = lane, preset
        # With dt as unit of time a step begins at a whole number.
        self._units = Units.in_steps(preset["units"], lane)
        self._time_step = lane.time_step / self._units.time
        self._chain = self._units.scaled(lane.chain)
        self._rubbing = np.flatnonzero(self._chain.friction_bound > 0)
        builder = drake.DiagramBuilder()
        self._plant, forces, constant_force = self._build(builder)
        self._outer, self._inner, self._across = (self._numbers(kind) for kind in ("outer", "inner", "across"))
        self._source = self._add_load(builder, constant_force)
        ports = [self._plant.get_state_output_port(), *([] if forces is None else [forces])]
        self._logs = [drake.LogVectorOutput(port, builder, self._time_step) for port in ports]
        self._simulator = drake.Simulator(builder.Build())
        self._context = self._simulator.get_mutable_context()
        self._plant_context = self._plant.GetMyMutableContextFromRoot(self._context)

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; motion is logged at the end of a step, forces at its start."""
        end = self.advance(state, start, steps).internal_state
        motion, *forces = (log.FindLog(self._context).data().T for log in self._logs)
        position, velocity = np.split(motion[1:], 2, axis=1)
        friction, normal_force = np.zeros((steps, self._chain.cells)), self.lane.preloads(0, steps)
        if forces:
            friction, normal_force = self._contact_forces(forces[0][:-1] * self._units.force, normal_force)
        return Trajectory(
            self.lane.times(start, steps),
            self._absolute(position) * self._units.length,
            self._absolute(velocity) * self._units.velocity,
            friction,
            normal_force,
            None if end is None else end[0],
        )

    def advance(self, state: State, start: int, steps: int) -> State:
        """Take a step under each load, and read the end from the plant."""
        from pydrake.trajectories import PiecewisePolynomial

        loads = self.lane.loads(start, steps) / self._units.force
        # A step reads its load at its start: there is one value from half a step before it to half a step after.
        breaks = self._time_step * (np.arange(steps + 1) - 0.5)
        table = np.append(loads, loads[-1])[None]
        self._source.UpdateTrajectory(PiecewisePolynomial.ZeroOrderHold(breaks, table))
        self._simulate(state, steps)
        end = np.array(self._plant.GetPositionsAndVelocities(self._plant_context)).reshape(2, 1, -1)
        position, velocity = map(self._absolute, end)
        return self._units.state(position, velocity, self._internal_state(*end[:, 0]))

    @abstractmethod
    def _build(self, builder: Any) -> tuple[Any, Any, FloatArray]:
        """Add masses, joints and friction to a `DiagramBuilder`.

        Gives the finalised plant, the output port of the forces of what rubs, ``None`` where nothing does, and what
        always acts on every coordinate.
        """

    @abstractmethod
    def _contact_forces(self, rows: FloatArray, pressing: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give friction and normal force of every contact [N], from rows of the port [N] and what presses."""

    def _coordinates_across(self, state: State) -> FloatArray:
        """Coordinates across the motion, then their velocities, shape (2, k)."""
        return np.zeros((2, 0))

    def _internal_state(self, position: FloatArray, velocity: FloatArray) -> FloatArray | None:
        """Give what a state has to carry beside positions and velocities."""
        return None

    def _simulate(self, state: State, steps: int) -> None:
        """Start anew, with nothing left of earlier runs, and advance."""
        self._context.SetTime(0.0)
        self._plant.SetPositionsAndVelocities(self._plant_context, self._vector(state))
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
        from pydrake import all as drake

        coordinates = constant_force.size
        on_first = np.zeros((coordinates, 1))
        on_first[self._outer[0]] = 1
        source = builder.AddSystem(drake.TrajectorySource(drake.PiecewisePolynomial(np.zeros((1, 1)))))
        forces = builder.AddSystem(
            drake.AffineSystem(
                A=np.zeros((0, 0)), B=np.zeros((0, 1)), f0=np.zeros(0),
                C=np.zeros((coordinates, 0)), D=on_first, y0=constant_force,
            )
        )  # fmt: skip
        builder.Connect(source.get_output_port(), forces.get_input_port())
        builder.Connect(forces.get_output_port(), self._plant.get_applied_generalized_force_input_port())
        return source

    def _cells(self, plant: Any, inner_mass: FloatArray) -> Iterator[tuple[int, Any, Any]]:
        """Add the sliders of cell after cell; gives each cell with its bodies, the second one of `inner_mass`."""
        chain, outer = self._chain, plant.world_body()
        outer_springs = np.stack([chain.chain_stiffness, chain.chain_damping], axis=1)
        inner_springs = np.stack([chain.inner_stiffness, chain.inner_damping], axis=1)
        for cell in range(chain.cells):
            outer = self._add_slider(plant, f"outer {cell}", outer, chain.outer_mass[cell], *outer_springs[cell])
            yield cell, outer, self._add_slider(plant, f"inner {cell}", outer, inner_mass[cell], *inner_springs[cell])

    def _add_slider(self, plant: Any, name: str, parent: Any, mass: float, stiffness: float, damping: float) -> Any:
        """Add a mass on a joint of this name along the row, with a spring and a dashpot."""
        from pydrake.multibody.tree import PrismaticJoint, PrismaticSpring

        body, axis = add_mass(plant, name, mass), [1.0, 0.0, 0.0]
        joint = plant.AddJoint(PrismaticJoint(name, parent.body_frame(), body.body_frame(), axis, damping=damping))
        plant.AddForceElement(PrismaticSpring(joint=joint, nominal_position=0.0, stiffness=stiffness))
        return body

    def _numbers(self, kind: str) -> NDArray[np.intp]:
        """Give the numbers of the joints ``KIND 0``, ``KIND 1``, … among the coordinates, as far as there are any."""
        names = itertools.takewhile(self._plant.HasJointNamed, (f"{kind} {cell}" for cell in itertools.count()))
        return np.array([self._plant.GetJointByName(name).position_start() for name in names], dtype=np.intp)

    def _vector(self, state: State) -> FloatArray:
        """Give Drake's coordinates and their velocities."""
        absolute = np.stack([state.positions[0] / self._units.length, state.velocities[0] / self._units.velocity])
        outer, inner = np.split(absolute, 2, axis=1)
        coordinates = np.zeros((2, self._plant.num_positions()))
        coordinates[:, self._outer] = np.diff(outer, axis=1, prepend=0.0)
        coordinates[:, self._inner] = inner - outer
        coordinates[:, self._across] = self._coordinates_across(state)
        return coordinates.ravel()

    def _absolute(self, coordinates: FloatArray) -> FloatArray:
        """Turn rows of Drake's coordinates into (u, v), shape (steps, 2n); velocities likewise."""
        outer = np.cumsum(coordinates[:, self._outer], axis=1)
        return np.concatenate([outer, outer + coordinates[:, self._inner]], axis=1)


def weightless(plant: Any) -> None:
    """Take gravity away; and let outputs be computed where they are asked for, which gives the same and costs less."""
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
    plant.SetUseSampledOutputPorts(False)


def add_mass(plant: Any, name: str, mass: float) -> Any:
    """Add a body; nothing turns, so that its inertia never enters."""
    from pydrake.multibody.tree import SpatialInertia, UnitInertia

    return plant.AddRigidBody(name, SpatialInertia(mass, [0.0, 0.0, 0.0], UnitInertia.SolidSphere(1.0)))


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
        from pydrake import all as drake

        chain, plant = self._chain, builder.AddSystem(drake.MultibodyPlant(self._time_step))
        weightless(plant)
        gains = actuator_gains(chain, self._time_step, self._preset)
        for cell, _, _ in self._cells(plant, chain.inner_mass):
            if chain.friction_bound[cell] > 0:
                joint, bound = plant.GetJointByName(f"inner {cell}"), float(chain.friction_bound[cell])
                actuator = plant.AddJointActuator(f"friction {cell}", joint, effort_limit=bound)
                actuator.set_controller_gains(drake.PdControllerGains(p=0.0, d=float(gains[cell])))
        plant.Finalize()
        return plant, self._armed(builder, plant) if self._rubbing.size else None, np.zeros(2 * chain.cells)

    def _armed(self, builder: Any, plant: Any) -> Any:
        """Set rest as the target of the actuators, without which they do nothing; give the port of their forces."""
        from pydrake import all as drake

        rest = builder.AddSystem(drake.ConstantVectorSource(np.zeros(2 * self._rubbing.size)))
        instance = drake.default_model_instance()
        builder.Connect(rest.get_output_port(), plant.get_desired_state_input_port(instance))
        return plant.get_net_actuation_output_port(instance)

    def _contact_forces(self, rows: FloatArray, pressing: FloatArray) -> tuple[FloatArray, FloatArray]:
        friction = np.zeros(pressing.shape)
        friction[:, self._rubbing] = rows
        return friction, pressing
