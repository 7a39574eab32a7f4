"""The laws of MuJoCo Warp's default friction: those of MuJoCo, solved in single precision to its own tolerance."""

from dataclasses import replace

from engines.interface.law import Law
from engines.interface.presets import Preset
from engines.mujoco import law as mujoco_law

NEWTON_PERIOD = 4e-5
"""Of U0: MuJoCo Warp stops at a tolerance of 1e-6, a hundred times MuJoCo's, which leaves ten times the acceleration,
and ten times the 4e-6 U0 that this makes of a period; roundings in single precision are some 3e-6 U0."""

NEWTON_REASON = "MuJoCo Warp's Newton solver stops at a tolerance of 1e-6, and computes in single precision"


def joint_friction(preset: Preset) -> Law:
    """Give the law of a joint's frictionloss."""
    return replace(mujoco_law.joint_friction(preset), period_bound=NEWTON_PERIOD, bound_reason=NEWTON_REASON)


def pyramidal_contact(preset: Preset) -> Law:
    """Give the law of a sphere that is held at a fixed depth."""
    return replace(mujoco_law.pyramidal_contact(preset), period_bound=NEWTON_PERIOD, bound_reason=NEWTON_REASON)
