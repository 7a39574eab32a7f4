"""Lanes of SAPIEN, and its joint formulation: drives of bounded force that hold slip velocities at zero."""

import functools
import importlib
import warnings
from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.coordinates import CarriedCoordinates, friction_of_joints
from multibody_xval.engines.shared.force_loop import ExplicitForcesLane, Step
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray


@functools.cache
def import_sapien() -> Any:
    """Import SAPIEN, without its warnings that there is nothing to draw with, and with what it logs left to errors."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sapien = importlib.import_module("sapien")
    sapien.set_log_level("error")
    return sapien


def new_scene(preset: Preset, time_step: float, gravity: float = 0.0, sleeping: bool = False) -> tuple[Any, Any]:
    """Make an empty scene; gives it, and the system that steps it.

    Bodies do not keep their scene: without it they are gone, and to use them ends the process.
    """
    sapien = import_sapien()
    physx = sapien.physx
    # Configurations are global, and copied by what is made next.
    physx.set_scene_config(gravity=np.array([0.0, 0.0, -gravity], np.float32), enable_tgs=preset["enable_tgs"])
    physx.set_body_config(
        solver_position_iterations=preset["solver_position_iterations"],
        solver_velocity_iterations=preset["solver_velocity_iterations"],
        sleep_threshold=physx.PhysxBodyConfig().sleep_threshold if sleeping else 0.0,
    )
    system = physx.PhysxCpuSystem()
    system.timestep = time_step
    return sapien.Scene([system]), system


class SapienLane(ExplicitForcesLane):
    """One chain; a run makes its scene anew, for contacts keep where they stuck."""

    def _new_scene(self) -> tuple[Any, Any]:
        self._scene, system = new_scene(self._preset, self._time_step)
        return self._scene, system


class SapienJointLane(SapienLane):
    """One chain as one articulation: the heavier mass of a cell slides on its root, the other one on this."""

    coordinates: CarriedCoordinates

    def __init__(self, lane: Lane, preset: Preset):
        self.coordinates = CarriedCoordinates.of_chain(lane.chain)
        super().__init__(lane, preset)

    def _begin(self, motion: FloatArray) -> Step:
        self._system, articulation = self._new_articulation()
        # Links are in an order of PhysX's own.
        names = [joint.name for joint in articulation.get_active_joints()]
        order = np.array([names.index(str(index)) for index in range(len(names))])
        for values, put in zip(motion.reshape(2, -1), (articulation.set_qpos, articulation.set_qvel), strict=True):
            put(values[np.argsort(order)])
        joints = articulation.get_active_joints()
        self._drives = [joints[index] for index in order[self._chain.cells :]]
        # The root is the first link, and has no joint that moves.
        self._forces_of_links, self._carried = (
            articulation.get_link_incoming_joint_forces,
            order[self._chain.cells :] + 1,
        )
        advance, load, size = self._system.step, articulation.set_qf, len(names)
        native = np.empty(size)

        def step(force: FloatArray) -> None:
            self._applied = force
            native[order] = force
            load(native)
            advance()
            position, velocity = articulation.qpos, articulation.qvel
            # A motion that has diverged stays where its numbers were finite last.
            if np.isfinite(position).all():
                motion[:size] = position[order]
                motion[size:] = velocity[order]

        return step

    def _contacts(self) -> FloatArray:
        """Read what acts along the joints of carried masses, and give what was applied with it, shape (3n,)."""
        return np.concatenate([self._forces_of_links()[self._carried, 0], self._applied])

    def _contact_forces(
        self, read: FloatArray, motions: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        bound = self._chain.friction_coefficient * given / self._units.force
        along, applied = np.split(read, [self._chain.cells], axis=1)
        friction = friction_of_joints(along, applied, bound, self._chain)
        return self.coordinates.sign * friction * self._units.force, given

    def _new_articulation(self) -> tuple[Any, Any]:
        """Make the articulation at rest, in a scene of its own; gives the scene's system too."""
        sapien, (scene, system) = import_sapien(), self._new_scene()
        builder, cells = scene.create_articulation_builder(), self._chain.cells
        links = [builder.create_link_builder()]
        own = np.concatenate([self._chain.outer_mass, self._chain.inner_mass])
        masses = [1.0, *self.coordinates.exchanged(own)]
        here, inertia = sapien.Pose(), np.ones(3)
        links[0].set_mass_and_inertia(masses[0], here, inertia)
        for index, mass in enumerate(masses[1:]):
            # The root carries the heavier masses of all cells, and these the others.
            link = builder.create_link_builder(links[max(0, index + 1 - cells)])
            link.set_joint_name(str(index))
            link.set_joint_properties("prismatic", [[-np.inf, np.inf]], here, here, 0.0, 0.0)
            link.set_mass_and_inertia(mass, here, inertia)
            links.append(link)
        articulation = builder.build(fix_root_link=True)
        self._set_joints(articulation)
        return system, articulation

    def _set_joints(self, articulation: Any) -> None:
        """Set what the presets say of links and joints."""
        preset, cells = self._preset, self._chain.cells
        for link in articulation.get_links():
            link.set_linear_damping(preset["linear damping"])
            link.set_max_linear_velocity(preset["max linear velocity"])
        for joint in articulation.get_active_joints():
            # What set_joint_properties takes as friction and damping has no part in the motion.
            joint.set_friction(preset["joint friction"])
            joint.set_armature(np.zeros(1))
            joint.set_max_velocity(preset["max joint velocity"])
            cell = int(joint.name) - cells
            if cell >= 0:
                self._bound(joint, self._chain.friction_bound[cell])

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        for drive, bound in zip(self._drives, self._chain.friction_coefficient * normal_load, strict=True):
            self._bound(drive, bound)

    def _bound(self, drive: Any, bound: float) -> None:
        drive.set_drive_properties(0.0, self._preset["drive damping"], bound, "force")
