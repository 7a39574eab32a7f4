"""Lanes of pymunk, whatever holds their masses together: the bodies, and how all are set and read at once."""

import math
from abc import abstractmethod
from typing import Any

import numpy as np

from engines.explicit_forces import ExplicitForcesLane, Step
from engines.interface import Preset
from engines.units import Units
from reference_lcp.simulation import Lane
from reference_lcp.validation import FloatArray


class PymunkLane(ExplicitForcesLane):
    """One chain; a run makes its space anew, for joints and contacts remember their last impulses.

    pymunk advances positions by the velocities at the start of a step, and then the velocities under the forces
    that were set. A lane that shares the scheme of equation (5) therefore holds the positions of the step before:
    its p is x - dt v, forces are those at p + dt v, and after a step p is the x that the step began with.
    """

    def __init__(self, lane: Lane, preset: Preset):
        """Take the lane's parameters in its units."""
        self._holders: list[Any] = []
        self._preset = preset
        # What turns a motion (p, v) into (x, v), at which forces are evaluated.
        self._lag = preset["positions"] == "of the step before"
        super().__init__(lane, Units.named(preset["units"], lane))

    def bare_steps(self, steps: int) -> None:
        """Take steps of the engine alone; see `BareStepping`."""
        space, _ = self._new_space(np.zeros(4 * self._chain.cells))
        step, time_step = space.step, self._time_step
        for _ in range(steps):
            step(time_step)

    @abstractmethod
    def _new_space(self, motion: FloatArray) -> tuple[Any, list[Any]]:
        """Make the space with this motion, and give what holds the masses of each cell together."""

    def _new_bodies(self, space: Any, motion: FloatArray) -> list[Any]:
        """Add bodies that do not turn, outer masses first."""
        import pymunk

        positions, velocities = np.split(motion, 2)
        masses = np.concatenate([self._chain.outer_mass, self._chain.inner_mass])
        bodies = []
        for mass, position, velocity in zip(masses, positions, velocities, strict=True):
            body = pymunk.Body(float(mass), math.inf)
            body.position, body.velocity = (float(position), 0.0), (float(velocity), 0.0)
            bodies.append(body)
        space.add(*bodies)
        return bodies

    def _force_matrix(self) -> FloatArray:
        matrix = super()._force_matrix()
        if self._lag:
            half = matrix.shape[0]
            matrix[:, half:] += self._time_step * matrix[:, :half]
        return matrix

    def _motion(self, state: Any) -> FloatArray:
        motion = super()._motion(state)
        return self._lagging(motion, -1.0)

    def _state(self, motions: FloatArray) -> Any:
        return super()._state(self._lagging(motions, 1.0))

    def _lagging(self, motions: FloatArray, sign: float) -> FloatArray:
        """Move positions by a step back or forth, if this lane holds those of the step before."""
        position, velocity = np.split(motions, 2, axis=-1)
        if self._lag:
            position = position + sign * self._time_step * velocity
        return np.concatenate([position, velocity], axis=-1)

    def _begin(self, motion: FloatArray) -> Step:
        from pymunk import batch

        space, self._holders = self._new_space(motion)
        half = motion.size // 2
        read, fields = batch.Buffer(), batch.BodyFields.POSITION | batch.BodyFields.VELOCITY
        get_bodies, set_bodies, force_field = batch.get_space_bodies, batch.set_space_bodies, batch.BodyFields.FORCE
        # pymunk allocates its memory at the first reading and uses it from then on.
        get_bodies(space, fields, read)
        bodies = np.frombuffer(read.float_buf()).reshape(-1, 4)
        # The space's own body, where something hangs on it, comes last.
        loads, forces = batch.Buffer(), np.zeros((len(bodies), 2))
        loads.set_float_buf(forces)
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
