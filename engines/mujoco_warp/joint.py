"""MuJoCo Warp's joint formulation: MuJoCo's own model, the dry friction of a slide joint."""

from dataclasses import replace

from engines.interface.presets import NormalForce, Option, Preset
from engines.mujoco import joint as mujoco_joint
from engines.mujoco_warp.law import joint_friction
from engines.mujoco_warp.model import TUNED_OPTIONS

JOINT_TUNED = Preset(
    "One step of Newton, then one sweep without softness: friction stops a contact within a step, as in equation (5).",
    {
        **TUNED_OPTIONS,
        "cone": Option("pyramidal", "pyramidal", "There are no contacts."),
        "solref_friction": Option(
            (-1.0, -1.0), (0.02, 1.0), "Direct form, in units of d_width / dt: a stuck contact stops in one step."
        ),
    },
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
)

JOINT_DEFAULT = replace(mujoco_joint.JOINT_DEFAULT, law=joint_friction, split_tolerance=1e-6)
