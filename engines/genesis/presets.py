"""Genesis's own settings, and the presets that change them."""

from multibody_xval.engines.genesis.step_model import joint_friction, pyramidal_contact
from multibody_xval.engines.interface.law import NotModelled
from multibody_xval.engines.interface.presets import ACROSS, FREE, NormalForce, OfStep, Option, Preset
from multibody_xval.engines.mujoco.presets import IS_HELD, SOFT_EDGES, SOLIMP

OPTIONS = {
    "precision": Option("64", "32", "In single precision a stuck contact would be no better than MuJoCo Warp's."),
    "units": Option.own("SI", "The chain in SI units."),
    "integrator": Option.own("approximate_implicitfast", "Genesis's own."),
    "iterations": Option.own(25, "Genesis's own."),
}

JOINT_OPTIONS = {
    **OPTIONS,
    "noslip_iterations": Option.own(0, "Genesis's own: a stuck contact creeps."),
    "solimplimit": Option.own(SOLIMP, "Genesis's own: it takes a joint's friction for as soft as its limits."),
}

CONTACT_OPTIONS = {
    **OPTIONS,
    ACROSS: Option.own(FREE, "As bodies rest on each other: a constant force presses the sphere on its plate."),
    # Without these there are no contacts, and no message says so.
    "enable_adjacent_collision": Option(True, False, "Genesis lets a body through the one that carries it."),
    "enable_neutral_collision": Option(True, False, "And bodies through each other that touch from the start."),
    "friction_cone": Option.own("pyramidal", "Genesis's own."),
    "solimp": Option.own(SOLIMP, "Genesis's own."),
}

CHOICES = ("integrator", "friction_cone", "contact_resolution")
"""Options of which the value is the name of a choice of Genesis's."""

HARDEST = (0.9999, 0.9999)
"""d_0 and d_max, the largest that Genesis takes."""

TIME_CONSTANT = 0.01
"""Of `solref` [s]: Genesis's own."""

STOPS_IN_ONE_STEP = "Of solref: the reference acceleration is -ġ_T / dt, and stops a stuck contact."

VELOCITIES_FIRST = ("Euler", "Velocities first, then positions.")

JOINT_TUNED = Preset(
    "One step of Newton, then one sweep without softness: friction stops a contact within a step, as in equation (5).",
    {
        **JOINT_OPTIONS,
        "constraint_timeconst": Option(
            OfStep("2h/0.95", lambda step: 2 / SOLIMP[1] * step), TIME_CONSTANT, STOPS_IN_ONE_STEP
        ),
    },
    {
        "units": ("lane", "Numbers near one, and time steps for the unit of time: a scene has one step."),
        "integrator": VELOCITIES_FIRST,
        "iterations": (1, "The sweep after it decides what friction is."),
        "noslip_iterations": (
            1,
            "One sweep without softness: frictions do not touch each other's masses, so that it is exact.",
        ),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

OWN_JOINT = {
    **JOINT_OPTIONS,
    "constraint_timeconst": Option.own(TIME_CONSTANT, "Genesis's own, of solref [s], whatever the time step."),
}

IN_STEPS = {
    "units": ("steps", "A scene has one time step: masses, forces and accelerations keep their numbers in SI units."),
}

JOINT_DEFAULT = Preset(
    "A joint's frictionloss, and Genesis's own options.",
    OWN_JOINT,
    IN_STEPS,
    known_deviation=(
        "friction is a soft constraint with a time constant, whatever the time step: a stuck contact comes to rest "
        "with one of 5.3 ms and creeps, and a finer step does not help"
    ),
    law=joint_friction,
    split_tolerance=1e-9,
    normal_force=NormalForce.MODULATED,
)

JOINT_RECOMMENDED = Preset(
    "For joints of any model: friction that stops a slip within two steps, as hard as Genesis lets it be.",
    OWN_JOINT,
    {
        **IN_STEPS,
        "constraint_timeconst": (
            OfStep("2h", lambda step: 2 * step),
            "The least that Genesis lets friction have; its own of 0.01 s hides friction in fast motions.",
        ),
        "solimplimit": (HARDEST, "Genesis's hardest: what is left of creep goes with the step."),
    },
    known_deviation="a stuck contact creeps by a thousandth of what it does by default, and sliding stops in two steps",
    law=joint_friction,
    split_tolerance=1e-9,
    normal_force=NormalForce.MODULATED,
    optional=True,
    varied={"noslip_iterations": (1, 5)},
    judged=("scenes",),
)

CONTACT_TUNED = Preset(
    "The elliptic cone by Signorini's law: friction is bounded by the normal force, and leaves that as it is.",
    {
        **CONTACT_OPTIONS,
        "contact_resolution": Option("signorini", None, "Friction does not press; with the pyramid it would."),
        "tolerance": Option(1e-12, 1e-8, "Of the energy that a step of Newton gains, in units near one."),
        "impratio": Option(
            1e4,
            1.0,
            "Friction is harder than the normal force by this factor; above it, rounding costs more than it gains.",
        ),
        "constraint_timeconst": Option(
            OfStep("2h/0.9999", lambda step: 2 / 0.9999 * step), TIME_CONSTANT, STOPS_IN_ONE_STEP
        ),
    },
    {
        ACROSS: IS_HELD,
        "units": ("lane", "Time steps for the unit of time: a scene has one step."),
        "integrator": VELOCITIES_FIRST,
        "friction_cone": ("elliptic", "The edges of the pyramid change the normal force."),
        "iterations": (100, "Newton goes on to its tolerance."),
        "solimp": (HARDEST, "Genesis's hardest: with it, contacts creep less."),
    },
    shares_scheme=True,
    split_tolerance=1e-7,
    # (1 - d) / d over impratio.
    residual_slip_compliance=1e-8,
    judged=("chain", "blocks"),
)

OWN_CONTACT = {**CONTACT_OPTIONS, "constraint_timeconst": Option.own(TIME_CONSTANT, "Genesis's own, of solref [s].")}

CONTACT_DEFAULT = Preset(
    "A sphere that rests on its plate, pressed by a constant force, in SI units and with Genesis's own options.",
    OWN_CONTACT,
    known_deviation=SOFT_EDGES,
    law=pyramidal_contact,
    split_tolerance=1e-9,
    normal_force=NormalForce.LIFTING,
    batch_lanes=4,
)

CONTACT_RECOMMENDED = Preset(
    "For contacts of any model: the elliptic cone, with friction far harder than the normal force.",
    {
        **OWN_CONTACT,
        "impratio": Option.own(None, "Genesis's own: 100 with the elliptic cone, and 1 with the pyramid."),
    },
    {
        "friction_cone": ("elliptic", "The pyramid's edges creep, and let friction press."),
        "impratio": (1e4, "Creep is a hundredth of that with Genesis's own, at no cost."),
    },
    known_deviation="a stuck contact creeps by some millionths of what it does by default; what slides may still hop",
    law=lambda _: NotModelled("no model has the elliptic cone by Signorini's law"),
    split_tolerance=1e-9,
    normal_force=NormalForce.LIFTING,
    batch_lanes=4,
    optional=True,
    varied={"impratio": (100.0,)},
    judged=("scenes",),
)
