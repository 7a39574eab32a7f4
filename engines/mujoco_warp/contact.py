"""MuJoCo Warp's contact formulation: MuJoCo's own model, a sphere that dips into a plate at a fixed depth."""

from dataclasses import replace

from engines.interface.presets import NormalForce, Option, Preset
from engines.mujoco import contact as mujoco_contact
from engines.mujoco_warp.law import pyramidal_contact
from engines.mujoco_warp.model import TUNED_OPTIONS

CONTACT_TUNED = Preset(
    "The elliptic cone under a normal force that friction hardly changes, and a sweep without softness: equation (5).",
    {
        **TUNED_OPTIONS,
        "cone": Option("elliptic", "pyramidal", "The pyramid's edges change the normal force with friction."),
        "solimp": Option((1e-4, 1e-4), (0.9, 0.95), "MuJoCo's softest: friction hardly raises the normal force."),
        "solreffriction": Option(
            (-1.0, -1.0), (0.0, 0.0), "Direct form, in units of d_width / dt: a stuck contact stops in one step."
        ),
        "normal time constant": Option(0.02, 0.02, "Of solref [s]; its stiffness is chosen so that N = λ_N."),
        "coefficient": Option(
            0.01, None, "Contacts are pressed with F / 0.01: what friction adds to the normal force goes with μ²."
        ),
    },
    shares_scheme=True,
    turns=True,
)

CONTACT_DEFAULT = replace(
    mujoco_contact.CONTACT_DEFAULT,
    law=pyramidal_contact,
    split_tolerance=1e-6,
    normal_force=NormalForce.CONSTANT,
    modulated_options={},
    inclines=False,
)
