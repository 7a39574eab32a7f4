"""Contact formulation under explicit forces: in every cell a box, the inner mass, pressed on a plate, the outer one.

Outer and inner mass press each other with λ_N, an internal pair of forces across the motion, so that nothing
needs a guide. Cells stand side by side across the motion.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from multibody_xval.engines.shared.units import Units, power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

BOX = 4.0
"""Half of a box's edge over the displacement scale of the drive."""

PLATE = 2.0**14
"""Half of a plate's length over the displacement scale; beyond, boxes would fall off."""

SPACING = 4 * BOX
"""Distance of neighbouring cells over the displacement scale, across the motion."""


@dataclass(frozen=True)
class PressedBoxes:
    """Sizes and places of the boxes and plates of a lane, in an engine's units."""

    box: float
    """Half of a box's edge, and half of a plate's thickness."""
    plate: float
    """Half of a plate's length."""
    spacing: float
    """Distance of neighbouring cells."""

    @classmethod
    def of(cls, lane: Lane, units: Units, plate: float = PLATE, spacing: float = SPACING) -> Self:
        """Size them for a lane, with powers of two, so that distances of contacts are exact."""
        scale = power_of_two(lane.drive.displacement_scale(lane.chain)) / units.length
        return cls(BOX * scale, plate * scale, spacing * scale)

    @property
    def outlines(self) -> tuple[list[tuple[float, float]], ...]:
        """Corners in the plane of a plate below the height zero, and of a box above it."""
        box, plate = self.box, self.plate
        return (
            [(-plate, -box), (plate, -box), (plate, 0.0), (-plate, 0.0)],
            [(-box, 0.0), (box, 0.0), (box, 2 * box), (-box, 2 * box)],
        )

    def check_reach(self, positions: FloatArray, units: Units) -> None:
        """Refuse a motion that ends [m] with a box off its plate: there it would feel no friction."""
        outer, inner = np.split(positions, 2)
        largest, reach = float(np.max(np.abs(inner - outer))), (self.plate - self.box) * units.length
        if not largest < reach:
            raise RuntimeError(f"an inner mass is {largest:g} m from its outer one; its plate ends at {reach:g} m")
