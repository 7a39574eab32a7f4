"""DART's contact formulation: in every cell a box, or a sphere, the inner mass, pressed on a plate, the outer one."""

from typing import Any

import numpy as np

from multibody_xval.engines.dart.joint import new_world
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.coordinates import ChainCoordinates
from multibody_xval.engines.shared.force_loop import PressedLane, Step
from reference_lcp.chain.simulation import Lane
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

DEPTH = 2.0**-40
"""Depth of a box in its plate over half its edge: DART pushes boxes out by a hundredth of it in a step."""

LEAST_COEFFICIENT = 1e-3
"""DART takes contacts with a coefficient of friction up to this for frictionless."""


class DartContactLane(PressedLane):
    """One chain with a skeleton a cell: a plate that slides along x, and on it a body that is free in the plane.

    A run makes its world anew, so that nothing is left of earlier runs. Cells whose friction is bounded by zero have
    no contact.
    """

    coordinates = ChainCoordinates.CELLS

    def __init__(self, lane: Lane, preset: Preset):
        rubbing = lane.chain.friction_coefficient[lane.chain.friction_bound > 0]
        least = float(np.min(rubbing, initial=1.0))
        if least <= LEAST_COEFFICIENT:
            raise ParameterError(
                f"friction_coefficient = {least:g} is frictionless for DART; allowed: more than {LEAST_COEFFICIENT:g}"
            )
        super().__init__(lane, preset)
        self._rubbing = self._chain.friction_bound > 0

    def _begin(self, motion: FloatArray) -> Step:
        self._world, skeletons = self._new_world()
        # Degrees of freedom of a skeleton: along, relative to the plate, and across.
        along = [skeleton.getDof(degree) for degree in (0, 1) for skeleton in skeletons]
        for degree, place, rate in zip(along, *motion.reshape(2, -1).tolist(), strict=True):
            degree.setPosition(place)
            degree.setVelocity(rate)
        self._aside = [skeleton.getDof(2) for skeleton in skeletons]
        for degree, height, rate in zip(self._aside, *self._across.tolist(), strict=True):
            degree.setPosition(height)
            degree.setVelocity(rate)
        # Forces stay, for a step with this argument does not clear them.
        self._set_normal_load(self._chain.normal_force)
        # Numbers go in and out in a fifth of the time of short arrays.
        loads = [degree.setForce for degree in along]
        reads = [degree.getPosition for degree in along] + [degree.getVelocity for degree in along]
        advance = self._world.step

        def step(force: FloatArray) -> None:
            for load, value in zip(loads, force.tolist(), strict=True):
                load(value)
            advance(False)
            motion[:] = [read() for read in reads]

        return step

    def _contacts(self) -> FloatArray:
        """Read friction and normal force on every inner mass, shape (2, n): sums over the points of a contact."""
        contacts = self._world.getLastCollisionResult().getContacts()
        if not contacts:
            return np.zeros((2, self._chain.cells))
        forces = np.array([contact.force for contact in contacts])
        points = np.array([contact.point for contact in contacts])
        cells, count = np.rint(points[:, 2] / self._sizes.spacing).astype(np.intp), self._chain.cells
        friction, normal = forces[:, 0], forces[:, 1]
        # The force on either mass; the one that points away from the plate is on the inner.
        sign = np.where(normal > 0, 1.0, -1.0)
        return np.array([np.bincount(cells, sign * part, count) for part in (friction, normal)])

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        pressing = np.where(self._rubbing, -normal_load, 0.0)
        for degree, value in zip(self._aside, pressing.tolist(), strict=True):
            degree.setForce(value)

    def _gaps(self) -> FloatArray:
        # At the coordinate zero a body is in its plate by less than anything that is measured.
        degrees = self._aside
        return np.array([[degree.getPosition() for degree in degrees], [degree.getVelocity() for degree in degrees]])

    def _contact_forces(
        self, read: FloatArray, motions: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        friction, normal = super()._contact_forces(read, motions, given)
        return friction, np.where(self._rubbing, normal, given)

    def _new_world(self) -> tuple[Any, list[Any]]:
        """Make a world with a skeleton a cell, a skeleton's bodies being allowed to touch each other."""
        import dartpy

        world = new_world(self._time_step, self._preset["deactivation"])
        sizes, chain, skeletons = self._sizes, self._chain, []
        depth = DEPTH * sizes.box
        for cell in range(chain.cells):
            skeleton = dartpy.dynamics.Skeleton()
            skeleton.enableSelfCollisionCheck()
            skeleton.enableAdjacentBodyCheck()
            below, plate = skeleton.createPrismaticJointAndBodyNodePair()
            above, body = skeleton.createTranslationalJoint2DAndBodyNodePair(plate)
            below.setAxis([1.0, 0.0, 0.0])
            rest = [0.0, 2 * sizes.box - depth, 0.0]
            for joint, place in ((below, [0.0, 0.0, cell * sizes.spacing]), (above, rest)):
                before = dartpy.math.Isometry3()
                before.set_translation(place)
                joint.setTransformFromParentBodyNode(before)
            plate.setMass(chain.outer_mass[cell])
            body.setMass(chain.inner_mass[cell])
            if self._rubbing[cell]:
                self._add_shapes(plate, body, float(chain.friction_coefficient[cell]))
            world.addSkeleton(skeleton)
            skeletons.append(skeleton)
        return world, skeletons

    def _add_shapes(self, plate: Any, body: Any, coefficient: float) -> None:
        """Add the shapes that touch; DART takes the smaller coefficient of the two."""
        from dartpy import dynamics

        edge, length = 2 * self._sizes.box, 2 * self._sizes.plate
        box = self._preset["shape"] == "box"
        shape = dynamics.BoxShape([edge, edge, edge]) if box else dynamics.SphereShape(self._sizes.box)
        for owner, solid in ((plate, dynamics.BoxShape([length, edge, edge])), (body, shape)):
            node = owner.createShapeNode(solid)
            node.createCollisionAspect()
            surface = node.createDynamicsAspect()
            surface.setFrictionCoeff(coefficient)
            surface.setRestitutionCoeff(0.0)
