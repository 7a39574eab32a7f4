"""Box2D's joint formulation: in every cell the motor of a prismatic joint, or a friction joint."""

from typing import Any

from engines.box2d.bodies import DEFAULT_OPTIONS, Box2DLane
from engines.box2d.law import own_springs
from engines.interface.presets import NormalForce, Option, Preset
from engines.shared.known_deviations import IMPLICIT_SPRINGS
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

JOINT_TUNED = Preset(
    "Motors of bounded force in prismatic joints; springs, dashpots and drive as forces at the start of the step.",
    {
        "units": Option("lane", "SI", "Steps stay far below the two units at which Box2D cuts them off."),
        "springs": Option("forces", "distance joints", "At the start of the step, as in equation (5)."),
        "joint": Option("prismatic", "friction", "Friction joints do not bound impulses below 1.2e-7."),
        "velocityIterations": Option(1, 8, "Frictions do not touch each other's masses: the first sweep is exact."),
        "positionIterations": Option(1, 3, "There is nothing to correct across the motion."),
        "warmStarting": Option(False, True, "Sweeps start from zero, not from the last impulses."),
        "AllowSleeping": Option(False, True, "Box2D stops what is slower than 0.01 for half a unit of time."),
    },
    shares_scheme=True,
    split_tolerance=0.0,
    normal_force=NormalForce.MODULATED,
)

JOINT_DEFAULT = Preset(
    "Friction joints, and distance joints as springs, in SI units, with the iterations that Box2D's manual suggests.",
    {**DEFAULT_OPTIONS, "joint": Option("friction", "friction", "Box2D's own for dry friction.")},
    # Sweeps that have not converged go on from the last impulses, which a state does not hold.
    known_deviation=IMPLICIT_SPRINGS,
    law=own_springs,
    split_tolerance=1e-5,
    normal_force=NormalForce.MODULATED,
)

FINENESS = 2.0**20
"""Unit of length over the lane's own: no step comes near the length at which Box2D cuts it off."""


class Box2DJointLane(Box2DLane):
    """One chain with a joint in every cell."""

    def __init__(self, lane: Lane, preset: Preset):
        """Take the lane's parameters in its units."""
        self._by_motor = preset["joint"] == "prismatic"
        super().__init__(lane, preset, FINENESS)

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
