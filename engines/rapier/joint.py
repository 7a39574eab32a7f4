"""Rapier's joint formulation: in every cell a motor of bounded force that holds the slip velocity at zero."""

from typing import Any

from engines.interface.presets import NormalForce, Option, Preset
from engines.rapier.bodies import DEFAULT_OPTIONS, FOUR_SUBSTEPS, TUNED_OPTIONS, RapierLane
from engines.rapier.law import motor_substeps
from reference_lcp.validation import FloatArray

MOTOR = Option(1e9, None, "Damping of the motor: a smaller one lets stuck contacts creep.")

JOINT_TUNED = Preset(
    "Motors of bounded force between free bodies; springs, dashpots and drive as forces at the start of the step.",
    {**TUNED_OPTIONS, "motor factor": MOTOR},
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
)

JOINT_DEFAULT = Preset(
    "The same motors and forces in SI units, with Rapier's own four substeps a step.",
    {**DEFAULT_OPTIONS, "motor factor": MOTOR},
    known_deviation=FOUR_SUBSTEPS,
    law=motor_substeps,
    normal_force=NormalForce.MODULATED,
)


class RapierJointLane(RapierLane):
    """One chain with a motor in every cell."""

    def _hold(self, world: Any, outer: list[Any], inner: list[Any]) -> None:
        from rapier3d import GenericJoint, JointAxesMask, JointAxis, MotorModel

        self._axis, joints = JointAxis.LIN_X, world.impulse_joints
        # No axis is locked: bodies have their guides themselves.
        motor = (
            GenericJoint.builder(JointAxesMask.empty())
            .motor_velocity(self._axis, 0.0, self._preset["motor factor"])
            .motor_model(self._axis, MotorModel.FORCE_BASED)
        )
        bounded = [motor.motor_max_force(self._axis, bound) for bound in self._chain.friction_bound.tolist()]
        # The data of a joint is the joint's own, and no copy.
        self._joints = [
            joints[joints.insert(*pair, joint)].data for *pair, joint in zip(outer, inner, bounded, strict=True)
        ]

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        bounds = (self._chain.friction_coefficient * normal_load).tolist()
        for joint, bound in zip(self._joints, bounds, strict=True):
            joint.set_motor_max_force(self._axis, bound)

    def _contacts(self) -> list[float]:
        """Read impulses of the last substep over its length; Rapier gives them as they act on the outer mass."""
        rate, axis = -self._preset["num_solver_iterations"] / self._time_step, self._axis
        return [rate * joint.motor(axis).impulse for joint in self._joints]
