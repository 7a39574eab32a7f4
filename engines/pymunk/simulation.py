"""Lanes of pymunk, whatever holds their masses together: many in one space, set and read at once.

A step of one chain takes pymunk a microsecond, and so does a call that sets or reads bodies: shared by all lanes
of a space, such a call costs little. Lanes share a space when they share its time step, which their own units see to.
"""

import math
from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.coordinates import ChainCoordinates
from multibody_xval.engines.shared.force_loop import LARGEST_MOTION, STEPS_BETWEEN_CHECKS
from multibody_xval.engines.shared.units import Units, power_of_two
from multibody_xval.engines.shared.worlds_simulation import LanesInUnits
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray, checked_count

SPRING_LENGTH = 2.0**10
"""Length of a damped spring over the displacement scale: it acts along the line of its anchors."""


@dataclass(frozen=True)
class World:
    """A space of pymunk."""

    space: Any
    bodies: list[Any]
    """Lane by lane, outer masses first."""
    holds: list[Any]
    """What makes friction, lane by lane and cell by cell, where the adapter reads it."""

    def take_apart(self) -> None:
        """Remove joints and springs: freed in any order with their bodies, they now and then end the process."""
        self.space.remove(*self.space.constraints)


class PymunkSimulation(LanesInUnits):
    """Lanes that are advanced together, in one space; several have to be in their own units, which share a time step.

    Springs, dashpots and drive of all are computed at once at the start of a step.

    pymunk advances positions by the velocities at the start of a step, and then the velocities under the forces
    that were set. A lane that shares the scheme of equation (5) therefore holds the positions of the step before:
    its p is x - dt v, forces are those at p + dt v, and after a step p is the x that the step began with.

    A motion has one row a lane: coordinates, then velocities, shape (lanes, 4n).
    """

    def __init__(self, lanes: Sequence[Lane], preset: Preset):
        # With dt as unit of time all lanes can share a space, though to convert velocities and parameters rounds them.
        super().__init__(lanes, [Units.in_steps(preset["units"], lane) for lane in lanes])
        self._preset, self._cells = preset, lanes[0].chain.cells
        self._chains = [units.scaled(lane.chain) for lane, units in zip(lanes, self._units, strict=True)]
        (self._time_step,) = {lane.time_step / units.time for lane, units in zip(lanes, self._units, strict=True)}
        self._own_springs = preset["springs"] == "damped springs"
        self._lag = preset["positions"] == "of the step before"
        # Forces of springs and dashpots of a motion, shape (lanes, 2n, 4n).
        self._springs = np.stack([ChainCoordinates.ABSOLUTE.force_matrix(chain) for chain in self._chains])
        if self._lag:
            half = 2 * self._cells
            self._springs[..., half:] += self._time_step * self._springs[..., :half]
        # Where bodies are across the motion, and the forces on them there, shape (lanes, 2n).
        self._heights, self._pressing = np.zeros((2, len(lanes), 2 * self._cells))

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`.

        A lane that diverges stops, and its last motion is repeated.
        """
        world, motion = self._begun(state, steps)
        motions, contacts, read = np.empty((steps + 1, *motion.shape)), self._reader(world), []
        motions[0] = motion
        for row, moved in enumerate(self._steps(world, motion, start, steps), 1):
            motions[row] = moved
            read.append(contacts())
        world.take_apart()
        friction, normal = self._contact_forces(read, motions, self._preloads(start, steps))
        half, ends = 2 * self._cells, self._moved(motions[1:], 1.0)
        self._check_ends(ends[-1, :, :half] * self._length)
        return [
            Trajectory(
                lane.times(start, steps),
                ends[:, index, :half] * units.length,
                ends[:, index, half:] * units.velocity,
                friction[:, index] * units.force,
                normal[:, index] * units.force,
            )
            for index, (lane, units) in enumerate(zip(self.lanes, self._units, strict=True))
        ]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, without reading the contacts."""
        world, motion = self._begun(state, steps)
        for moved in self._steps(world, motion, start, steps):
            last = moved
        world.take_apart()
        position, velocity = np.split(self._moved(last, 1.0), 2, axis=1)
        return State(position * self._length, velocity * self._velocity)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices, in a space of their own."""
        return type(self)([self.lanes[lane] for lane in lanes], self._preset)

    @abstractmethod
    def _hold(self, space: Any, chain: Chain, outer: list[Any], inner: list[Any]) -> list[Any]:
        """Add what makes friction between the masses of each cell of a lane; give what is to be read of it."""

    @abstractmethod
    def _reader(self, world: World) -> Callable[[], Any]:
        """Give what reads, after a step, what pymunk reports of the contacts of all lanes."""

    @abstractmethod
    def _contact_forces(self, read: list[Any], motions: FloatArray, given: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Turn what was read of each step into friction on inner masses and normal force, shape (steps, lanes, n) each.

        `motions` are those at the start and at the end of each step, shape (steps + 1, lanes, 4n); `given` is the
        normal load of the contacts in each step, shape (steps, lanes, n).
        """

    def _set_normal_load(self, world: World, normal_load: FloatArray) -> None:
        """Set the normal loads of the next step, shape (lanes, n), where they change in time."""
        raise NotImplementedError(f"{type(self).__name__} have a constant normal force")

    def _check_ends(self, positions: FloatArray) -> None:
        """Refuse ends of motions [m], shape (lanes, 2n), that the bodies cannot stand for."""

    def _new_world(self) -> World:
        """Give a space whose joints and contacts hold no impulses; bodies are anywhere."""
        import pymunk

        world = World(pymunk.Space(), [], [])
        world.space.iterations = self._preset["iterations"]
        for index, chain in enumerate(self._chains):
            # A body with an infinite moment of inertia does not turn.
            masses = np.concatenate([chain.outer_mass, chain.inner_mass]).tolist()
            bodies = [pymunk.Body(mass, math.inf) for mass in masses]
            world.space.add(*bodies)
            outer, inner = bodies[: self._cells], bodies[self._cells :]
            world.holds.extend(self._hold(world.space, chain, outer, inner))
            if self._own_springs:
                self._add_springs(world.space, index, outer, inner)
            world.bodies.extend(bodies)
        return world

    def _add_springs(self, space: Any, index: int, outer: list[Any], inner: list[Any]) -> None:
        """Add the springs: the right end of each is an anchor that its body carries ahead of it, at equal height."""
        import pymunk

        lane, chain = self.lanes[index], self._chains[index]
        heights = np.concatenate([[0.0], self._heights[index]])
        length = SPRING_LENGTH * power_of_two(lane.drive.displacement_scale(lane.chain)) / self._units[index].length
        lefts, rights = [space.static_body, *outer[:-1], *outer], [*outer, *inner]
        rises = heights[[*range(chain.cells), *range(1, chain.cells + 1)]] - heights[1:]
        stiffnesses = np.concatenate([chain.chain_stiffness, chain.inner_stiffness])
        dampings = np.concatenate([chain.chain_damping, chain.inner_damping])
        for left, right, rise, stiffness, damping in zip(lefts, rights, rises, stiffnesses, dampings, strict=True):
            anchors = (0.0, 0.0), (length, float(rise))
            space.add(pymunk.DampedSpring(left, right, *anchors, length, float(stiffness), float(damping)))

    def _place(self, world: World, motion: FloatArray) -> None:
        """Give all bodies this motion."""
        from pymunk import batch

        # The last row is for the space's own body, which stays where it is.
        rows = np.zeros((len(world.bodies) + 1, 4))
        rows[:-1, 0], rows[:-1, 2] = (half.ravel() for half in np.split(motion, 2, axis=1))
        rows[:-1, 1] = self._heights.ravel()
        buffer = batch.Buffer()
        buffer.set_float_buf(rows)
        batch.set_space_bodies(world.space, batch.BodyFields.POSITION | batch.BodyFields.VELOCITY, buffer)

    def _stepper(self, world: World, motion: FloatArray) -> Callable[[FloatArray], None]:
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
        advance, clear, time_step = space.step, read.clear, self._time_step

        def step(force: FloatArray) -> None:
            along[:] = force
            set_bodies(space, force_field, loads)
            advance(time_step)
            clear()
            get_bodies(space, fields, read)
            moved[:] = motion_read

        return step

    def _begun(self, state: State, steps: int) -> tuple[World, FloatArray]:
        """Give a space without impulses of an earlier run, and the motion of `state` in it."""
        checked_count("steps", steps)
        state.check_fits(len(self.lanes), 2 * self._cells)
        motion = np.hstack([state.positions / self._length, state.velocities / self._velocity])
        return self._new_world(), self._moved(motion, -1.0)

    def _moved(self, motions: FloatArray, steps: float) -> FloatArray:
        """Move positions by steps forth or back, if these lanes hold those of the step before."""
        position, velocity = np.split(motions, 2, axis=-1)
        if self._lag:
            position = position + steps * self._time_step * velocity
        return np.concatenate([position, velocity], axis=-1)

    def _steps(self, world: World, motion: FloatArray, start: int, steps: int) -> Iterator[FloatArray]:
        """Take steps from this motion; gives the motion after each, in an array that is used again.

        A lane that has diverged stays where it was, and its bodies begin at rest again and again, so that no other
        lane sees its numbers.
        """
        self._place(world, motion)
        # Only the drive is left where pymunk has the springs.
        matrix = np.zeros_like(self._springs) if self._own_springs else self._springs
        column, step, matmul = motion[..., None], self._stepper(world, motion), np.matmul
        forces = np.empty((*matrix.shape[:2], 1))
        force, live, last = forces[..., 0], np.ones((len(motion), 1), dtype=np.bool_), motion.copy()
        modulated = any(lane.preload is not None for lane in self.lanes)
        normal_loads = self._preloads(start, steps) if modulated else None
        for number, load in enumerate(self._loads(start, steps)):
            if number % STEPS_BETWEEN_CHECKS == 0:
                last = np.where(live, motion, last)
                live = live & (np.max(np.abs(last), axis=1, keepdims=True) < LARGEST_MOTION)
                moving = bool(live.all())
                if not moving:
                    motion[:] = np.where(live, motion, 0.0)
                    self._place(world, motion)
            matmul(matrix, column, forces)
            force[:, 0] += load
            if normal_loads is not None:
                self._set_normal_load(world, normal_loads[number])
            step(force)
            yield motion if moving else np.where(live, motion, last)
