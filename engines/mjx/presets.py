"""MJX's presets: MuJoCo's settings, changed for a solver without a sweep that removes the softness of friction."""

from dataclasses import replace

from engines.interface.presets import NormalForce, Option, Preset
from engines.mujoco.presets import HARDEST, JOINT_OPTIONS, NO_CONTACTS, SOLIMP, TUNED, stops_in_one_step
from engines.mujoco.presets import JOINT_RECOMMENDED as OF_MUJOCO

SOFTNESS = 1e-4
"""Part of its velocity that a stuck joint keeps in a step: 1 - d for MuJoCo's hardest d."""

JOINT_TUNED = Preset(
    "MuJoCo's hardest friction, solved to round-off: a ten-thousandth softer than that of equation (5).",
    {
        **JOINT_OPTIONS,
        "tolerance": Option(1e-20, 1e-8, "The solver ends where a step of it gains no more than round-off."),
        "solimp_friction": Option((HARDEST, HARDEST), SOLIMP, "MuJoCo's hardest."),
    },
    {
        "units": (
            "light",
            "Large forces: MJX's Newton ends where none that is missing is more than 1e-8, see its norm.",
        ),
        "solver": ("Newton", "MJX has no dual solver."),
        "noslip_iterations": (0, "MJX has no sweep without softness, and would ignore one without a warning."),
        "jacobian": TUNED["jacobian"],
        "integrator": TUNED["integrator"],
        "disable": (("eulerdamp", "warmstart"), "Damping at the start of the step; no warm start."),
        "iterations": (100, "MuJoCo's own. A dozen suffice in most steps; MJX does not report the other ones."),
        "cone": NO_CONTACTS,
        "solref_friction": stops_in_one_step(HARDEST),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    residual_slip_compliance=SOFTNESS,
    normal_force=NormalForce.MODULATED,
)

JOINT_RECOMMENDED = replace(OF_MUJOCO, varied={})
"""MuJoCo's, without sweeps that MJX ignores."""
