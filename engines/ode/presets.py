"""Options and presets of ODE; `server` holds its model."""

from dataclasses import replace

from multibody_xval.engines.interface.law import NotModelled
from multibody_xval.engines.interface.presets import NormalForce, Option, Preset
from multibody_xval.engines.ode.step_model import soft_boxes, soft_motors, soft_stops
from multibody_xval.engines.shared.claims import IMPLICIT_SPRINGS, tangents_of_the_world

BOUNCE, APPROXIMATION = 0x004, 0x7000
"""Bits of a contact's mode: `ContactBounce`, and `ContactApprox1_1`, `_2` and `_N` of ODE 0.16 together."""

OPTIONS = {
    "units": Option.own("SI", "The chain in SI units."),
    "cfm": Option.own(1e-10, "ODE's own, in double precision."),
}

JOINT_OPTIONS = {
    **OPTIONS,
    "erp": Option.own(0.2, "ODE's own."),
    "springs": Option("forces", "stops", "Forces, as most users would write them."),
    "fmax": Option(5, 3, "Needed: pyode's constant is that of another parameter, and no friction acts."),
}

JOINT_TUNED = Preset(
    "Dry friction emulated, as ODE's manual says, by motors that hold with at most its bound; no softness.",
    JOINT_OPTIONS,
    {
        "units": ("lane", "No number comes near a built-in small one."),
        "cfm": (0.0, "ODE softens every constraint: a stuck contact would creep."),
        "erp": (0.2, "ODE's own; no joint has an error to correct."),
        "springs": ("forces", "Forces at the start of a step; soft stops of sliders are implicit Euler."),
        "fmax": (5, "Number of dParamFMax in ODE 0.16; pyode's constant is that of another parameter."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

JOINT_DEFAULT = Preset(
    "Dry friction emulated by the same motors in SI units, with ODE's own softness.",
    JOINT_OPTIONS,
    law=soft_motors,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
)

JOINT_STOPS = Preset(
    "ODE's own springs: sliders whose stops are both at zero and as soft as the spring; motors emulate friction.",
    JOINT_OPTIONS,
    {"springs": ("stops", "Stiffness and damping as ERP and CFM, as the manual says: implicit Euler.")},
    known_deviation=IMPLICIT_SPRINGS,
    law=soft_stops,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
)

CONTACT_OPTIONS = {
    **OPTIONS,
    "erp": Option.own(0.2, "ODE's own: a fifth of the depth is corrected in a step."),
    "inertia": Option(2.0**20, "none", "Needed: nothing is to turn; from 2**50 on, redundant points upset ODE."),
    "shape": Option("box", "none", "Needed; the softness distributes the force over four points of contact."),
    "mode": Option(APPROXIMATION, BOUNCE, "Needed: mu would be a force in newtons, whatever presses."),
    "surface_layer": Option.own(0.0, "ODE's own."),
    "depth": Option.own(0.0, "The boxes touch their plates."),
}

CONTACT_TUNED = Preset(
    "Spheres that do not turn on plates, with a layer in which depth is not corrected, and no softness.",
    CONTACT_OPTIONS,
    {
        "units": ("lane", "No number comes near a built-in small one."),
        "cfm": (0.0, "ODE softens every constraint: boxes would sink in, and creep."),
        "erp": (0.2, "ODE's own; the surface layer keeps contacts from it."),
        "inertia": (2.0**60, "Over mass and half edge squared: friction turns nothing, not by round-off."),
        "shape": ("sphere", "One point of contact: those of a box are redundant, and without softness ODE errs."),
        "mode": (APPROXIMATION, "Friction in proportion to the normal force; without it, mu is a force in newtons."),
        "surface_layer": (2.0**-10, "Over the displacement scale; deeper boxes are pushed out."),
        "depth": (2.0**-11, "Depth at the start over the displacement scale: round-off opens no contact."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.LIFTING,
    turns=True,
    turned_bound=tangents_of_the_world,
    modulated_options={
        "surface_layer": Option(
            2.0**-20, 0.0, "After a landing spheres stay as deep as this, and take off from there."
        ),
        "depth": Option(2.0**-21, 0.0, "Within the layer, as under a constant normal force."),
    },
    judged=("chain", "blocks"),
)

CONTACT_DEFAULT = Preset(
    "Boxes that touch plates, in SI units, with ODE's own softness and corrections; a run forgets their depth.",
    CONTACT_OPTIONS,
    known_deviation=(
        "four points of contact are soft (CFM 1e-10), so that a box beside a much heavier mass tilts: its normal force "
        "swings by up to 1e-4, and friction that slides is read as below its bound"
    ),
    law=soft_boxes,
    split_tolerance=1e-8,
    normal_force=NormalForce.LIFTING,
    turns=True,
    turned_bound=tangents_of_the_world,
)

JOINT_RECOMMENDED = replace(
    JOINT_DEFAULT,
    description="For joints of any model: a motor a joint, and steps of the direct solver, as they come.",
    optional=True,
    judged=("scenes",),
)

CONTACT_RECOMMENDED = replace(
    CONTACT_DEFAULT,
    description="For contacts of any model: points that are soft along the normal, so that what is gripped holds too.",
    options={**CONTACT_OPTIONS, "soft_cfm": Option.own(None, "ODE's own: the world's cfm.")},
    changes={
        "soft_cfm": (
            1e-5,
            "[m/(s N)] Of the normal alone, friction stays hard. Without it a gripped box slips by up to 13 mm/s.",
        )
    },
    optional=True,
    known_deviation="boxes sink until the softness carries what presses them, in some steps from the start of a run",
    law=lambda _: NotModelled("the depth of a box is a state of its own, of which a restart knows nothing"),
    split_tolerance=1e-4,
    varied={"soft_cfm": (1e-6, 1e-4)},
    judged=("scenes",),
)
