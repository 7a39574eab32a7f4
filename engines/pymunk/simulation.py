"""Lanes of pymunk as a simulation: springs, dashpots and drive of all are computed at once at the start of a step."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from engines.interface.presets import Preset
from engines.pymunk.bodies import PymunkBodies, World
from engines.shared.force_loop import LARGEST_MOTION, STEPS_BETWEEN_CHECKS
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray, checked_count


class PymunkSimulation:
    """Lanes that are advanced together, in one space.

    Parameters
    ----------
    kind
        How the masses of a cell are held together.
    lanes
        The lanes; several have to be in their own units, in which they share a time step.
    preset
        The options.
    """

    def __init__(self, kind: type[PymunkBodies], lanes: Sequence[Lane], preset: Preset):
        """Take the lanes' parameters in their units."""
        self.lanes = tuple(lanes)
        self._kind, self._preset = kind, preset
        self._bodies = bodies = kind(lanes, preset)
        springs = bodies.spring_matrix()
        # Only the drive is left where pymunk has the springs.
        self._matrix = np.zeros_like(springs) if bodies.own_springs else springs
        self._length, self._velocity, self._force = np.array(
            [(units.length, units.velocity, units.force) for units in bodies.units]
        ).T[:, :, None]
        self._idle: World | None = None
        self._modulated = any(lane.preload is not None for lane in self.lanes)

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`.

        A lane that diverges stops, and its last row is repeated.
        """
        world, motion = self._begun(state, steps)
        motions = np.empty((steps + 1, *motion.shape))
        motions[0] = motion
        contacts, read = self._bodies.reader(world), []
        stopped = np.full(len(self.lanes), steps)
        for row in self._steps(world, motion, start, steps, stopped):
            motions[row + 1] = motion
            read.append(contacts())
        friction, normal = np.zeros((2, steps, len(self.lanes), self._bodies.cells))
        taken = len(read)
        if taken:
            given = self._preloads(start, steps)[:taken]
            friction[:taken], normal[:taken] = self._bodies.contact_forces(read, motions[: taken + 1], given)
        for lane in np.flatnonzero(stopped < steps):
            last = stopped[lane]
            motions[last + 1 :, lane] = motions[last, lane]
            for rows in (friction, normal):
                rows[last:, lane] = rows[last - 1, lane] if last else 0.0
        return self._trajectories(self._bodies.moved(motions[1:], 1.0), friction, normal, start)

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, without reading the contacts."""
        world, motion = self._begun(state, steps)
        stopped = np.full(len(self.lanes), steps)
        for _ in self._steps(world, motion, start, steps, stopped):
            pass
        position, velocity = np.split(self._bodies.moved(motion, 1.0), 2, axis=1)
        end = State(position * self._length, velocity * self._velocity)
        self._check_ends(end.positions)
        return end

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "PymunkSimulation":
        """Give the lanes of these indices, in a space of their own."""
        return PymunkSimulation(self._kind, [self.lanes[lane] for lane in lanes], self._preset)

    def close(self) -> None:
        """Nothing to do: memory is all that pymunk holds, and it goes with the last reference."""
        return

    def native_steps(self, steps: int) -> None:
        """Take steps of the space of all lanes alone; see `NativeStepping`."""
        if self._idle is None:
            self._idle = self._kind(self.lanes, self._preset).fresh()
        self._bodies.place(self._idle, np.zeros((len(self.lanes), 4 * self._bodies.cells)))
        step, time_step = self._idle.space.step, self._bodies.time_step
        for _ in range(steps):
            step(time_step)

    def _begun(self, state: State, steps: int) -> tuple[World, FloatArray]:
        """Give a space without impulses of an earlier run, and the motion of `state` in it."""
        checked_count("steps", steps)
        state.check_fits(len(self.lanes), self._bodies.cells)
        motion = np.hstack([state.positions / self._length, state.velocities / self._velocity])
        return self._bodies.fresh(), self._bodies.moved(motion, -1.0)

    def _steps(
        self, world: World, motion: FloatArray, start: int, steps: int, stopped: NDArray[np.intp]
    ) -> Iterator[int]:
        """Advance `motion` in place and yield after every step, with its number.

        Where a lane has diverged its bodies rest from then on, so that no other lane sees its numbers; its number of
        steps goes into `stopped`, and in the end its last motion into `motion`.
        """
        self._bodies.place(world, motion)
        matrix, column, step = self._matrix, motion[..., None], self._bodies.stepper(world, motion)
        forces = np.empty((*matrix.shape[:2], 1))
        force, matmul, add = forces[..., 0], np.matmul, np.add
        last = motion.copy()
        # Drives act on cell 1 alone: room for the forces on all of them, for the steps between two checks.
        given, loads = self._loads(start, steps), np.zeros((STEPS_BETWEEN_CHECKS, *force.shape))
        set_normal_load = self._normal_load_setter(world, start, steps)
        for first in range(0, steps, STEPS_BETWEEN_CHECKS):
            self._rest_the_diverged(world, motion, last, stopped, first)
            going = stopped > first
            if not going.any():
                break
            piece = given[first : first + STEPS_BETWEEN_CHECKS]
            loads[: len(piece), :, 0] = np.where(going, piece, 0.0)
            for row, load in enumerate(loads[: len(piece)], first):
                matmul(matrix, column, forces)
                add(force, load, force)
                set_normal_load(row)
                step(force)
                yield row
        motion[stopped < steps] = last[stopped < steps]

    def _rest_the_diverged(
        self, world: World, motion: FloatArray, last: FloatArray, stopped: NDArray[np.intp], steps: int
    ) -> None:
        """Put every lane to rest that has diverged after so many steps, or earlier; keep its motion in `last`."""
        diverged = ~(np.max(np.abs(motion), axis=1) < LARGEST_MOTION) & (stopped > steps)
        if diverged.any():
            last[diverged], stopped[diverged] = motion[diverged], steps
        if (stopped <= steps).any():
            motion[stopped <= steps] = 0.0
            self._bodies.place(world, motion)

    def _loads(self, start: int, steps: int) -> FloatArray:
        """Give the force on cell 1 of every lane at the start of each step, shape (steps, lanes)."""
        return np.stack([lane.loads(start, steps) for lane in self.lanes], axis=1) / self._force[:, 0]

    def _normal_load_setter(self, world: World, start: int, steps: int) -> Callable[[int], None]:
        """Give what sets the normal load of every cell before a step; it does nothing where that is constant."""
        if not self._modulated:
            return lambda _: None
        normal_loads = self._preloads(start, steps)
        return lambda row: self._bodies.set_normal_load(world, normal_loads[row])

    def _preloads(self, start: int, steps: int) -> FloatArray:
        """Give the normal load of every cell of every lane in each step, shape (steps, lanes, n)."""
        return np.stack([lane.preloads(start, steps) for lane in self.lanes], axis=1) / self._force

    def _trajectories(
        self, motions: FloatArray, friction: FloatArray, normal: FloatArray, start: int
    ) -> list[Trajectory]:
        """Give the trajectory of each lane in SI units."""
        half, trajectories = motions.shape[2] // 2, []
        for index, (lane, units) in enumerate(zip(self.lanes, self._bodies.units, strict=True)):
            time = lane.times(start, len(motions))
            position, velocity = motions[:, index, :half] * units.length, motions[:, index, half:] * units.velocity
            forces = friction[:, index] * units.force, normal[:, index] * units.force
            trajectories.append(Trajectory(time, position, velocity, *forces))
        self._check_ends(np.stack([trajectory.positions[-1] for trajectory in trajectories]))
        return trajectories

    def _check_ends(self, positions: FloatArray) -> None:
        """Check the last positions of every lane [m]."""
        for lane, row in enumerate(positions):
            self._bodies.check_end(lane, row)


class PymunkLane(LaneModel):
    """A lane in a space of its own, for units in which lanes do not share a time step."""

    def __init__(self, kind: type[PymunkBodies], lane: Lane, preset: Preset):
        """Take the lane's parameters in its units."""
        self.lane = lane
        self._alone = PymunkSimulation(kind, [lane], preset)

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; see `LaneModel.run`."""
        return self._alone.run(state, start, steps)[0]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, without reading the contacts."""
        return self._alone.advance(state, start, steps)

    def native_steps(self, steps: int) -> None:
        """Take steps of the engine alone; see `NativeStepping`."""
        self._alone.native_steps(steps)
