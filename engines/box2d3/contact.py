"""Box2D 3's contact formulation: in every cell a disc, the inner mass, pressed on a plate, the outer one."""

import math
from typing import Any

import numpy as np

from multibody_xval.engines.box2d3.joint import Box2DLane
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.shared.force_loop import PressedLane
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

STIFFEST = 0.125
"""Frequency of contacts over that of substeps, at most: Box2D's own bound."""

ROUNDINGS = 4
"""Of the velocities and forces in each substep, that friction is read from: with fewer, slip is read as stick."""


class Box2DContactLane(PressedLane, Box2DLane):
    """One chain with a disc on a plate in every cell, all at the same place: cells do not touch each other.

    A contact is a spring across, whose force bounds friction before it is corrected. Discs begin as deep as springs
    hold them in equilibrium, so that this force is λ_N; two points, as of a box, would share it unevenly.
    """

    def __init__(self, lane: Lane, preset: Preset):
        super().__init__(lane, preset)
        chain = self._chain
        hertz = min(preset["contact_hertz"], STIFFEST * preset["sub_step_count"] / self._time_step)
        depth = chain.normal_force * (1 / chain.outer_mass + 1 / chain.inner_mass) / (2 * math.pi * hertz) ** 2
        self._heights[chain.cells :] = -depth
        self._pressing = np.concatenate([chain.normal_force, -chain.normal_force])

    def _hold(self, world: Any, outer: list[Any], inner: list[Any]) -> None:
        import pyb2d3

        box, plate = self._sizes.box, self._sizes.plate
        shapes = pyb2d3.box(plate, box / 2, center=(0.0, -box / 2)), pyb2d3.circle((0.0, box), box)
        for cell, friction in enumerate(self._chain.friction_coefficient.tolist()):
            # Box2D takes the root of the product of the coefficients of the two.
            surface = pyb2d3.surface_material(friction=friction, restitution=0.0)
            # Shapes of the same group touch, and no others.
            own = pyb2d3.make_filter(mask_bits=0, group_index=cell + 1)
            for body, shape in zip((outer[cell], inner[cell]), shapes, strict=True):
                body.create_shape(pyb2d3.shape_def(material=surface, filter=own), shape)

    def _contacts(self) -> list[float]:
        """Read the velocities of discs across: pyb2d3 gives no impulses."""
        return self._velocities[self._chain.cells :, 1].tolist()

    def _contact_forces(
        self, read: FloatArray, motions: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Take what changed the momentum of discs beside the forces on them.

        Friction counts as its bound where it is as near to it as single precision can tell.
        """
        chain, cells = self._chain, self._chain.cells
        inertia, bound = chain.inner_mass / self._time_step, chain.friction_coefficient * chain.normal_force
        normal = chain.normal_force + inertia * np.diff(read, axis=0, prepend=0.0)
        along = motions.astype(np.float32)[:, -cells:].astype(np.float64)
        friction = inertia * np.diff(along, axis=0) - motions[:-1] @ self._forces[cells:].T
        fastest = np.maximum(np.abs(along[1:]), np.abs(along[:-1]))
        roundings = ROUNDINGS * self._preset["sub_step_count"] * SINGLE
        full = np.abs(friction) > bound - roundings * (inertia * fastest + bound)
        friction = np.where(full, np.copysign(bound, friction), friction)
        return friction * self._units.force, normal * self._units.force
