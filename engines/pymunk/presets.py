"""Options and presets of pymunk."""

from dataclasses import replace

from multibody_xval.engines.interface.presets import NormalForce, Option, Preset
from multibody_xval.engines.pymunk.step_model import damped_springs

OPTIONS = {
    "units": Option.own("SI", "The chain in SI units."),
    "springs": Option.own("damped springs", "pymunk's own, with dashpots that are implicit."),
    "positions": Option.own("as they are", "What Body.position and Body.velocity hold."),
    "iterations": Option.own(10, "pymunk's own."),
}

TUNED = {
    "springs": ("forces", "At the start of the step, as in equation (5)."),
    "positions": ("of the step before", "Chipmunk advances positions first: forces are evaluated after that."),
}
"""What the tuned presets of both formulations change alike."""

JOINT_OPTIONS = {
    **OPTIONS,
    "max_bias": Option(0.0, "infinite", "Needed: a pivot joint pulls its anchors together, as no friction does."),
}

JOINT_TUNED = Preset(
    "Pivot joints of bounded force; springs, dashpots and drive as forces at the start of equation (5)'s step.",
    JOINT_OPTIONS,
    {
        **TUNED,
        "units": ("lane", "No number comes near Chipmunk's built-in smallest ones."),
        "max_bias": (0.0, "A pivot joint pulls its anchors together, as no friction does."),
        "iterations": (1, "Frictions do not touch each other's masses, so that the first sweep is exact."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

JOINT_DEFAULT = Preset(
    "Pivot joints as pymunk's own examples use them for friction, and its damped springs, in SI units.",
    JOINT_OPTIONS,
    law=damped_springs,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
)

CONTACT_OPTIONS = {**OPTIONS, "collision_slop": Option.own(0.1, "pymunk's own.", fixed=True)}

CONTACT_TUNED = Preset(
    "Boxes pressed on plates; springs, dashpots and drive as forces at the start of equation (5)'s step.",
    CONTACT_OPTIONS,
    {
        **TUNED,
        "units": ("lane", "Depths of contacts are below the slop, and no number is near Chipmunk's own."),
        "iterations": (1, "A contact's normal force is found before its friction, and no other touches it."),
        "collision_slop": (0.1, "pymunk's own; boxes are less deep in their plates, not pushed out."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    judged=("chain", "blocks"),
)

CONTACT_DEFAULT = Preset(
    "The same boxes and pymunk's damped springs, in SI units.",
    CONTACT_OPTIONS,
    law=damped_springs,
    split_tolerance=1e-12,
)

JOINT_RECOMMENDED = replace(
    JOINT_DEFAULT,
    description="For joints of any model: more sweeps; one joint holds as it comes, and an arm sags less.",
    changes={"iterations": (30, "Motors and pins of an arm are solved together, by sweeps.")},
    optional=True,
    judged=("scenes",),
)

CONTACT_RECOMMENDED = replace(
    CONTACT_DEFAULT,
    description="For contacts of any model in metres: more sweeps, and bodies that sink in by a millimetre at most.",
    options={
        **OPTIONS,
        "collision_slop": Option.own(0.1, "pymunk's own, for lengths of pixels: in metres it is a lot."),
    },
    changes={
        "iterations": (30, "Stacks are solved by sweeps."),
        "collision_slop": (1e-3, "[m] With pymunk's own, bodies sink into each other by centimetres."),
    },
    optional=True,
    judged=("scenes",),
)
