"""Lanes of Box2D, whatever holds their masses together: bodies, springs, how they are set and read, and units."""

import dataclasses
import functools
import importlib
import math
import warnings
from abc import abstractmethod
from operator import attrgetter
from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.force_loop import ExplicitForcesLane, Step
from multibody_xval.engines.shared.units import Units, power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

SPRING_LENGTH = 2.0**6
"""Length of a spring over the displacement scale: it acts along the line of its anchors, and is rounded to 2^-24."""

FARTHEST = 2.0
"""Distance in an engine's units at which Box2D cuts the displacement of a step off, without a message."""


def finer_units(name: str, lane: Lane, *, length: float) -> Units:
    """Give the units of a preset, the lane's own with a unit of length so many times as long."""
    units = Units.named(name, lane)
    return units if name == "SI" else dataclasses.replace(units, length=length * units.length)


class Box2DLane(ExplicitForcesLane):
    """One chain; a run makes its world anew, for joints and contacts keep their last impulses."""

    def __init__(self, lane: Lane, preset: Preset):
        self._own_springs = preset["springs"] == "distance joints"
        super().__init__(lane, preset)
        self._iterations = preset["velocityIterations"], preset["positionIterations"]
        # Where bodies are across the motion, and the forces on them there.
        self._heights, self._pressing = np.zeros((2, 2 * lane.chain.cells))

    @abstractmethod
    def _hold(self, world: Any, outer: list[Any], inner: list[Any]) -> None:
        """Add what makes friction between the masses of each cell."""

    def _begin(self, motion: FloatArray) -> Step:
        self._world, bodies = self._new_world(motion)
        # These refer to the memory of the bodies: they are made once, and always hold what is there.
        held = [body.position for body in bodies] + [body.linearVelocity for body in bodies]
        pushes, across = [body.ApplyForceToCenter for body in bodies], self._pressing.tolist()
        along, advance, time_step, (sweeps, corrections) = (
            attrgetter("x"), self._world.Step, self._time_step, self._iterations
        )  # fmt: skip

        def step(force: FloatArray) -> None:
            for push, value, normal_load in zip(pushes, force.tolist(), across, strict=True):
                push((value, normal_load), True)
            advance(time_step, sweeps, corrections)
            motion[:] = list(map(along, held))

        return step

    def _new_world(self, motion: FloatArray) -> tuple[Any, list[Any]]:
        """Make the world with this motion; give it and its bodies, outer masses first."""
        package = import_box2d()
        world = package.b2World(gravity=(0.0, 0.0))
        # The argument doSleep of a world does nothing.
        world.SetAllowSleeping(self._preset["AllowSleeping"])
        world.warmStarting = self._preset["warmStarting"]
        masses = np.concatenate([self._chain.outer_mass, self._chain.inner_mass])
        places = np.column_stack([motion.reshape(2, -1)[0], self._heights])
        bodies = [
            world.CreateDynamicBody(position=tuple(place), linearVelocity=(velocity, 0.0), fixedRotation=True)
            for place, velocity in zip(places.tolist(), motion[masses.size :].tolist(), strict=True)
        ]
        outer, inner = bodies[: len(bodies) // 2], bodies[len(bodies) // 2 :]
        self._hold(world, outer, inner)
        # Afterwards, for whatever changes a body's rotation or shape makes its mass another one.
        for body, mass in zip(bodies, masses.tolist(), strict=True):
            body.massData = package.b2MassData(mass=mass, I=0.0, center=(0.0, 0.0))
        if self._own_springs:
            self._add_springs(world, outer, inner)
        return world, bodies

    def _add_springs(self, world: Any, outer: list[Any], inner: list[Any]) -> None:
        """Add springs and dashpots as distance joints: by the frequency and the damping ratio of their two masses.

        The right end of a spring is an anchor that its body carries ahead of it, at the height of the left end.
        """
        chain = self._chain
        length = SPRING_LENGTH * power_of_two(self.lane.drive.displacement_scale(self.lane.chain)) / self._units.length
        ground = world.CreateStaticBody(position=(0.0, float(self._heights[0])))
        for left, right, stiffness, damping in (
            *zip([ground, *outer[:-1]], outer, chain.chain_stiffness, chain.chain_damping, strict=True),
            *zip(outer, inner, chain.inner_stiffness, chain.inner_damping, strict=True),
        ):
            mass = right.mass if left is ground else 1 / (1 / left.mass + 1 / right.mass)
            omega = math.sqrt(stiffness / mass)
            world.CreateDistanceJoint(
                bodyA=left, bodyB=right,
                localAnchorA=(0.0, 0.0), localAnchorB=(length, left.position.y - right.position.y), length=length,
                frequencyHz=omega / (2 * math.pi), dampingRatio=damping / (2 * mass * omega), collideConnected=True,
            )  # fmt: skip


@functools.cache
def import_box2d() -> Any:
    """Import Box2D, whose warnings at import end the interpreter where warnings are errors."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return importlib.import_module("Box2D")


class Box2DJointLane(Box2DLane):
    """One chain with a joint in every cell."""

    units_of = staticmethod(functools.partial(finer_units, length=2.0**20))
    """Units so long that no step comes near Box2D's `FARTHEST`."""

    def __init__(self, lane: Lane, preset: Preset):
        super().__init__(lane, preset)
        self._by_motor = preset["joint"] == "prismatic"

    def _hold(self, world: Any, outer: list[Any], inner: list[Any]) -> None:
        here, self._joints = (0.0, 0.0), []
        for left, right, bound in zip(outer, inner, self._chain.friction_bound.tolist(), strict=True):
            ends = {"bodyA": left, "bodyB": right, "localAnchorA": here, "localAnchorB": here}
            if self._by_motor:
                motor = {"enableMotor": True, "motorSpeed": 0.0, "maxMotorForce": bound}
                self._joints.append(world.CreatePrismaticJoint(localAxisA=(1.0, 0.0), **ends, **motor))
            else:
                self._joints.append(world.CreateFrictionJoint(maxForce=bound, maxTorque=0.0, **ends))

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        name = "maxMotorForce" if self._by_motor else "maxForce"
        for joint, bound in zip(self._joints, (self._chain.friction_coefficient * normal_load).tolist(), strict=True):
            setattr(joint, name, bound)

    def _contacts(self) -> list[float]:
        """Read impulses over the time step, which act on the inner mass."""
        rate = 1 / self._time_step
        if self._by_motor:
            return [joint.GetMotorForce(rate) for joint in self._joints]
        return [joint.GetReactionForce(rate).x for joint in self._joints]
