"""The law of MuJoCo Warp's friction of joints: MuJoCo's, solved to another tolerance and in single precision."""

from dataclasses import replace

from multibody_xval.engines.interface.laws import Law
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.mujoco import law as mujoco

NEWTON_PERIOD = 4e-5
"""Of U0: MuJoCo Warp stops at a tolerance of 1e-6, a hundred times MuJoCo's, which leaves ten times the acceleration,
and ten times the 4e-6 U0 that this makes of a period; roundings in single precision are some 3e-6 U0."""


def joint_friction(preset: Preset) -> Law:
    """Give the law of a joint's frictionloss."""
    return replace(
        mujoco.joint_friction(preset),
        bound=NEWTON_PERIOD,
        bound_reason="MuJoCo Warp's Newton solver stops at a tolerance of 1e-6, and computes in single precision",
    )


LAWS = {"joint:recommended": joint_friction, "joint:default": joint_friction}
"""By formulation and preset."""
