"""One chain in Drake, whatever its formulation: masses in a row of joints, and states in and out of them."""

from abc import abstractmethod
from functools import cached_property
from typing import Any

import numpy as np

from engines.drake.diagram import Diagram, Mechanism
from engines.interface.presets import Option, Preset
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray, checked_count

SHARED_TUNED_OPTIONS = {
    "units": Option("lane", "SI", "No number comes near Drake's built-in smallest and largest ones."),
    "gravity": Option(0.0, 9.81, "The chain has no weight."),
    "output ports": Option("live", "sampled", "The same forces, without keeping them in every step: a tenth faster."),
}
"""Options that the tuned presets of both formulations share."""

SHARED_DEFAULT_OPTIONS = {
    "units": Option("SI", "SI", "The chain in SI units."),
    "gravity": Option(0.0, 9.81, "Needed: the chain has no weight."),
    "output ports": Option("sampled", "sampled", "Drake's own."),
}
"""Options of the default presets of both formulations."""


class DrakeLane(LaneModel):
    """One chain as a plant of Drake.

    The outer masses follow each other in a row of sliding joints, and each inner mass slides on its outer one: every
    spring and every dashpot of the chain is then one of a joint.
    """

    def __init__(self, lane: Lane, preset: Preset):
        """Take the lane's parameters in its units."""
        self.lane = lane
        self._preset = preset
        # With dt as unit of time a step begins at a whole number.
        self._units = Units.in_steps(preset["units"], lane)
        self._time_step = lane.time_step / self._units.time
        self._chain = self._units.scaled(lane.chain)
        self._rubbing = np.flatnonzero(self._chain.friction_bound > 0)

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; see `LaneModel.run`."""
        diagram = self._recording
        end = diagram.advance(self._vector(state), self._loads(start, steps))
        motion, forces = diagram.recorded(sampled=self._preset["output ports"] == "sampled")
        position, velocity = np.split(motion, 2, axis=1)
        friction, normal_force = self._contact_forces(diagram.mechanism, forces)
        return Trajectory(
            self.lane.times(start, steps),
            _absolute(diagram.mechanism, position) * self._units.length,
            _absolute(diagram.mechanism, velocity) * self._units.velocity,
            friction,
            normal_force,
            self._internal_state(diagram.mechanism, end),
        )

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, without logs."""
        diagram = self._plain
        end = diagram.advance(self._vector(state), self._loads(start, steps))
        position, velocity = np.split(end[None], 2, axis=1)
        along = _absolute(diagram.mechanism, position), _absolute(diagram.mechanism, velocity)
        return self._units.state(*along, self._internal_state(diagram.mechanism, end))

    def native_steps(self, steps: int) -> None:
        """Take steps of Drake alone, from rest; see `NativeStepping`."""
        self._plain.native_steps(checked_count("steps", steps))

    def close(self) -> None:
        """Let go of the diagrams; the next use builds them again."""
        for name in ("_plain", "_recording"):
            self.__dict__.pop(name, None)

    @abstractmethod
    def _mechanism(self, builder: Any) -> Mechanism:
        """Add masses, joints and friction to a `DiagramBuilder`."""

    @abstractmethod
    def _contact_forces(self, mechanism: Mechanism, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give friction and normal force of every contact [N] from rows of the mechanism's port of forces."""

    def _across(self, state: State) -> FloatArray:
        """Coordinates across the motion, then their velocities, shape (2, k)."""
        return np.zeros((2, 0))

    def _internal_state(self, mechanism: Mechanism, vector: FloatArray) -> FloatArray | None:
        """Give what a state has to carry beside positions and velocities."""
        return None

    @cached_property
    def _plain(self) -> Diagram:
        return self._diagram(record=False)

    @cached_property
    def _recording(self) -> Diagram:
        return self._diagram(record=True)

    def _diagram(self, *, record: bool) -> Diagram:
        from pydrake.systems.framework import DiagramBuilder

        builder = DiagramBuilder()
        return Diagram(builder, self._mechanism(builder), self._time_step, record=record)

    def _loads(self, start: int, steps: int) -> FloatArray:
        return self.lane.loads(start, checked_count("steps", steps)) / self._units.force

    def _vector(self, state: State) -> FloatArray:
        """Give Drake's coordinates and their velocities."""
        mechanism = self._plain.mechanism
        absolute = np.stack([state.positions[0] / self._units.length, state.velocities[0] / self._units.velocity])
        outer, inner = np.split(absolute, 2, axis=1)
        coordinates = np.zeros((2, mechanism.constant_force.shape[0]))
        coordinates[:, mechanism.outer] = np.diff(outer, axis=1, prepend=0.0)
        coordinates[:, mechanism.inner] = inner - outer
        coordinates[:, mechanism.across] = self._across(state)
        return coordinates.ravel()


def set_options(plant: Any, preset: Preset) -> None:
    """Set what holds for the whole plant."""
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -preset["gravity"]])
    plant.SetUseSampledOutputPorts(preset["output ports"] == "sampled")


def add_mass(plant: Any, name: str, mass: float) -> Any:
    """Add a body; nothing turns, so that its inertia never enters."""
    from pydrake.multibody.tree import SpatialInertia, UnitInertia

    return plant.AddRigidBody(name, SpatialInertia(mass, [0.0, 0.0, 0.0], UnitInertia.SolidSphere(1.0)))


ALONG_X = (1.0, 0.0)
"""Axis of a row that is not turned."""


def add_slider(
    plant: Any, name: str, parent: Any, mass: float, spring: tuple[float, float], axis: tuple[float, float] = ALONG_X
) -> Any:
    """Add a mass that slides along the row relative to its parent; its joint has its name.

    It is held by a spring and a dashpot, `spring` being their stiffness and damping.
    """
    from pydrake.multibody.tree import PrismaticJoint, PrismaticSpring

    body = add_mass(plant, name, mass)
    stiffness, damping = spring
    joint = plant.AddJoint(PrismaticJoint(name, parent.body_frame(), body.body_frame(), [*axis, 0.0], damping=damping))
    plant.AddForceElement(PrismaticSpring(joint=joint, nominal_position=0.0, stiffness=stiffness))
    return body


def _absolute(mechanism: Mechanism, coordinates: FloatArray) -> FloatArray:
    """Turn rows of Drake's coordinates into (u, v), shape (steps, 2n); velocities likewise."""
    outer = np.cumsum(coordinates[:, mechanism.outer], axis=1)
    return np.concatenate([outer, outer + coordinates[:, mechanism.inner]], axis=1)
