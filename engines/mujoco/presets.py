"""MuJoCo's own settings, and the presets that change them."""

from multibody_xval.engines.interface.law import NotModelled
from multibody_xval.engines.interface.presets import ACROSS, FREE, HELD, NormalForce, OfStep, Option, Preset
from multibody_xval.engines.mujoco.step_model import (
    LARGEST_IMPEDANCE,
    LEAST_IMPEDANCE,
    joint_friction,
    pyramidal_contact,
)

SOLIMP = (LEAST_IMPEDANCE, LARGEST_IMPEDANCE)
"""d_0 and d_max: MuJoCo's own."""

SOFTEST, HARDEST = 1e-4, 0.9999
"""Least and largest impedance that MuJoCo takes: its mjMINIMP and mjMAXIMP."""

SOLREF = (0.02, 1.0)
"""Time constant [s] and damping ratio: MuJoCo's own."""

OPTIONS = {
    "units": Option.own("SI", "The chain in SI units."),
    "solver": Option.own("Newton", "MuJoCo's own."),
    "iterations": Option.own(100, "MuJoCo's own."),
    "noslip_iterations": Option.own(0, "MuJoCo's own: a stuck contact creeps."),
    "cone": Option.own("pyramidal", "MuJoCo's own."),
    "jacobian": Option.own("auto", "MuJoCo's own."),
    "integrator": Option.own("Euler", "MuJoCo's own."),
    "disable": Option.own((), "MuJoCo's own."),
}

JOINT_OPTIONS = {
    **OPTIONS,
    "solref_friction": Option.own(SOLREF, "MuJoCo's own: a time constant of 0.02 s, whatever the time step."),
}

CONTACT_OPTIONS = {
    **OPTIONS,
    ACROSS: Option.own(FREE, "As bodies rest on each other: a constant force presses the sphere on its plate."),
    "solreffriction": Option.own((0.0, 0.0), "MuJoCo's own: the damping of solref, for friction too."),
    "normal time constant": Option.own(
        SOLREF[0],
        "MuJoCo's own damping 2 / 0.02 s; the stiffness beside it is needed to make N = λ_N.",
        held=True,
    ),
}

TUNED = {
    "iterations": (1, "Frictions do not touch each other's masses, so that the first sweep is exact."),
    "noslip_iterations": (1, "One sweep without the regularisation R; with it, stuck contacts creep."),
    "jacobian": ("dense", "The matrices are small."),
    "integrator": ("Euler", "Velocities first, then positions, as equation (5)."),
    "disable": (
        ("eulerdamp", "warmstart", "island", "autoreset"),
        "Damping at the start of the step; no warm start; no search for islands; no silent reset.",
    ),
}
"""What the tuned presets of both formulations change alike."""

NO_CONTACTS = ("pyramidal", "There are no contacts.")


def stops_in_one_step(width: float) -> tuple[OfStep, str]:
    """Give the direct form of solref for friction, which MuJoCo divides by `width`, its d_width."""
    rate = f"-{width:g}/h"
    reason = "Direct form, with d_width of solimp over the step: a stuck contact stops in one step."
    return OfStep(f"{rate} {rate}", lambda step: (-width / step, -width / step)), reason


CHOSEN_STIFFNESS = (SOLREF[0], "Of solref [s]; its stiffness is chosen so that N = λ_N.")
ELLIPTIC = ("elliptic", "The pyramid's edges change the normal force with friction.")

HARD_COEFFICIENT = 0.01

EDGES_ROUND_OFF = 8 * 2.0**-53 / HARD_COEFFICIENT
"""Eight roundings, as many as a step of a position has, of the edges' forces: their difference is so much less."""

PRESSED_HARDER = {
    "solimp": Option((SOFTEST, SOFTEST), SOLIMP, "MuJoCo's softest: friction hardly raises the normal force."),
    "coefficient": Option(
        HARD_COEFFICIENT,
        None,
        f"Contacts are pressed with F / {HARD_COEFFICIENT}: what friction adds to the normal force goes with μ².",
    ),
}
"""Of contacts solved by Newton."""

