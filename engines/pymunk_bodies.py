"""Lanes of pymunk, whatever holds their masses together: bodies, springs, and how all are set and read at once."""

import math
from abc import abstractmethod
from typing import Any

import numpy as np

from engines.explicit_forces import ExplicitForcesLane, Step
from engines.interface import Preset
from engines.units import Units, power_of_two
from reference_lcp.simulation import Lane
from reference_lcp.trajectory import State
from reference_lcp.validation import FloatArray

LENGTH = 2.0**10
"""Length of a damped spring over the displacement scale: it acts along the line of its anchors."""


class PymunkLane(ExplicitForcesLane):
    """One chain; a run makes its space anew, for joints and contacts remember their last impulses.

    pymunk advances positions by the velocities at the start of a step, and then the velocities under the forces
    that were set. A lane that shares the scheme of equation (5) therefore holds the positions of the step before:
    its p is x - dt v, forces are those at p + dt v, and after a step p is the x that the step began with.
    """

    def __init__(self, lane: Lane, preset: Preset):
        """Take the lane's parameters in its units."""
        self._preset = preset
        self._own_springs = preset["springs"] == "damped springs"
        self._lag = preset["positions"] == "of the step before"
        super().__init__(lane, Units.named(preset["units"], lane))
        # Where bodies are across the motion, and the forces on them there.
        self._heights, self._pressing = np.zeros((2, 2 * lane.chain.cells))

    def bare_steps(self, steps: int) -> None:
        """Take steps of the engine alone; see `BareStepping`."""
        space, _ = self._new_space(np.zeros(4 * self._chain.cells))
        step, time_step = space.step, self._time_step
        for _ in range(steps):
            step(time_step)

    @abstractmethod
    def _hold(self, space: Any, outer: list[Any], inner: list[Any]) -> None:
        """Add what makes friction between the masses of each cell."""

    def _new_space(self, motion: FloatArray) -> tuple[Any, list[Any]]:
        """Make the space with this motion; give it and its bodies, outer masses first."""
        import pymunk

        space = pymunk.Space()
        space.iterations = self._preset["iterations"]
        positions, velocities = np.split(motion, 2)
        masses = np.concatenate([self._chain.outer_mass, self._chain.inner_mass])
        bodies = []
        for mass, *place, velocity in zip(masses, positions, self._heights, velocities, strict=True):
            # A body with an infinite moment of inertia does not turn.
            body = pymunk.Body(float(mass), math.inf)
            body.position, body.velocity = (float(place[0]), float(place[1])), (float(velocity), 0.0)
            bodies.append(body)
        space.add(*bodies)
        outer, inner = bodies[: len(bodies) // 2], bodies[len(bodies) // 2 :]
        self._hold(space, outer, inner)
        if self._own_springs:
            self._add_springs(space, outer, inner)
        return space, bodies

    def _add_springs(self, space: Any, outer: list[Any], inner: list[Any]) -> None:
        """Add the springs: the right end of each is an anchor that its body carries ahead of it, at equal height."""
        import pymunk

        chain, heights = self._chain, np.concatenate([[0.0], self._heights])
        length = LENGTH * power_of_two(self.lane.drive.displacement_scale(self.lane.chain)) / self._units.length
        lefts, rights = [space.static_body, *outer[:-1], *outer], [*outer, *inner]
        rises = heights[[*range(chain.cells), *range(1, chain.cells + 1)]] - heights[1:]
        stiffnesses = np.concatenate([chain.chain_stiffness, chain.inner_stiffness])
        dampings = np.concatenate([chain.chain_damping, chain.inner_damping])
        for left, right, rise, stiffness, damping in zip(lefts, rights, rises, stiffnesses, dampings, strict=True):
            anchors = (0.0, 0.0), (length, float(rise))
            space.add(pymunk.DampedSpring(left, right, *anchors, length, float(stiffness), float(damping)))

    def _force_matrix(self) -> FloatArray:
        """Only the drive is left where pymunk has the springs."""
        matrix = self._spring_matrix()
        return np.zeros_like(matrix) if self._own_springs else matrix

    def _spring_matrix(self) -> FloatArray:
        """Give the matrix that turns a motion into the forces of springs and dashpots."""
        matrix = super()._force_matrix()
        if self._lag:
            half = matrix.shape[0]
            matrix[:, half:] += self._time_step * matrix[:, :half]
        return matrix

    def _motion(self, state: State) -> FloatArray:
        return self._moved(super()._motion(state), -1.0)

    def _state(self, motions: FloatArray) -> State:
        return super()._state(self._moved(motions, 1.0))

    def _moved(self, motions: FloatArray, steps: float) -> FloatArray:
        """Move positions by steps forth or back, if this lane holds those of the step before."""
        position, velocity = np.split(motions, 2, axis=-1)
        if self._lag:
            position = position + steps * self._time_step * velocity
        return np.concatenate([position, velocity], axis=-1)

    def _begin(self, motion: FloatArray) -> Step:
        from pymunk import batch

        self._space, self._bodies = self._new_space(motion)
        space, half = self._space, motion.size // 2
        read, fields = batch.Buffer(), batch.BodyFields.POSITION | batch.BodyFields.VELOCITY
        get_bodies, set_bodies, force_field = batch.get_space_bodies, batch.set_space_bodies, batch.BodyFields.FORCE
        # pymunk allocates its memory at the first reading and uses it from then on.
        get_bodies(space, fields, read)
        bodies = np.frombuffer(read.float_buf()).reshape(-1, 4)
        # The space's own body, where something hangs on it, comes last.
        loads, forces = batch.Buffer(), np.zeros((len(bodies), 2))
        loads.set_float_buf(forces)
        forces[:half, 1] = self._pressing
        along, position, velocity = forces[:half, 0], bodies[:half, 0], bodies[:half, 2]
        positions, velocities = motion[:half], motion[half:]
        advance, clear, time_step = space.step, read.clear, self._time_step

        def step(force: FloatArray) -> None:
            along[:] = force
            set_bodies(space, force_field, loads)
            advance(time_step)
            clear()
            get_bodies(space, fields, read)
            positions[:] = position
            velocities[:] = velocity

        return step
