"""MJX's joint formulation: MuJoCo's own model, the dry friction of a slide joint."""

from engines.interface.presets import NormalForce, Option, Preset

SOFTNESS = 1e-4
"""Part of its velocity that a stuck joint keeps in a step: 1 - d for MuJoCo's hardest d, its mjMAXIMP of 0.9999."""

JOINT_TUNED = Preset(
    "MuJoCo's hardest friction, solved to round-off: a ten-thousandth softer than that of equation (5).",
    {
        "units": Option(
            "light", "SI", "Large forces: MJX's Newton ends where none that is missing is more than 1e-8, see its norm."
        ),
        "solver": Option("Newton", "Newton", "MJX has no dual solver."),
        "tolerance": Option(1e-20, 1e-8, "The solver ends where a step of it gains no more than round-off."),
        "noslip_iterations": Option(0, 0, "MJX has no sweep without softness, and would ignore one without a warning."),
        "jacobian": Option("dense", "auto", "The matrices are small."),
        "integrator": Option("Euler", "Euler", "Velocities first, then positions, as equation (5)."),
        "disable": Option(("eulerdamp", "warmstart"), (), "Damping at the start of the step; no warm start."),
        "iterations": Option(
            100, 100, "MuJoCo's own. A dozen suffice in most steps; MJX does not report the other ones."
        ),
        "cone": Option("pyramidal", "pyramidal", "There are no contacts."),
        "solref_friction": Option(
            (-1.0, -1.0), (0.02, 1.0), "Direct form, in units of d_width / dt: a stuck contact stops in one step."
        ),
        "solimp_friction": Option((1 - SOFTNESS, 1 - SOFTNESS), (0.9, 0.95), "MuJoCo's hardest."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    residual_slip_compliance=SOFTNESS,
    normal_force=NormalForce.MODULATED,
)