JOINT_TUNED = Preset(
    "The dual solver without its softness: friction stops a contact at the end of the step, as equation (5) does.",
    JOINT_OPTIONS,
    {
        **TUNED,
        "units": ("lane", "No number comes near MuJoCo's built-in smallest and largest ones."),
        "solver": ("PGS", "The friction forces are the unknowns, and each solves its own equation."),
        "cone": NO_CONTACTS,
        "solref_friction": stops_in_one_step(LARGEST_IMPEDANCE),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

JOINT_DEFAULT = Preset(
    "A joint's frictionloss in SI units, and MuJoCo's own options.",
    JOINT_OPTIONS,
    known_deviation=(
        "friction is a soft constraint with a time constant, whatever the time step: a stuck contact comes to rest "
        "with one of 10.6 ms and creeps, and a finer step does not help"
    ),
    law=joint_friction,
    split_tolerance=1e-9,
    normal_force=NormalForce.MODULATED,
)

OWN_TOLERANCE = Option.own(1e-8, "MuJoCo's own: the solver stops before friction of a load that swings is found.")

CONVERGED = (1e-14, "With MuJoCo's own 1e-8 a body drifts by up to 0.1 mm/s whose load swings below the bound.")

HARDEST_STOPS = stops_in_one_step(HARDEST)

IS_HELD = (HELD, "A construct of this suite, exact for its chain: nothing moves across, whatever friction does.")

CONTACT_TUNED = Preset(
    "The elliptic cone, solved by one dual sweep and one without its softness: it then equals equation (5).",
    CONTACT_OPTIONS,
    {
        **TUNED,
        ACROSS: IS_HELD,
        "units": ("contact", "The sweep's fixed tolerances of 1e-10 are then far below every number."),
        "solver": ("PGS", "The dual problem: friction does not act back on the normal force."),
        "cone": ELLIPTIC,
        "solreffriction": stops_in_one_step(LARGEST_IMPEDANCE),
        "normal time constant": CHOSEN_STIFFNESS,
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.LIFTING,
    turns=True,
    modulated_options={
        "solimp": Option(
            (HARDEST, HARDEST), SOLIMP, "MuJoCo's hardest: a sphere sinks in by a thousandth of N δt² / m or so."
        ),
        "solref": Option(
            OfStep("-0.1(0.9999/h)² -0.9999/h", lambda step: (-0.1 * (HARDEST / step) ** 2, -HARDEST / step)),
            SOLREF,
            "Direct form, with d_width of solimp over the step: a landing stops in one step, and ten take the sphere "
            "out of the plate.",
        ),
        "solreffriction": Option(HARDEST_STOPS[0], (0.0, 0.0), HARDEST_STOPS[1]),
    },
    modulated_residual_slip_compliance=1e-4,
    judged=("chain", "blocks"),
)

CONTACT_NEWTON = Preset(
    "MuJoCo's own solver under a normal force that friction hardly changes, and a sweep without softness.",
    {**CONTACT_TUNED.options, **PRESSED_HARDER},
    {
        "solver": ("Newton", "The sweep after it decides what friction is."),
        "iterations": (5, "The normal forces are found in the first ones."),
        "solreffriction": stops_in_one_step(SOFTEST),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    residual_slip_compliance=EDGES_ROUND_OFF,
)

SOFT_EDGES = (
    "friction is a soft constraint with a time constant, whatever the time step, so that a stuck contact creeps; "
    "the edges of the pyramidal cone let friction press, and keep it below the bound"
)

CONTACT_DEFAULT = Preset(
    "A sphere that rests on its plate, pressed by a constant force, in SI units and with MuJoCo's own options.",
    CONTACT_OPTIONS,
    known_deviation=SOFT_EDGES,
    law=pyramidal_contact,
    split_tolerance=1e-9,
    normal_force=NormalForce.LIFTING,
    turns=True,
    modulated_options={
        "solimp": Option.own(SOLIMP, "MuJoCo's own: contacts are soft."),
        "solref": Option.own(SOLREF, "MuJoCo's own: a landing takes 0.02 s, whatever the time step."),
    },
    settles=False,
)

JOINT_RECOMMENDED = Preset(
    "For joints of any model: friction that stops a slip within two steps, as hard as MuJoCo lets it be.",
    {
        **JOINT_OPTIONS,
        "solimp_friction": Option.own(SOLIMP, "MuJoCo's own: friction is soft, and joints creep."),
        "tolerance": OWN_TOLERANCE,
    },
    {
        "tolerance": CONVERGED,
        "solref_friction": (
            OfStep("2h 1", lambda step: (2 * step, 1.0)),
            "The least time constant that MuJoCo lets friction have; its own of 0.02 s hides friction in fast motions.",
        ),
        "solimp_friction": ((0.9999, 0.9999), "MuJoCo's hardest: what is left of creep goes with the step."),
    },
    known_deviation="a stuck contact creeps by a thousandth of what it does by default, and sliding stops in two steps",
    law=joint_friction,
    split_tolerance=1e-9,
    normal_force=NormalForce.MODULATED,
    optional=True,
    varied={"noslip_iterations": (3,)},
    judged=("scenes",),
)

CONTACT_RECOMMENDED = Preset(
    "For contacts of any model: the elliptic cone, with friction far harder than the normal force.",
    {
        **CONTACT_OPTIONS,
        "impratio": Option.own(1.0, "MuJoCo's own: friction is as soft as the normal force."),
        "tolerance": OWN_TOLERANCE,
    },
    {
        "cone": ("elliptic", "The pyramid has too little friction aside of its edges, and impratio hardly helps it."),
        "impratio": (1e4, "Creep is that much less, at no cost; from 1e5 on the solver's own error is left."),
        "tolerance": CONVERGED,
    },
    known_deviation="a stuck contact creeps by a ten-thousandth of what it does by default; what slides still hops",
    law=lambda _: NotModelled("no model has the elliptic cone with impratio"),
    split_tolerance=1e-9,
    normal_force=NormalForce.LIFTING,
    turns=True,
    modulated_options=CONTACT_DEFAULT.modulated_options,
    optional=True,
    varied={"impratio": (100.0, 1000.0, 1e5), "noslip_iterations": (3,)},
    judged=("scenes",),
    accuracy={"drift": 0.5},
    accuracy_reason=(
        "Friction stays a soft constraint: under its own weight a box, or a stack of three, drifts by up to 0.45 µm/s, "
        "at any time step; impratio divides that."
    ),
    settles=False,
)
