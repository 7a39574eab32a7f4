"""SAPIEN's contact formulation: in every cell a sphere, the inner mass, pressed on a plate, the outer one.

Both are pressed, against each other, and touch without a gap: a mass that is pressed alone sinks in, or is held up, for
some steps after the start, with another normal force in each.
"""

from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.sapien.joint import SapienLane, import_sapien
from multibody_xval.engines.shared.force_loop import PressedLane, Step
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

ROUNDINGS = 8
"""Of a velocity in a step: two in storing it before and after, the others in adding impulses."""


class SapienContactLane(PressedLane, SapienLane):
    """One chain with a sphere on a plate in every cell, side by side.

    SAPIEN tells impulses of contacts, of which friction may lie anywhere within four: it is read from the momentum of
    the inner masses.
    """

    def __init__(self, lane: Lane, preset: Preset):
        super().__init__(lane, preset)
        # Forces on all bodies in the next step; those along the motion are the loop's.
        self._pushing = np.zeros((2 * lane.chain.cells, 3))

    def _begin(self, motion: FloatArray) -> Step:
        self._system, bodies = self._new_bodies(motion)
        self._set_normal_load(self._chain.normal_force)
        size, pushes, still = len(bodies), [body.add_force_torque for body in bodies], np.zeros(3)
        advance, read, forces = self._system.step, self._system.pack, self._pushing

        def step(force: FloatArray) -> None:
            forces[:, 0] = force
            for push, body_force in zip(pushes, forces, strict=True):
                push(body_force, still)
            advance()
            # Of every body its orientation, place, velocity and rotation: 4, 3, 3 and 3 numbers.
            rows = np.frombuffer(read(), np.float32).reshape(size, 13)
            motion[:size] = rows[:, 4]
            motion[size:] = rows[:, 7]

        return step

    def _new_bodies(self, motion: FloatArray) -> tuple[Any, list[Any]]:
        """Make the scene with this motion; give its system and the bodies, outer masses first."""
        sapien, (scene, system) = import_sapien(), self._new_scene()
        cells, box, spacing = self._chain.cells, self._sizes.box, self._sizes.spacing
        positions, velocities = motion.reshape(2, -1)
        masses = np.concatenate([self._chain.outer_mass, self._chain.inner_mass])
        bodies = []
        for index, mass in enumerate(masses):
            cell, inner = index % cells, index >= cells
            body = sapien.physx.PhysxRigidDynamicComponent()
            body.attach(self._shape(cell, inner))
            body.set_mass(mass)
            body.set_inertia(np.full(3, self._preset["inertia"]))
            # Friction acts in the plane of a contact, and the row is held along it by the outer masses.
            body.set_locked_motion_axes([False, not inner, False, True, True, True])
            body.set_angular_damping(0.0)
            entity = sapien.Entity()
            entity.add_component(body)
            entity.set_pose(sapien.Pose([positions[index], cell * spacing, box if inner else -box]))
            scene.add_entity(entity)
            body.set_linear_velocity([velocities[index], 0.0, 0.0])
            bodies.append(body)
        return system, bodies

    def _shape(self, cell: int, inner: bool) -> Any:
        """Give the sphere or the plate of a cell."""
        physx, box = import_sapien().physx, self._sizes.box
        friction = self._chain.friction_coefficient[cell]
        material = physx.PhysxMaterial(self.lane.static_ratio * friction, friction, 0.0)
        if inner:
            return physx.PhysxCollisionShapeSphere(box, material)
        length = self._sizes.plate
        return physx.PhysxCollisionShapeBox([length, box, box], material)

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        self._pushing[:, 2] = np.concatenate([normal_load, -normal_load])

    def _contacts(self) -> FloatArray:
        """Read nothing: friction is in the motion."""
        return np.empty(0)

    def _contact_forces(
        self, read: FloatArray, motions: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        cells, units = self._chain.cells, self._units
        outer, inner = np.split(motions[:, 2 * cells :], 2, axis=1)
        rate = self._chain.inner_mass / self._time_step
        force = motions[:-1] @ self._forces[cells:].T
        friction = rate * np.diff(inner, axis=0) - force
        bound = self._chain.friction_coefficient * given / units.force
        speed = np.maximum(np.abs(outer), np.abs(inner))
        rounding = ROUNDINGS * SINGLE * (rate * (speed[:-1] + speed[1:]) + np.abs(force))
        at_bound = np.abs(friction) > bound - rounding
        if self.lane.static_ratio > 1:  # what holds may be anywhere up to another bound
            at_bound &= np.abs(friction) < bound + rounding
        return np.where(at_bound, np.copysign(bound, friction), friction) * units.force, given
