"""pymunk's contact formulation: in every cell a box, the inner mass, pressed on a plate, the outer one."""

from typing import Any

import numpy as np

from engines.explicit_forces import Step
from engines.interface import Option, Preset
from engines.pressed_boxes import PressedBoxes
from engines.pymunk_bodies import PymunkLane
from reference_lcp.simulation import Lane
from reference_lcp.trajectory import State
from reference_lcp.validation import FloatArray

CONTACT_TUNED = Preset(
    "Boxes pressed on plates; springs, dashpots and drive as forces at the start of equation (5)'s step.",
    {
        "units": Option("lane", "SI", "Depths of contacts are below the slop, and no number is near Chipmunk's own."),
        "springs": Option("forces", "damped springs", "At the start of the step, as in equation (5)."),
        "positions": Option(
            "of the step before", "as they are", "Chipmunk advances positions first: forces are evaluated after that."
        ),
        "iterations": Option(1, 10, "A contact's normal force is found before its friction, and no other touches it."),
        "collision_slop": Option(0.1, 0.1, "pymunk's own; boxes are less deep in their plates, and not pushed out."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
)

CONTACT_DEFAULT = Preset(
    "The same boxes and pymunk's damped springs, in SI units.",
    {
        "units": Option("SI", "SI", "The numbers of the chain as they are."),
        "springs": Option("damped springs", "damped springs", "pymunk's own, with dashpots that are implicit."),
        "positions": Option("as they are", "as they are", "What Body.position and Body.velocity hold."),
        "iterations": Option(10, 10, "pymunk's own."),
        "collision_slop": Option(0.1, 0.1, "pymunk's own."),
    },
    split_tolerance=1e-12,
)

DEPTH = 2.0**-7
"""Depth of a box in its plate over half its edge: at zero, round-off would lose a contact now and then."""


class PymunkContactLane(PymunkLane):
    """One chain with a box on a plate in every cell."""

    def __init__(self, lane: Lane, preset: Preset):
        """Take the lane's parameters in its units."""
        super().__init__(lane, preset)
        self._sizes = PressedBoxes.of(lane, self._units)
        cells = self._sizes.spacing * np.arange(lane.chain.cells)
        self._heights = np.concatenate([cells, cells - DEPTH * self._sizes.box])
        self._pressing = np.concatenate([self._chain.normal_force, -self._chain.normal_force])

    def _hold(self, space: Any, outer: list[Any], inner: list[Any]) -> None:
        import pymunk

        box, plate = self._sizes.box, self._sizes.plate
        for below, above, friction in zip(outer, inner, self._chain.friction_coefficient, strict=True):
            shapes = (
                pymunk.Poly(below, [(-plate, -box), (plate, -box), (plate, 0.0), (-plate, 0.0)]),
                pymunk.Poly(above, [(-box, 0.0), (box, 0.0), (box, 2 * box), (-box, 2 * box)]),
            )
            # Chipmunk multiplies the coefficients of the two shapes.
            shapes[0].friction, shapes[1].friction = 1.0, float(friction)
            space.add(*shapes)

    def _begin(self, motion: FloatArray) -> Step:
        from pymunk import batch

        step = super()._begin(motion)
        # Of each pair of bodies that touch, pymunk tells the impulse on the first and the normal away from it.
        fields = batch.ArbiterFields
        self._cells = {body.id: index % self._chain.cells for index, body in enumerate(self._bodies)}
        self._pairs = fields.BODY_A_ID | fields.TOTAL_IMPULSE | fields.NORMAL
        self._buffer = batch.Buffer()
        return step

    def _contacts(self) -> FloatArray:
        """Read friction and normal impulse of every cell, shape (2, n)."""
        from pymunk import batch

        buffer = self._buffer
        buffer.clear()
        batch.get_space_arbiters(self._space, self._pairs, buffer)
        found = np.zeros((self._chain.cells, 2))
        places = [self._cells[body] for body in memoryview(buffer.int_buf()).cast("P").tolist()]
        values = np.frombuffer(buffer.float_buf()).reshape(-1, 4)
        # The normal points down from the box, and up from the plate.
        found[places] = values[:, :2] * -values[:, 3:]
        return found.T

    def _contact_forces(self, read: FloatArray, motions: FloatArray) -> tuple[FloatArray, FloatArray]:
        forces = read / self._time_step * self._units.force
        return forces[:, 0], forces[:, 1]

    def _state(self, motions: FloatArray) -> State:
        end = super()._state(motions)
        self._sizes.check_reach(end, self._units)
        return end
