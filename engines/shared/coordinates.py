"""Coordinates in which an engine moves the chain, and the forces of springs and dashpots in them."""

from enum import Enum

import numpy as np

from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.validation import FloatArray


class ChainCoordinates(Enum):
    """What a vector of 2n coordinates holds; velocities likewise.

    Every map is a chain of single additions, so that it gives the same bits for one row and for many.
    """

    ABSOLUTE = "(u_i, v_i): bodies of their own"
    CELLS = "(u_i, v_i - u_i): joints on the ground carry the outer masses, and these the inner ones"
    PAIRS = "(u_1, v_1 - u_1, u_2, ...): the same, cell by cell"
    ROW = "(u_i - u_(i-1), v_i - u_i): every outer mass has its joint on its left neighbour"

    @property
    def loaded(self) -> int:
        """Coordinate on which a force on the first outer mass acts, and it alone."""
        return 0

    def of(self, absolute: FloatArray) -> FloatArray:
        """Turn (u, v) into these coordinates, shape (..., 2n)."""
        outer, inner = np.split(absolute, 2, axis=-1)
        first, second = outer, inner
        if self is not ChainCoordinates.ABSOLUTE:
            second = inner - outer
        if self is ChainCoordinates.ROW:
            first = np.diff(outer, axis=-1, prepend=0.0)
        if self is ChainCoordinates.PAIRS:
            return np.stack([first, second], axis=-1).reshape(absolute.shape)
        return np.concatenate([first, second], axis=-1)

    def absolute(self, coordinates: FloatArray) -> FloatArray:
        """Turn these coordinates into (u, v), shape (..., 2n)."""
        outer, inner = np.split(coordinates, 2, axis=-1)
        if self is ChainCoordinates.PAIRS:
            outer, inner = coordinates[..., 0::2], coordinates[..., 1::2]
        if self is ChainCoordinates.ROW:
            outer = np.cumsum(outer, axis=-1)
        if self is not ChainCoordinates.ABSOLUTE:
            inner = outer + inner
        return np.concatenate([outer, inner], axis=-1)

    def force_matrix(self, chain: Chain) -> FloatArray:
        """Give the matrix that turns coordinates and velocities into generalised forces, shape (2n, 4n).

        The force of a joint acts on its own mass and back on the one that carries it.
        """
        return generalised_force_matrix(chain, self.absolute(np.eye(2 * chain.cells)).T)


def generalised_force_matrix(chain: Chain, absolute: FloatArray) -> FloatArray:
    """Give the matrix that turns coordinates and velocities into generalised forces, shape (2n, 4n).

    Parameters
    ----------
    chain
        The chain.
    absolute
        Absolute positions for one unit of each coordinate, one in a column, shape (2n, 2n).
    """
    stiffness = absolute.T @ chain.stiffness_matrix @ absolute
    damping = absolute.T @ chain.damping_matrix @ absolute
    return -np.hstack([stiffness, damping])
