"""Lanes of Rapier, and its joint formulation: motors of bounded force that hold slip velocities at zero."""

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.force_loop import ExplicitForcesLane, Step
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

PARAMETERS = (
    "num_solver_iterations", "normalized_max_linear_velocity", "num_internal_pgs_iterations",
    "friction_in_bias_pass", "warmstart_coefficient", "contact_recycling",
)  # fmt: skip
"""Options that are parameters of a world's integration."""


def new_world(time_step: float, parameters: Mapping[str, Any]) -> Any:
    """Make a world without gravity."""
    import rapier3d

    world = rapier3d.PhysicsWorld()
    # What is given here is the world's own, and must not be assigned back.
    integration = world.integration_parameters
    integration.dt = time_step
    for name, value in parameters.items():
        setattr(integration, name, value)
    return world


def parameters_of(preset: Preset) -> dict[str, Any]:
    """Give the parameters of integration that a preset has."""
    return {name: preset[name] for name in PARAMETERS if name in preset.options}


class RapierLane(ExplicitForcesLane):
    """One chain; a run makes its world anew, for contacts keep their last impulses."""

    FREE_INNER = (True, False, False)
    """Directions in which inner masses move."""

    def __init__(self, lane: Lane, preset: Preset):
        super().__init__(lane, preset)
        # Where bodies are across the motion, shape (2n, 2), and the forces on them along z, shape (2n,).
        self._places = np.zeros((2 * lane.chain.cells, 2))
        self._pressing = np.zeros(2 * lane.chain.cells)

    @abstractmethod
    def _hold(self, world: Any, outer: list[Any], inner: list[Any]) -> None:
        """Add what makes friction between the masses of each cell, given by their handles."""

    def _begin(self, motion: FloatArray) -> Step:
        self._world, handles = self._new_world(motion)
        self._bodies = bodies = [self._world.rigid_bodies[handle] for handle in handles]
        loads = [(body.reset_forces, body.add_force) for body in bodies]
        advance = self._world.step

        def step(force: FloatArray) -> None:
            # Forces stay until they are taken off.
            for (reset, push), along, across in zip(loads, force.tolist(), self._pressing.tolist(), strict=True):
                reset(True)
                push((along, 0.0, across), True)
            advance()
            vectors = [body.translation for body in bodies] + [body.linvel for body in bodies]
            motion[:] = [vector.x for vector in vectors]

        return step

    def _new_world(self, motion: FloatArray) -> tuple[Any, list[Any]]:
        """Make the world with this motion; give it and the handles of its bodies, outer masses first."""
        import rapier3d

        world = new_world(self._time_step, parameters_of(self._preset))
        cells, masses = self._chain.cells, np.concatenate([self._chain.outer_mass, self._chain.inner_mass])
        free = [(True, False, False)] * cells + [self.FREE_INNER] * cells
        positions, velocities = motion.reshape(2, -1).tolist()
        handles = [
            # Every call gives another builder, and leaves the one before as it was.
            world.add_body(
                rapier3d.RigidBody.dynamic()
                .translation((position, aside, z))
                .linvel((velocity, 0.0, 0.0))
                .additional_mass(mass)
                .enabled_translations(directions)
                .enabled_rotations((False, False, False))
                .can_sleep(self._preset["can_sleep"])
            )
            for position, velocity, (aside, z), mass, directions in zip(
                positions, velocities, self._places.tolist(), masses.tolist(), free, strict=True
            )
        ]
        self._hold(world, handles[:cells], handles[cells:])
        return world, handles


class RapierJointLane(RapierLane):
    """One chain with a motor in every cell."""

    def _hold(self, world: Any, outer: list[Any], inner: list[Any]) -> None:
        from rapier3d import GenericJoint, JointAxesMask, JointAxis, MotorModel

        self._axis, joints = JointAxis.LIN_X, world.impulse_joints
        # No axis is locked: bodies have their guides themselves.
        motor = (
            GenericJoint.builder(JointAxesMask.empty())
            .motor_velocity(self._axis, 0.0, self._preset["motor factor"])
            .motor_model(self._axis, MotorModel.FORCE_BASED)
        )
        bounded = [motor.motor_max_force(self._axis, bound) for bound in self._chain.friction_bound.tolist()]
        # The data of a joint is the joint's own, and no copy.
        self._joints = [
            joints[joints.insert(*pair, joint)].data for *pair, joint in zip(outer, inner, bounded, strict=True)
        ]

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        bounds = (self._chain.friction_coefficient * normal_load).tolist()
        for joint, bound in zip(self._joints, bounds, strict=True):
            joint.set_motor_max_force(self._axis, bound)

    def _contacts(self) -> list[float]:
        """Read impulses of the last substep over its length; Rapier gives them as they act on the outer mass."""
        rate, axis = -self._preset["num_solver_iterations"] / self._time_step, self._axis
        return [rate * joint.motor(axis).impulse for joint in self._joints]
