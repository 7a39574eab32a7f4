"""Coordinates in which the heavier mass of every cell carries the lighter one.

The algebra of an articulation adds what a joint carries to the mass that carries it, and takes it away again. In single
precision a carrier is lost beside a mass that is thousands of times as heavy; nothing is lost the other way round.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from engines.shared.coordinates import ChainCoordinates, generalised_force_matrix
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.validation import FloatArray


@dataclass(frozen=True)
class CarriedCoordinates:
    """(a_i, b_i - a_i): joints on the ground carry the heavier mass a_i of every cell, and this the other one, b_i.

    Parameters
    ----------
    inner_carries
        Cells whose inner mass is the heavier one, shape (n,).
    """

    inner_carries: NDArray[np.bool_]

    @classmethod
    def of_chain(cls, chain: Chain) -> Self:
        """Choose what carries."""
        return cls(chain.inner_mass > chain.outer_mass)

    @property
    def sign(self) -> FloatArray:
        """Friction on the inner mass over that on the carried one, shape (n,)."""
        return np.where(self.inner_carries, -1.0, 1.0)

    def of(self, absolute: FloatArray) -> FloatArray:
        """Turn (u, v) into these coordinates, shape (..., 2n)."""
        return ChainCoordinates.CELLS.of(self.exchanged(absolute))

    def absolute(self, coordinates: FloatArray) -> FloatArray:
        """Turn these coordinates into (u, v), shape (..., 2n)."""
        return self.exchanged(ChainCoordinates.CELLS.absolute(coordinates))

    def exchanged(self, values: FloatArray) -> FloatArray:
        """Turn what outer and inner masses have into what carriers and carried masses have, and back."""
        outer, inner = np.split(values, 2, axis=-1)
        first, second = np.where(self.inner_carries, (inner, outer), (outer, inner))
        return np.concatenate([first, second], axis=-1)

    def force_matrix(self, chain: Chain) -> FloatArray:
        """Give the matrix that turns coordinates and velocities into generalised forces, shape (2n, 4n)."""
        return generalised_force_matrix(chain, self.absolute(np.eye(2 * chain.cells)).T)

    @property
    def loaded(self) -> int | slice:
        """Coordinates on which a force on the first outer mass acts: on both of the cell where it is carried."""
        cells = self.inner_carries.size
        return slice(0, cells + 1, cells) if self.inner_carries[0] else 0
