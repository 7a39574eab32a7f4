"""Lanes of Box2D, whatever holds their masses together: the bodies, how they are set and read, and their units."""

import dataclasses
import functools
import importlib
import warnings
from abc import abstractmethod
from operator import attrgetter
from typing import Any

import numpy as np

from engines.explicit_forces import ExplicitForcesLane, Step
from engines.interface import Preset
from engines.units import Units
from reference_lcp.simulation import Lane
from reference_lcp.validation import FloatArray

FINENESS = 2.0**20
"""Unit of length over the displacement scale: Box2D cuts displacements of two units a step off, without a word."""


class Box2DLane(ExplicitForcesLane):
    """One chain; a run makes its world anew, for joints and contacts remember their last impulses."""

    def __init__(self, lane: Lane, preset: Preset):
        """Take the lane's parameters in its units."""
        self._preset = preset
        self._holders: list[Any] = []
        super().__init__(lane, _units(lane, preset))
        self._iterations = preset["velocityIterations"], preset["positionIterations"]

    def bare_steps(self, steps: int) -> None:
        """Take steps of the engine alone, with bodies at rest kept awake; see `BareStepping`."""
        world, _, _ = self._new_world(np.zeros(4 * self._chain.cells))
        world.SetAllowSleeping(False)
        step, time_step, (velocity, position) = world.Step, self._time_step, self._iterations
        for _ in range(steps):
            step(time_step, velocity, position)

    @abstractmethod
    def _new_holders(self, world: Any, bodies: list[Any]) -> list[Any]:
        """Add what holds the masses of each cell together."""

    def _begin(self, motion: FloatArray) -> Step:
        world, bodies, self._holders = self._new_world(motion)
        # These refer to the memory of the bodies: they are made once, and always hold what is there.
        held = [body.position for body in bodies] + [body.linearVelocity for body in bodies]
        pushes, along = [body.ApplyForceToCenter for body in bodies], attrgetter("x")
        advance, time_step, (sweeps, corrections) = world.Step, self._time_step, self._iterations

        def step(force: FloatArray) -> None:
            for push, value in zip(pushes, force.tolist(), strict=True):
                push((value, 0.0), True)
            advance(time_step, sweeps, corrections)
            motion[:] = list(map(along, held))

        return step

    def _new_world(self, motion: FloatArray) -> tuple[Any, list[Any], list[Any]]:
        """Make the world with this motion; give it, its bodies, outer masses first, and what holds them together."""
        package = import_box2d()
        world = package.b2World(gravity=(0.0, 0.0))
        # The argument doSleep of a world does nothing.
        world.SetAllowSleeping(self._preset["AllowSleeping"])
        world.warmStarting = self._preset["warmStarting"]
        masses = np.concatenate([self._chain.outer_mass, self._chain.inner_mass])
        positions, velocities = np.split(motion, 2)
        bodies = []
        for mass, position, velocity in zip(masses.tolist(), positions.tolist(), velocities.tolist(), strict=True):
            body = world.CreateDynamicBody(position=(position, 0.0), linearVelocity=(velocity, 0.0), fixedRotation=True)
            # Afterwards, for what changes a body's rotation or shape makes its mass one again.
            body.massData = package.b2MassData(mass=mass, I=0.0, center=(0.0, 0.0))
            bodies.append(body)
        return world, bodies, self._new_holders(world, bodies)


@functools.cache
def import_box2d() -> Any:
    """Import Box2D, whose warnings at import end the interpreter where warnings are errors."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return importlib.import_module("Box2D")


def _units(lane: Lane, preset: Preset) -> Units:
    """Give SI units, or the lane's own with a unit of length that is long enough."""
    units = Units.named(preset["units"], lane)
    if preset["units"] == "SI":
        return units
    return dataclasses.replace(units, length=FINENESS * units.length)
