"""Lanes whose springs, dashpots and drive are forces that the adapter computes at the start of each step.

In many engines only masses and friction are the engine's own. One loop serves them all; an engine adds how
bodies get a state, how they take a step under given forces, and how contacts are read.
"""

from abc import abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.box_geometry import PLATE, SPACING, PressedBoxes
from multibody_xval.engines.shared.coordinates import CarriedCoordinates, ChainCoordinates, JointCoordinates
from multibody_xval.engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.schemes.sequential import LaneModel
from reference_lcp.validation import FloatArray, checked_count

Step = Callable[[FloatArray], None]
"""Takes one step under generalised forces, shape (2n,)."""


LARGEST_MOTION = 1e15
"""Coordinates and velocities in the lane's units beyond which a lane has diverged, and stops."""

STEPS_BETWEEN_CHECKS = 16
"""Few enough that an unstable motion does not grow from there to numbers of which engines complain at every step."""


class ExplicitForcesLane(LaneModel):
    """One chain under forces computed at the start of each step.

    Everything that an engine sees is in the `Units` of the preset. A motion is one vector of coordinates, then of their
    velocities, shape (4n,); the loop owns it, and the engine writes what it reads into it.
    """

    coordinates: ChainCoordinates | CarriedCoordinates | JointCoordinates = ChainCoordinates.ABSOLUTE
    units_of = staticmethod(Units.named)
    """Gives the units that a preset names, in a lane."""
    _own_springs = False
    """Springs and dashpots are the engine's: only the drive is a force."""

    def __init__(self, lane: Lane, preset: Preset):
        self.lane, self._preset = lane, preset
        self._units = units = self.units_of(preset["units"], lane)
        self._chain = units.scaled(lane.chain)
        self._time_step = lane.time_step / units.time
        self._forces = np.ascontiguousarray(self._force_matrix())
        # Of what the loop hands to a step; an engine that wants something in proportion changes both.
        self._force_unit = units.force
        # Coordinates on which the force on cell 1 acts.
        self._loaded = self.coordinates.loaded

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; see `LaneModel.run`.

        A lane that diverges stops, and its last row is repeated.
        """
        motion, step = self._started(state, start, steps)
        # A matrix's own product goes round the dispatch of np.dot.
        product, force, contacts = self._forces.dot, np.empty(motion.size // 2), self._contacts
        loaded = self._loaded
        motions = np.empty((steps + 1, motion.size))
        motions[0] = motion
        read, gaps = [], []
        for row, load in zip(motions[1:], self._loads(start, steps, motion), strict=False):
            product(motion, force)
            force[loaded] += load
            step(force)
            row[:] = motion
            read.append(contacts())
            if self.lane.opens:
                gaps.append(self._gaps()[0])
        motions[len(read) + 1 :] = motion
        read, gaps = (rows + rows[-1:] * (steps - len(rows)) for rows in (read, gaps))
        friction, normal = self._contact_forces(np.array(read), motions, self.lane.preloads(start, steps))
        end = self._state(motions[1:])
        across = (self._internal_state(), np.array(gaps) * self._units.length) if gaps else (None, None)
        return Trajectory(self.lane.times(start, steps), end.positions, end.velocities, friction, normal, *across)

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, without reading the contacts."""
        motion, step = self._started(state, start, steps)
        product, force, loaded = self._forces.dot, np.empty(motion.size // 2), self._loaded
        for load in self._loads(start, steps, motion):
            product(motion, force)
            force[loaded] += load
            step(force)
        end, internal_state = self._state(motion[None]), self._internal_state()
        return end if internal_state is None else replace(end, internal_state=internal_state[None])

    @abstractmethod
    def _begin(self, motion: FloatArray) -> Step:
        """Give the bodies this motion; the step that is returned writes the new one into the same array."""

    @abstractmethod
    def _contacts(self) -> FloatArray | list[float]:
        """Read what the engine reports of the contacts after a step."""

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        """Set the normal loads of the next step, in the lane's units, shape (n,), where they change in time."""
        raise NotImplementedError(f"{type(self).__name__} has a constant normal force")

    def _gaps(self) -> FloatArray:
        """Read the gap of every contact, and its rate, in the lane's units, shape (2, n), where contacts open."""
        raise NotImplementedError(f"{type(self).__name__} has contacts that stay closed")

    def _contact_forces(
        self, read: FloatArray, motions: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Turn what was read into friction on the inner masses and normal force [N], shape (steps, n) each.

        `read` is what `_contacts` gave, one row a step: here the friction itself, in the lane's units. `motions`, shape
        (steps + 1, 4n), has the start and the ends of the steps; `given`, shape (steps, n), the normal loads [N].
        """
        return read * self._units.force, given

    def _force_matrix(self) -> FloatArray:
        """Give the matrix that turns a motion into generalised forces, shape (2n, 4n)."""
        matrix = self.coordinates.force_matrix(self._chain)
        return np.zeros_like(matrix) if self._own_springs else matrix

    def _motion(self, state: State) -> FloatArray:
        """Give the motion of a state, a batch of one lane."""
        position, velocity = state.positions[0] / self._units.length, state.velocities[0] / self._units.velocity
        return np.concatenate([self.coordinates.of(position), self.coordinates.of(velocity)])

    def _state(self, motions: FloatArray) -> State:
        """Give positions and velocities of motions, shape (rows, 4n)."""
        position, velocity = np.split(motions, 2, axis=1)
        return self._units.state(self.coordinates.absolute(position), self.coordinates.absolute(velocity))

    def _started(self, state: State, start: int, steps: int) -> tuple[FloatArray, Step]:
        """Give the motion of `state` and the function that advances it."""
        checked_count("steps", steps)
        motion = self._motion(state)
        # Gaps and their rates, which `_begin` gives the bodies too where contacts open.
        self._across = self._units.gaps(self.lane, state)
        step = self._begin(motion)
        return motion, step if self.lane.preload is None else self._with_normal_load(step, start, steps)

    def _with_normal_load(self, step: Step, start: int, steps: int) -> Step:
        """Let every step begin with setting its normal load."""
        normal_loads = iter(self.lane.preloads(start, steps) / self._units.force)
        set_normal_load = self._set_normal_load

        def step_under_normal_load(force: FloatArray) -> None:
            set_normal_load(next(normal_loads))
            step(force)

        return step_under_normal_load

    def _internal_state(self) -> FloatArray | None:
        """Give gaps and their rates, as `State.normal_state` reads them; ``None`` where none opens."""
        return self._units.normal_state(*self._gaps()) if self.lane.opens else None

    def _loads(self, start: int, steps: int, motion: FloatArray) -> Iterator[float]:
        """Give the force on cell 1 at the start of each step, until the motion has diverged."""
        # Python's numbers are added faster than NumPy's.
        loads: list[float] = (self.lane.loads(start, steps) / self._force_unit).tolist()
        for first in range(0, steps, STEPS_BETWEEN_CHECKS):
            yield from loads[first : first + STEPS_BETWEEN_CHECKS]
            if not np.max(np.abs(motion)) < LARGEST_MOTION:
                return


class PressedLane(ExplicitForcesLane):
    """One chain with a body on a plate in every cell; `_contacts` gives friction and normal forces, shape (2, n)."""

    plate, spacing = PLATE, SPACING

    @cached_property
    def _sizes(self) -> PressedBoxes:
        return PressedBoxes.of(self.lane, self._units, self.plate, self.spacing)

    def _contact_forces(
        self, read: FloatArray, motions: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        forces = read * self._units.force
        return forces[:, 0], forces[:, 1]

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; a body that ends off its plate is refused.

        `advance` does not look: a search may try a state from which one flies off, and then begins anew.
        """
        trajectory = super().run(state, start, steps)
        self._sizes.check_reach(trajectory.positions[-1], self._units)
        return trajectory
