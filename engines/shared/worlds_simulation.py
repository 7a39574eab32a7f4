"""Lanes as worlds of engines that advance all lanes of a batch at once."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.shared.coordinates import JointCoordinates
from multibody_xval.engines.shared.units import Units
from multibody_xval.engines.shared.warp_worlds import CHUNK, Rows, WarpWorlds
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.schemes.sequential import LaneModel
from reference_lcp.validation import FloatArray, checked_count


class LanesInUnits:
    """Lanes that take their steps together, each in units of its own."""

    def __init__(self, lanes: Sequence[Lane], units: Sequence[Units]):
        self.lanes, self._units = tuple(lanes), tuple(units)
        self._length = np.array([[unit.length] for unit in units])
        self._velocity = np.array([[unit.velocity] for unit in units])

    def close(self) -> None:
        """Nothing to do where memory is all that the engine holds: it goes with the last reference."""
        return

    def _loads(self, start: int, steps: int) -> FloatArray:
        """Give the force on cell 1 in every step, shape (steps, lanes)."""
        return self._of_lanes(lambda lane: lane.loads(start, steps))

    def _preloads(self, start: int, steps: int) -> FloatArray:
        """Give λ_N of every contact in every step, shape (steps, lanes, n)."""
        return self._of_lanes(lambda lane: lane.preloads(start, steps))

    def _bounds(self, start: int, steps: int) -> FloatArray:
        """Give μ λ_N of every contact in every step, shape (steps, lanes, n)."""
        return self._of_lanes(lambda lane: lane.chain.friction_coefficient * lane.preloads(start, steps))

    def _of_lanes(self, of: Callable[[Lane], FloatArray]) -> FloatArray:
        return np.stack([of(lane) / units.force for lane, units in zip(self.lanes, self._units, strict=True)], axis=1)


class LanesOfJoints(LanesInUnits):
    """Lanes of which a cell has so many joints: that of the outer mass, of the inner one relative to it, and others.

    Where masses may leave each other, the fourth joint of a cell lifts the inner one.
    """

    _joints: int
    _opens: bool = False

    def _coordinates(self, state: State) -> tuple[FloatArray, FloatArray]:
        """Give the joint coordinates of a state, and their rates, shape (lanes, nq) each."""
        own = JointCoordinates(self._joints)
        positions = own.of(state.positions / self._length)
        velocities = own.of(state.velocities / self._velocity)
        if self._opens:
            gap, speed = state.normal_state(self.lanes[0].chain.cells)
            self._gaps(positions)[:] = gap / self._length
            self._gaps(velocities)[:] = speed / self._velocity
        return positions, velocities

    def _state_at(self, positions: FloatArray, velocities: FloatArray) -> State:
        """Give the state of all lanes at joint coordinates, shape (lanes, nq), and their rates."""
        own = JointCoordinates(self._joints)
        position = own.absolute(positions) * self._length
        velocity = own.absolute(velocities) * self._velocity
        if not self._opens:
            return State(position, velocity)
        gap, speed = (self._gaps(rows) for rows in (positions, velocities))
        return State(position, velocity, np.hstack([gap * self._length, speed * self._velocity]))

    def _trajectories(
        self,
        start: int,
        positions: FloatArray,
        velocities: FloatArray,
        forces: Callable[[int], tuple[FloatArray, FloatArray]],
    ) -> list[Trajectory]:
        """Give the motions of all lanes from joint coordinates and their rates, shape (lanes, steps, nq).

        `forces` gives friction and normal force [N] of a lane, shape (steps, n), by its index.
        """
        own, end = JointCoordinates(self._joints), self._state_at(positions[:, -1], velocities[:, -1]).internal_state
        return [
            Trajectory(
                lane.times(start, positions.shape[1]),
                own.absolute(positions[index]) * units.length,
                own.absolute(velocities[index]) * units.velocity,
                *forces(index),
                None if end is None else end[index],
                self._gaps(positions[index]) * units.length if self._opens else None,
            )
            for index, (lane, units) in enumerate(zip(self.lanes, self._units, strict=True))
        ]

    def _gaps(self, coordinates: FloatArray) -> FloatArray:
        """Give the part of joint coordinates, shape (..., nq), that are gaps; rates likewise."""
        return coordinates[..., 3 :: self._joints]


def rub_alike(lanes: Sequence[Lane]) -> bool:
    """Whether the same cells of all lanes have friction."""
    return len({tuple(lane.chain.friction_bound > 0) for lane in lanes}) == 1


class LaneAlone(LaneModel):
    """The only lane of a simulation that takes many."""

    def __init__(self, simulation: Simulation):
        self.lane, self._simulation = simulation.lanes[0], simulation

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; see `LaneModel.run`."""
        return self._simulation.run(state, start, steps)[0]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and keep the end only."""
        return self._simulation.advance(state, start, steps)

    def close(self) -> None:
        """Free what the simulation holds."""
        self._simulation.close()


class WorldsSimulation(LanesOfJoints, ABC):
    """Lanes as worlds, each with its own numbers and units.

    A cell has so many `joints`: the coordinates of the outer mass and of the inner one relative to it come first.
    """

    def __init__(self, lanes: Sequence[Lane], units: Sequence[Units], joints: int, worlds: WarpWorlds):
        super().__init__(lanes, units)
        self._joints, self._worlds = joints, worlds

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`.

        The last finite row of a lane that diverges is repeated.
        """
        chunks = list(self._chunks(state, start, steps))
        rows = Rows(*(np.concatenate(parts).swapaxes(0, 1) for parts in zip(*chunks, strict=True)))

        def forces(index: int) -> tuple[FloatArray, FloatArray]:
            given = self.lanes[index].preloads(start, steps)
            return self._contact_forces(index, rows.friction[index], rows.normal_force[index], given)

        return self._trajectories(start, rows.positions, rows.velocities, forces)

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        for chunk in self._chunks(state, start, steps):
            last = chunk
        return self._state_at(last.positions[-1], last.velocities[-1])

    @abstractmethod
    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices."""

    def _chunks(self, state: State, start: int, steps: int) -> Iterator[Rows]:
        """Set the state, and give the rows of `steps` steps, some at a time."""
        checked_count("steps", steps)
        state.check_fits(len(self.lanes), self.lanes[0].chain.freedoms)
        self._worlds.set(*self._coordinates(state))
        for first in range(start, start + steps, CHUNK):
            length = min(CHUNK, start + steps - first)
            yield self._worlds.steps(self._loads(first, length), self._pressing(first, length))

    def _pressing(self, start: int, steps: int) -> FloatArray:
        """Give what bounds the friction of every contact in every step, shape (steps, lanes, n): here μ λ_N."""
        return self._bounds(start, steps)

    @abstractmethod
    def _contact_forces(
        self, index: int, friction: FloatArray, normal_force: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Give λ_T on the inner masses of a lane and λ_N [N] from its rows; `given` is what presses its contacts."""
