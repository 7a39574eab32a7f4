"""Options and presets of Box2D, and the law of its own springs: an implicit Euler step, in single precision."""

from dataclasses import replace

from multibody_xval.engines.interface.law import Law
from multibody_xval.engines.interface.presets import NormalForce, Option, Preset
from multibody_xval.engines.shared.claims import IMPLICIT_SPRINGS
from reference_lcp.schemes.linear_implicit import LinearImplicitLane, LinearStep

SINGLE_PRECISION_PERIOD = 3e-5
"""Of U0: the stretch of a spring is the difference of two lengths of 64 U0, rounded to 64 U0 · 2^-24 = 4e-6 U0; a
period makes one to three of them."""


def own_springs(preset: Preset) -> Law:
    """Give the law of distance joints as springs; it has no constants beside the chain's."""
    return Law(
        formula="(M + h C + h² K) q̇⁺ = M q̇ − h K q + h f(t) e_1 + W p; Coulomb's law",
        model=lambda lane, _: LinearImplicitLane(lane, LinearStep.implicit(lane.chain, lane.time_step)),
        period_bound=SINGLE_PRECISION_PERIOD,
        bound_growth=0.5,
        bound_reason="single precision: a spring of 64 U0 is rounded to 4e-6 U0",
        modulated=preset.represents(NormalForce.MODULATED),
    )


OPTIONS = {
    "units": Option.own("SI", "The chain in SI units."),
    "springs": Option.own("distance joints", "Box2D's own: implicit, which damps every vibration."),
    "velocityIterations": Option.own(8, "Suggested by Box2D's manual; coupled springs are solved by sweeps."),
    "positionIterations": Option.own(3, "Suggested by Box2D's manual."),
    "warmStarting": Option.own(True, "Box2D's own: sweeps start from the impulses of the step before."),
    "AllowSleeping": Option.own(True, "Box2D's own."),
}

TUNED = {
    "springs": ("forces", "At the start of the step, as in equation (5)."),
    "warmStarting": (False, "Sweeps start from zero, not from the last impulses."),
    "AllowSleeping": (False, "Box2D stops what is slower than 0.01 for half a unit of time."),
}
"""What the tuned presets of both formulations change alike."""

JOINT_OPTIONS = {**OPTIONS, "joint": Option.own("friction", "Box2D's own for dry friction.")}

JOINT_TUNED = Preset(
    "Motors of bounded force in prismatic joints; springs, dashpots and drive as forces at the start of the step.",
    JOINT_OPTIONS,
    {
        **TUNED,
        "units": ("lane", "Steps stay far below the two units at which Box2D cuts them off."),
        "joint": ("prismatic", "Friction joints do not bound impulses below 1.2e-7."),
        "velocityIterations": (1, "Frictions do not touch each other's masses: the first sweep is exact."),
        "positionIterations": (1, "There is nothing to correct across the motion."),
    },
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

JOINT_DEFAULT = Preset(
    "Friction joints, and distance joints as springs, in SI units, with the iterations that Box2D's manual suggests.",
    JOINT_OPTIONS,
    # Sweeps that have not converged go on from the last impulses, which a state does not hold.
    known_deviation=IMPLICIT_SPRINGS,
    law=own_springs,
    split_tolerance=1e-5,
    normal_force=NormalForce.MODULATED,
)

CONTACT_TUNED = Preset(
    "Boxes pressed on plates; springs, dashpots and drive as forces at the start of the step.",
    OPTIONS,
    {
        **TUNED,
        "units": ("lane", "Boxes are about as large as Box2D is made for."),
        "velocityIterations": (2, "Friction comes before the normal force, and is right in the second sweep."),
        "positionIterations": (1, "Boxes start as near to their plates as Box2D leaves them."),
    },
    shares_scheme=True,
    judged=("chain", "blocks"),
)

CONTACT_DEFAULT = Preset(
    "The same boxes, and distance joints as springs, in SI units, with the iterations that Box2D's manual suggests.",
    OPTIONS,
    # Sweeps that have not converged go on from the last impulses, which a state does not hold.
    known_deviation=IMPLICIT_SPRINGS,
    law=own_springs,
    split_tolerance=1e-5,
)

JOINT_RECOMMENDED = replace(
    JOINT_DEFAULT,
    description="For joints of any model: more sweeps; one joint holds as it comes, and an arm sags less.",
    changes={"velocityIterations": (30, "Motors and pins of an arm are solved together, by sweeps.")},
    optional=True,
    judged=("scenes",),
)

CONTACT_RECOMMENDED = replace(
    CONTACT_DEFAULT,
    description="For contacts of any model: as Box2D comes; more sweeps help tall stacks alone.",
    optional=True,
    judged=("scenes",),
)
