"""Lanes of Box2D 3, whatever holds their masses together, and its joint formulation: motors of bounded force."""

import math
from abc import abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.force_loop import ExplicitForcesLane, Step
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray


class Box2DLane(ExplicitForcesLane):
    """One chain; a run makes its world anew, for joints and contacts keep their last impulses."""

    world: ClassVar[Any] = None
    """Of the lane that runs: Box2D has room for 128 worlds in a process, and the one before makes way here."""

    def __init__(self, lane: Lane, preset: Preset):
        super().__init__(lane, preset)
        self._masses = np.concatenate([self._chain.outer_mass, self._chain.inner_mass])
        # Where bodies are across the motion, and the forces on them there.
        self._heights, self._pressing = np.zeros((2, self._masses.size))

    @abstractmethod
    def _hold(self, world: Any, outer: list[Any], inner: list[Any]) -> None:
        """Add what makes friction between the masses of each cell."""

    def _begin(self, motion: FloatArray) -> Step:
        import pyb2d3

        world, bodies = self._new_world(motion)
        batch, count = pyb2d3.Bodies(), len(bodies)
        for body in bodies:
            batch.append(body)
        positions, velocities = np.empty((2, count, 2), np.float32)
        self._velocities = velocities
        pushes, across = [body.apply_force_to_center for body in bodies], self._pressing.tolist()
        time_step, substeps = self._time_step, self._preset["sub_step_count"]

        def step(force: FloatArray) -> None:
            for push, along, normal_load in zip(pushes, force.tolist(), across, strict=True):
                push((along, normal_load))
            world.step(time_step, substeps)
            batch.get_positions(positions)
            batch.get_linear_velocities(velocities)
            motion[:count], motion[count:] = positions[:, 0], velocities[:, 0]

        return step

    def _new_world(self, motion: FloatArray) -> tuple[Any, list[Any]]:
        """Make the world with this motion; give it and its bodies, outer masses first."""
        import pyb2d3

        names = [name for name in ("maximum_linear_speed", "contact_hertz") if name in self._preset.options]
        Box2DLane.world = world = pyb2d3.World(gravity=(0.0, 0.0), **{name: self._preset[name] for name in names})
        world.sleeping_enabled = self._preset["sleeping_enabled"]
        bodies = [
            world.create_dynamic_body(position=(along, across), linear_velocity=(velocity, 0.0), fixed_rotation=True)
            for along, velocity, across in zip(*np.split(motion, 2), self._heights, strict=True)
        ]
        outer, inner = bodies[: len(bodies) // 2], bodies[len(bodies) // 2 :]
        self._hold(world, outer, inner)
        # Afterwards, for shapes bring a mass of their own.
        for body, mass in zip(bodies, self._masses, strict=True):
            data = pyb2d3.MassData()
            data.mass, data.rotational_inertia, data.center = mass, 0.0, (0.0, 0.0)
            body.mass_data = data
        return world, bodies


class Box2DJointLane(Box2DLane):
    """One chain with prismatic joints, whose motors rub."""

    def __init__(self, lane: Lane, preset: Preset):
        self._own_springs = preset["springs"] == "prismatic joints"
        super().__init__(lane, preset)

    def _hold(self, world: Any, outer: list[Any], inner: list[Any]) -> None:
        chain, cells = self._chain, len(outer)
        bounds = chain.friction_bound.tolist()
        motors = [{"enable_motor": True, "motor_speed": 0.0, "max_motor_force": bound} for bound in bounds]
        springs: Sequence[dict[str, Any]] = [{}] * cells
        if self._own_springs:
            springs = _springs(chain.inner_stiffness, chain.inner_damping, chain.outer_mass, chain.inner_mass)
            before = np.concatenate([[np.inf], chain.outer_mass[:-1]])
            along = _springs(chain.chain_stiffness, chain.chain_damping, before, chain.outer_mass)
            for left, right, spring in zip([world.create_static_body(), *outer[:-1]], outer, along, strict=True):
                world.create_prismatic_joint(left, right, collide_connected=True, **spring)
        self._joints = [
            world.create_prismatic_joint(left, right, **spring, **motor)
            for left, right, spring, motor in zip(outer, inner, springs, motors, strict=True)
        ]

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        for joint, bound in zip(self._joints, (self._chain.friction_coefficient * normal_load).tolist(), strict=True):
            joint.max_motor_force = bound

    def _contacts(self) -> list[float]:
        """Read the motors' forces of the last substep, which act on the inner mass; those of springs are apart."""
        return [joint.get_constraint_force()[0] for joint in self._joints]


def _springs(
    stiffness: FloatArray, damping: FloatArray, left: FloatArray, right: FloatArray
) -> Sequence[dict[str, Any]]:
    """Give springs and dashpots [in the lane's units] as Box2D has them: by the frequency of their two masses."""
    mass = 1 / (1 / left + 1 / right)
    omega = np.sqrt(stiffness / mass)
    rates = np.column_stack([omega / (2 * math.pi), damping / (2 * mass * omega)])
    return [{"enable_spring": True, "hertz": hertz, "damping_ratio": ratio} for hertz, ratio in rates.tolist()]
