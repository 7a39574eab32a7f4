"""Coordinates of engines, from absolute ones and back, and the friction along them."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.interface.tolerances import SINGLE
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.validation import FloatArray


class _Coordinates:
    absolute: Callable[..., FloatArray]

    def count(self, cells: int) -> int:
        """Give how many coordinates so many cells have."""
        return 2 * cells

    def force_matrix(self, chain: Chain) -> FloatArray:
        """Give the matrix that turns coordinates and velocities into generalised forces, shape (count, 2 count).

        The force of a joint acts on its own mass and back on the one that carries it.
        """
        # A column has the absolute positions for one unit of a coordinate.
        columns = self.absolute(np.eye(self.count(chain.cells))).T
        return -np.hstack([columns.T @ matrix @ columns for matrix in (chain.stiffness_matrix, chain.damping_matrix)])


class ChainCoordinates(_Coordinates, Enum):
    """What a vector of 2n coordinates holds; velocities likewise.

    Every map is a chain of single additions, so that it gives the same bits for one row and for many.
    """

    ABSOLUTE = "(u_i, v_i): bodies of their own"
    CELLS = "(u_i, v_i - u_i): joints on the ground carry the outer masses, and these the inner ones"
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
        return np.concatenate([first, second], axis=-1)

    def absolute(self, coordinates: FloatArray) -> FloatArray:
        """Turn these coordinates into (u, v), shape (..., 2n)."""
        outer, inner = np.split(coordinates, 2, axis=-1)
        if self is ChainCoordinates.ROW:
            outer = np.cumsum(outer, axis=-1)
        if self is not ChainCoordinates.ABSOLUTE:
            inner = outer + inner
        return np.concatenate([outer, inner], axis=-1)


@dataclass(frozen=True)
class CarriedCoordinates(_Coordinates):
    """(a_i, b_i - a_i): joints on the ground carry the heavier mass a_i of every cell, and this the other one, b_i.

    `inner_carries`, shape (n,), tells the cells whose inner mass is the heavier one.
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

    @property
    def loaded(self) -> int | slice:
        """Coordinates on which a force on the first outer mass acts: on both of the cell where it is carried."""
        cells = self.inner_carries.size
        return slice(0, cells + 1, cells) if self.inner_carries[0] else 0


@dataclass(frozen=True)
class JointCoordinates(_Coordinates):
    """(u_1, v_1 - u_1, ..., u_2, ...), so many `joints` a cell; what goes across the row has no forces of the chain."""

    joints: int = 2
    loaded: ClassVar[int] = 0

    def count(self, cells: int) -> int:
        """Give how many coordinates so many cells have."""
        return self.joints * cells

    def of(self, absolute: FloatArray) -> FloatArray:
        """Turn (u, v), shape (..., 2n), into these coordinates; velocities likewise."""
        outer, inner = np.split(absolute, 2, axis=-1)
        coordinates = np.zeros((*outer.shape, self.joints))
        coordinates[..., 0], coordinates[..., 1] = outer, inner - outer
        return coordinates.reshape(*outer.shape[:-1], -1)

    def absolute(self, coordinates: FloatArray) -> FloatArray:
        """Turn these coordinates into (u, v), shape (..., 2n)."""
        outer, relative = coordinates[..., 0 :: self.joints], coordinates[..., 1 :: self.joints]
        return np.concatenate([outer, outer + relative], axis=-1)


ROUNDINGS = 16
"""Of the forces that make up the one along a joint. Measured are 4 where a step, or each of ten substeps, has one
impulse, and 10 where those of 32 substeps are added."""


def friction_of_joints(along: FloatArray, applied: FloatArray, bound: FloatArray, chain: Chain) -> FloatArray:
    """Give the friction on the carried masses of `CarriedCoordinates`, shape (steps, n).

    It is taken for its bound μ λ_N, shape (steps, n), where it is as near to it as single precision can tell. `along`
    is the force along the joints of carried masses that the engine tells after a step: friction, and what was applied;
    `applied`, shape (steps, 2n), are the generalised forces of the step. All are in the units of the chain.
    """
    on_both, on_carried = np.split(applied, 2, axis=-1)
    friction = along - on_carried
    heavier, lighter = np.maximum(chain.outer_mass, chain.inner_mass), np.minimum(chain.outer_mass, chain.inner_mass)
    # What accelerates the carrier pulls at what it carries.
    pulling = lighter / heavier * (np.abs(on_both - on_carried) + bound)
    rounding = ROUNDINGS * SINGLE * (bound + np.abs(on_carried) + pulling)
    return np.where(np.abs(friction) > bound - rounding, np.copysign(bound, friction), friction)
