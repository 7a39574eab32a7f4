"""Box2D's contact formulation: in every cell a box, the inner mass, pressed on a plate, the outer one."""

from functools import partial
from typing import Any

import numpy as np

from multibody_xval.engines.box2d.joint import FARTHEST, Box2DLane, finer_units, import_box2d
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.force_loop import PressedLane, Step
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray

GAP_OVER_SLOP = 3.0
"""Distance of the outlines of a box and its plate over Box2D's linearSlop: each has a skin of twice that, and skins
overlap by as much as Box2D leaves alone."""

CLEARANCE_OVER_SLOP = 8.0
"""What cells stand further apart than boxes need without skins, over linearSlop: one gap, and the skins of a box and
of the plate above it. Without it small boxes touch the cell beside theirs."""


class Box2DContactLane(PressedLane, Box2DLane):
    """One chain with a box on a plate in every cell."""

    units_of = staticmethod(partial(finer_units, length=2.0**4))
    """Boxes are some tenths of a unit, where Box2D rounds corners by a hundredth."""

    def __init__(self, lane: Lane, preset: Preset):
        super().__init__(lane, preset)
        slop = import_box2d().b2_linearSlop
        cells = (self._sizes.spacing + CLEARANCE_OVER_SLOP * slop) * np.arange(lane.chain.cells)
        self._heights = np.concatenate([cells, cells + GAP_OVER_SLOP * slop])
        self._pressing = np.concatenate([self._chain.normal_force, -self._chain.normal_force])

    def _hold(self, world: Any, outer: list[Any], inner: list[Any]) -> None:
        shapes = [import_box2d().b2PolygonShape(vertices=vertices) for vertices in self._sizes.outlines]
        for cell, friction in enumerate(self._chain.friction_coefficient.tolist()):
            # Box2D takes the root of the product of the coefficients of the two.
            for body, shape in zip((outer[cell], inner[cell]), shapes, strict=True):
                body.CreateFixture(shape=shape, density=1.0, friction=friction, restitution=0.0)
                body.userData = cell

    def _begin(self, motion: FloatArray) -> Step:
        self._touching = 0
        self._points: list[tuple[int, Any]] = []
        return super()._begin(motion)

    def _contacts(self) -> FloatArray:
        if self._world.contactCount != self._touching:
            # Points of contact refer to Box2D's memory, and hold what is there as long as their contact is.
            self._touching = self._world.contactCount
            self._points = [
                (contact.fixtureA.body.userData, point)
                for contact in self._world.contacts
                for point in contact.manifold.points
            ]
        impulses = np.zeros((2, self._chain.cells))
        for cell, point in self._points:
            impulses[0, cell] += point.tangentImpulse
            impulses[1, cell] += point.normalImpulse
        return impulses / self._time_step

    def _state(self, motions: FloatArray) -> State:
        end = super()._state(motions)
        largest, limit = float(np.max(np.abs(motions[-1, motions.shape[1] // 2 :]))), 0.999 * FARTHEST / self._time_step
        if largest > limit:
            velocity = self._units.velocity
            raise RuntimeError(
                f"a mass moves at {largest * velocity:g} m/s; Box2D cuts off at {limit * velocity:g} m/s"
            )
        return end
