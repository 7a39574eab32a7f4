"""Box2D's joint formulation: in every cell the motor of a prismatic joint, or a friction joint."""

import math
from typing import Any

import numpy as np

from engines.box2d_bodies import Box2DLane
from engines.interface import Option, Preset
from engines.units import power_of_two
from reference_lcp.simulation import Lane
from reference_lcp.validation import FloatArray

JOINT_TUNED = Preset(
    "Motors of bounded force in prismatic joints; springs, dashpots and drive as forces at the start of the step.",
    {
        "units": Option("lane", "SI", "Steps stay far below the two units at which Box2D cuts them off."),
        "springs": Option("forces", "distance joints", "At the start of the step, as in equation (5)."),
        "joint": Option("prismatic", "friction", "Friction joints do not bound impulses below 1.2e-7."),
        "velocityIterations": Option(1, 8, "Frictions do not touch each other's masses: the first sweep is exact."),
        "positionIterations": Option(1, 3, "There is nothing to correct across the motion."),
        "warmStarting": Option(False, True, "No memory of the last impulses."),
        "AllowSleeping": Option(False, True, "Box2D stops what is slower than 0.01 for half a unit of time."),
    },
    shares_scheme=True,
    split_tolerance=0.0,
)

JOINT_DEFAULT = Preset(
    "Friction joints, and distance joints as springs, in SI units, with the iterations that Box2D's manual suggests.",
    {
        "units": Option("SI", "SI", "The numbers of the chain as they are."),
        "springs": Option("distance joints", "distance joints", "Box2D's own: implicit, which damps every vibration."),
        "joint": Option("friction", "friction", "Box2D's own for dry friction."),
        "velocityIterations": Option(8, 8, "Of the manual; springs that pull on each other are solved by sweeps."),
        "positionIterations": Option(3, 3, "Of the manual."),
        "warmStarting": Option(True, True, "Box2D's own: sweeps start from the impulses of the step before."),
        "AllowSleeping": Option(True, True, "Box2D's own."),
    },
    # Sweeps that have not converged go on from the last impulses, which a state does not hold.
    split_tolerance=1e-5,
)

LENGTH = 2.0**6
"""Length of a spring over the displacement scale: it acts along the line of its anchors, and is rounded to 2^-24."""


class Box2DJointLane(Box2DLane):
    """One chain with a joint in every cell."""

    def __init__(self, lane: Lane, preset: Preset):
        """Take the lane's parameters in its units."""
        self._own_springs = preset["springs"] == "distance joints"
        self._by_motor = preset["joint"] == "prismatic"
        super().__init__(lane, preset)

    def _force_matrix(self) -> FloatArray:
        """Only the drive is left where Box2D has the springs."""
        matrix = super()._force_matrix()
        return np.zeros_like(matrix) if self._own_springs else matrix

    def _new_holders(self, world: Any, bodies: list[Any]) -> list[Any]:
        cells, here = self._chain.cells, (0.0, 0.0)
        if self._own_springs:
            self._add_springs(world, bodies)
        joints = []
        for outer, inner, bound in zip(
            bodies[:cells], bodies[cells:], self._chain.friction_bound.tolist(), strict=True
        ):
            ends = {"bodyA": outer, "bodyB": inner, "localAnchorA": here, "localAnchorB": here}
            if self._by_motor:
                motor = {"enableMotor": True, "motorSpeed": 0.0, "maxMotorForce": bound}
                joints.append(world.CreatePrismaticJoint(localAxisA=(1.0, 0.0), **ends, **motor))
            else:
                joints.append(world.CreateFrictionJoint(maxForce=bound, maxTorque=0.0, **ends))
        return joints

    def _add_springs(self, world: Any, bodies: list[Any]) -> None:
        """Add springs and dashpots as distance joints: by the frequency and the damping ratio of their two masses."""
        chain, cells = self._chain, self._chain.cells
        length = LENGTH * power_of_two(self.lane.drive.displacement_scale(self.lane.chain)) / self._units.length
        ground = world.CreateStaticBody()
        outer, inner = bodies[:cells], bodies[cells:]
        for left, right, stiffness, damping in (
            *zip([ground, *outer[:-1]], outer, chain.chain_stiffness, chain.chain_damping, strict=True),
            *zip(outer, inner, chain.inner_stiffness, chain.inner_damping, strict=True),
        ):
            # All bodies stand in one place; the right end of a spring is an anchor that its body carries ahead of it.
            ends = {"bodyA": left, "bodyB": right, "localAnchorA": (0.0, 0.0), "localAnchorB": (length, 0.0)}
            mass = right.mass if left is ground else 1 / (1 / left.mass + 1 / right.mass)
            omega = math.sqrt(stiffness / mass)
            spring = {"frequencyHz": omega / (2 * math.pi), "dampingRatio": damping / (2 * mass * omega)}
            world.CreateDistanceJoint(length=length, **ends, **spring)

    def _contacts(self) -> list[float]:
        """Read impulses over the time step, which act on the inner mass."""
        rate = 1 / self._time_step
        if self._by_motor:
            return [joint.GetMotorForce(rate) for joint in self._holders]
        return [joint.GetReactionForce(rate).x for joint in self._holders]
