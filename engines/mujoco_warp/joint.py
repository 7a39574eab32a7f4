"""MuJoCo Warp's joint formulation: MuJoCo's own model, the dry friction of a slide joint."""

from engines.interface.presets import NormalForce, Option, Preset
from engines.mujoco.model import DEFAULT_OPTIONS
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

JOINT_DEFAULT = Preset(
    "A joint's frictionloss in SI units, and MuJoCo's own options.",
    {
        **DEFAULT_OPTIONS,
        "solref_friction": Option(
            (0.02, 1.0), (0.02, 1.0), "MuJoCo's own: a time constant of 0.02 s, whatever the time step."
        ),
    },
    known_deviation=(
        "friction is a soft constraint with a time constant, whatever the time step: a stuck contact comes to rest "
        "with one of 10.6 ms and creeps, and a finer step does not help"
    ),
    law=joint_friction,
    split_tolerance=1e-6,
    normal_force=NormalForce.MODULATED,
)
