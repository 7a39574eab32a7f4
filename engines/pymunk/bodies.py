"""Lanes of pymunk, whatever holds their masses together: many in one space, set and read at once.

A step of one chain takes pymunk a microsecond, and so does a call that sets or reads bodies: shared by all lanes
of a space, such a call costs little. Lanes share a space when they share its time step, which their own units see to.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from engines.interface.presets import Preset
from engines.shared.coordinates import ChainCoordinates
from engines.shared.units import Units, power_of_two
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

SPRING_LENGTH = 2.0**10
"""Length of a damped spring over the displacement scale: it acts along the line of its anchors."""


@dataclass(frozen=True)
class World:
    """A space, its bodies, and what makes friction in it.

    Parameters
    ----------
    space
        pymunk's space.
    bodies
        Its bodies, lane by lane, outer masses first.
    holds
        What makes friction, lane by lane and cell by cell, where the adapter reads it.
    """

    space: Any
    bodies: list[Any]
    holds: list[Any]


class PymunkBodies(ABC):
    """The lanes of one space, in their units.

    pymunk advances positions by the velocities at the start of a step, and then the velocities under the forces
    that were set. A lane that shares the scheme of equation (5) therefore holds the positions of the step before:
    its p is x - dt v, forces are those at p + dt v, and after a step p is the x that the step began with.

    A motion has one row a lane: coordinates, then velocities, shape (lanes, 4n).

    Parameters
    ----------
    lanes
        The lanes; in their units they have one time step.
    preset
        The options.
    """

    def __init__(self, lanes: Sequence[Lane], preset: Preset):
        self.lanes = tuple(lanes)
        # With dt as unit of time all lanes can share a space, though to convert velocities and parameters rounds them.
        self.units = tuple(Units.in_steps(preset["units"], lane) for lane in lanes)
        self.chains: tuple[Chain, ...] = tuple(
            units.scaled(lane.chain) for lane, units in zip(lanes, self.units, strict=True)
        )
        self.cells = lanes[0].chain.cells
        (self.time_step,) = {lane.time_step / units.time for lane, units in zip(lanes, self.units, strict=True)}
        self.own_springs = preset["springs"] == "damped springs"
        self._lag = preset["positions"] == "of the step before"
        self._preset = preset
        # Where bodies are across the motion, and the forces on them there, shape (lanes, 2n).
        self._heights, self._pressing = np.zeros((2, len(lanes), 2 * self.cells))

    @abstractmethod
    def _hold(self, space: Any, chain: Chain, outer: list[Any], inner: list[Any]) -> list[Any]:
        """Add what makes friction between the masses of each cell of a lane; give what is to be read of it."""

    def fresh(self) -> World:
        """Give a space whose joints and contacts hold no impulses; bodies are anywhere."""
        import pymunk

        space = pymunk.Space()
        space.iterations = self._preset["iterations"]
        world = World(space, [], [])
        for index, chain in enumerate(self.chains):
            # A body with an infinite moment of inertia does not turn.
            masses = np.concatenate([chain.outer_mass, chain.inner_mass]).tolist()
            bodies = [pymunk.Body(mass, math.inf) for mass in masses]
            space.add(*bodies)
            outer, inner = bodies[: self.cells], bodies[self.cells :]
            world.holds.extend(self._hold(space, chain, outer, inner))
            if self.own_springs:
                self._add_springs(space, index, outer, inner)
            world.bodies.extend(bodies)
        return world

    def place(self, world: World, motion: FloatArray) -> None:
        """Give all bodies this motion."""
        from pymunk import batch

        # The last row is for the space's own body, which stays where it is.
        rows = np.zeros((len(world.bodies) + 1, 4))
        rows[:-1, 0], rows[:-1, 2] = (half.ravel() for half in np.split(motion, 2, axis=1))
        rows[:-1, 1] = self._heights.ravel()
        buffer = batch.Buffer()
        buffer.set_float_buf(rows)
        batch.set_space_bodies(world.space, batch.BodyFields.POSITION | batch.BodyFields.VELOCITY, buffer)

    def stepper(self, world: World, motion: FloatArray) -> Callable[[FloatArray], None]:
        """Give what takes one step under forces, shape (lanes, 2n), and writes the new motion into `motion`."""
        from pymunk import batch

        space, shape = world.space, self._heights.shape
        read, fields = batch.Buffer(), batch.BodyFields.POSITION | batch.BodyFields.VELOCITY
        get_bodies, set_bodies, force_field = batch.get_space_bodies, batch.set_space_bodies, batch.BodyFields.FORCE
        # pymunk allocates its memory at the first reading and uses it from then on.
        get_bodies(space, fields, read)
        # The space's own body, where something hangs on it, comes last.
        bodies, all_bodies = len(world.bodies), np.frombuffer(read.float_buf()).reshape(-1, 4)
        # Of x, y and their velocities, in the order of a motion: x of all bodies, then their velocities.
        motion_read = all_bodies[:bodies].reshape(*shape, 4)[..., ::2].swapaxes(1, 2)
        loads, forces = batch.Buffer(), np.zeros((len(all_bodies), 2))
        loads.set_float_buf(forces)
        along = forces[:bodies, 0].reshape(shape)
        forces[:bodies, 1] = self._pressing.ravel()
        moved = motion.reshape(shape[0], 2, shape[1])
        advance, clear, time_step = space.step, read.clear, self.time_step

        def step(force: FloatArray) -> None:
            along[:] = force
            set_bodies(space, force_field, loads)
            advance(time_step)
            clear()
            get_bodies(space, fields, read)
            moved[:] = motion_read

        return step

    def set_normal_load(self, world: World, normal_load: FloatArray) -> None:
        """Set the normal loads of the next step, shape (lanes, n), where they change in time."""
        raise NotImplementedError(f"{type(self).__name__} have a constant normal force")

    @abstractmethod
    def reader(self, world: World) -> Callable[[], Any]:
        """Give what reads, after a step, what pymunk reports of the contacts of all lanes."""

    @abstractmethod
    def contact_forces(self, read: list[Any], motions: FloatArray, given: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Turn what was read into friction on the inner masses and normal force, shape (steps, lanes, n) each.

        Parameters
        ----------
        read
            What the reader gave, one item a step.
        motions
            The motion at the start, and at the end of each step, shape (steps + 1, lanes, 4n).
        given
            Normal load of the contacts in each step, shape (steps, lanes, n).
        """

    def spring_matrix(self) -> FloatArray:
        """Give the matrices that turn motions into the forces of springs and dashpots, shape (lanes, 2n, 4n)."""
        matrix = np.stack([ChainCoordinates.ABSOLUTE.force_matrix(chain) for chain in self.chains])
        if self._lag:
            half = matrix.shape[1]
            matrix[..., half:] += self.time_step * matrix[..., :half]
        return matrix

    def moved(self, motions: FloatArray, steps: float) -> FloatArray:
        """Move positions by steps forth or back, if these lanes hold those of the step before."""
        position, velocity = np.split(motions, 2, axis=-1)
        if self._lag:
            position = position + steps * self.time_step * velocity
        return np.concatenate([position, velocity], axis=-1)

    def check_end(self, lane: int, positions: FloatArray) -> None:
        """Refuse the end of a motion [m], shape (2n,), that these bodies cannot stand for."""
        return

    def _add_springs(self, space: Any, index: int, outer: list[Any], inner: list[Any]) -> None:
        """Add the springs: the right end of each is an anchor that its body carries ahead of it, at equal height."""
        import pymunk

        lane, chain = self.lanes[index], self.chains[index]
        heights = np.concatenate([[0.0], self._heights[index]])
        length = SPRING_LENGTH * power_of_two(lane.drive.displacement_scale(lane.chain)) / self.units[index].length
        lefts, rights = [space.static_body, *outer[:-1], *outer], [*outer, *inner]
        rises = heights[[*range(chain.cells), *range(1, chain.cells + 1)]] - heights[1:]
        stiffnesses = np.concatenate([chain.chain_stiffness, chain.inner_stiffness])
        dampings = np.concatenate([chain.chain_damping, chain.inner_damping])
        for left, right, rise, stiffness, damping in zip(lefts, rights, rises, stiffnesses, dampings, strict=True):
            anchors = (0.0, 0.0), (length, float(rise))
            space.add(pymunk.DampedSpring(left, right, *anchors, length, float(stiffness), float(damping)))
