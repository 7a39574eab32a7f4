"""Rapier's own settings, and the presets that change them."""

from dataclasses import replace

from multibody_xval.engines.interface.presets import NormalForce, Option, Preset
from multibody_xval.engines.rapier.step_model import contact_substeps, motor_substeps

OPTIONS = {
    "units": Option.own("SI", "The chain in SI units."),
    "num_solver_iterations": Option.own(4, "Rapier's own: four substeps, over which forces are constant."),
    "normalized_max_linear_velocity": Option.own(400.0, "Rapier's own, in m/s."),
    "can_sleep": Option.own(True, "Rapier's own; forces keep bodies awake in steps of less than half a second."),
}

JOINT_OPTIONS = {
    **OPTIONS,
    "motor factor": Option(1e9, None, "Damping of the motor: a smaller one lets stuck contacts creep."),
}

CONTACT_OPTIONS = {
    **OPTIONS,
    "friction_model": Option(
        "COULOMB", "SIMPLIFIED", "Reports friction; bodies that do not turn move the same to single precision."
    ),
    "friction_in_bias_pass": Option.own(False, "Rapier's own."),
    "warmstart_coefficient": Option.own(1.0, "Rapier's own: substeps start from the last impulses."),
    "contact_recycling": Option.own(True, "Rapier's own."),
}

TUNED = {
    "units": ("lane", "Numbers of order one, and a step so long that motors and contacts are hard."),
    "num_solver_iterations": (1, "Iterations are substeps; one of them is the step of equation (5)."),
    "normalized_max_linear_velocity": (1e30, "No motion is cut off, however large."),
    "can_sleep": (False, "Every step of half a unit of time or more would stop the bodies."),
}
"""What the tuned presets of both formulations change alike."""

FOUR_SUBSTEPS = (
    "forces stay as they were over four substeps: positions move by 5/8 of what a force makes in a step of the "
    "reference, an error of first order"
)

JOINT_TUNED = Preset(
    "Dry friction emulated by velocity motors of bounded force between free bodies; springs and drive as forces.",
    JOINT_OPTIONS,
    TUNED,
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

JOINT_DEFAULT = Preset(
    "The same emulation and forces in SI units, with Rapier's own four substeps a step.",
    JOINT_OPTIONS,
    known_deviation=FOUR_SUBSTEPS,
    law=motor_substeps,
    normal_force=NormalForce.MODULATED,
)

JOINT_NATIVE = Preset(
    "Rapier's own dry friction, the frictionloss of slides in an MJCF file, loaded as a multibody.",
    {name: option for name, option in OPTIONS.items() if name != "can_sleep"},
    {name: change for name, change in TUNED.items() if name != "can_sleep"},
    shares_scheme=True,
    optional=True,
)

CONTACT_TUNED = Preset(
    "Spheres pressed on plates; springs, dashpots and drive as forces at the start of the step.",
    CONTACT_OPTIONS,
    {
        **TUNED,
        "friction_in_bias_pass": (
            True,
            "Friction is found before positions move, and not after them with that of the step before.",
        ),
        "warmstart_coefficient": (0.0, "Sweeps start from zero, not from the last impulses."),
        "contact_recycling": (
            False,
            "Friction found before positions move aims at where recycled points were, and reverses late.",
        ),
    },
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
    turns=True,
    judged=("chain", "blocks"),
)

CONTACT_DEFAULT = Preset(
    "The same spheres and forces in SI units, with Rapier's own four substeps a step.",
    CONTACT_OPTIONS,
    known_deviation=FOUR_SUBSTEPS,
    law=contact_substeps,
    # Positions move by the friction of the substep before, which a state does not hold: a run starts with that of its
    # own first step, which is another one by the change of friction in a step, 1e-2 of h² μ λ_N / m.
    split_tolerance=1e-6,
    normal_force=NormalForce.MODULATED,
    turns=True,
)

JOINT_RECOMMENDED = replace(
    JOINT_DEFAULT,
    description="For joints of any model: reduced coordinates, in which one hinge holds; no option holds an arm.",
    options={
        **JOINT_OPTIONS,
        "joints": Option.own("impulse", "As most write them: pins and motors are solved together."),
    },
    changes={
        "joints": ("multibody", "A pin cannot give way, and one hinge holds. The chain's masses are free bodies.")
    },
    optional=True,
    judged=("scenes",),
)

CONTACT_RECOMMENDED = replace(
    CONTACT_DEFAULT,
    description="For contacts of any model: a few sweeps in every substep.",
    options={**CONTACT_OPTIONS, "num_internal_pgs_iterations": Option.own(1, "Rapier's own: one sweep a substep.")},
    changes={"num_internal_pgs_iterations": (4, "Stacks need them; more give no more.")},
    optional=True,
    varied={"num_internal_pgs_iterations": (20,), "num_solver_iterations": (1, 10)},
    judged=("scenes",),
)
