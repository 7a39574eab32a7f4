"""pymunk's contact formulation: in every cell a box, the inner mass, pressed on a plate, the outer one."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.pymunk.simulation import PymunkSimulation, World
from multibody_xval.engines.shared.box_geometry import PressedBoxes
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

DEPTH = 2.0**-7
"""Depth of a box in its plate over half its edge: at zero, round-off would lose a contact now and then."""


class PymunkBoxes(PymunkSimulation):
    """Lanes with a box on a plate in every cell, side by side across the motion."""

    def __init__(self, lanes: Sequence[Lane], preset: Preset):
        super().__init__(lanes, preset)
        self._sizes = [PressedBoxes.of(lane, units) for lane, units in zip(lanes, self._units, strict=True)]
        for index, (sizes, chain) in enumerate(zip(self._sizes, self._chains, strict=True)):
            cells = sizes.spacing * np.arange(index * self._cells, (index + 1) * self._cells)
            self._heights[index] = np.concatenate([cells, cells - DEPTH * sizes.box])
            self._pressing[index] = np.concatenate([chain.normal_force, -chain.normal_force])

    def _hold(self, space: Any, chain: Chain, outer: list[Any], inner: list[Any]) -> list[Any]:
        import pymunk

        sizes = self._sizes[len(space.bodies) // (2 * self._cells) - 1]
        for *pair, friction in zip(outer, inner, chain.friction_coefficient.tolist(), strict=True):
            # Chipmunk multiplies the coefficients of the two shapes.
            for body, vertices, coefficient in zip(pair, sizes.outlines, (1.0, friction), strict=True):
                shape = pymunk.Poly(body, vertices)
                shape.friction = coefficient
                space.add(shape)
        return []

    def _reader(self, world: World) -> Callable[[], FloatArray]:
        from pymunk import batch

        # Of each pair of bodies that touch, pymunk gives the impulse on the first and the normal away from it.
        fields = batch.ArbiterFields
        pairs, buffer = fields.BODY_A_ID | fields.TOTAL_IMPULSE | fields.NORMAL, batch.Buffer()
        cells, space = self._cells, world.space
        places = {body.id: index // (2 * cells) * cells + index % cells for index, body in enumerate(world.bodies)}

        def contacts() -> FloatArray:
            buffer.clear()
            batch.get_space_arbiters(space, pairs, buffer)
            impulses = np.zeros((len(self.lanes) * cells, 2))
            touching = [places[body] for body in memoryview(buffer.int_buf()).cast("P").tolist()]
            values = np.frombuffer(buffer.float_buf()).reshape(-1, 4)
            # The normal points down from the box, and up from the plate.
            impulses[touching] = values[:, :2] * -values[:, 3:]
            return impulses.T.reshape(2, len(self.lanes), cells)

        return contacts

    def _contact_forces(self, read: list[Any], motions: FloatArray, given: FloatArray) -> tuple[FloatArray, FloatArray]:
        friction, normal = np.stack(read, axis=1) / self._time_step
        return friction, normal

    def _check_ends(self, positions: FloatArray) -> None:
        for sizes, row, units in zip(self._sizes, positions, self._units, strict=True):
            sizes.check_reach(row, units)
