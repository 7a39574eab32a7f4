"""Presets of ODE's contact formulation: in every cell a sphere or a box on a plate; `server` holds its model."""

from engines.interface.presets import NormalForce, Option, Preset
from engines.ode.law import normal_first, soft_boxes
from engines.shared.tangents import tangents_of_the_world

BOUNCE, APPROXIMATION = 0x004, 0x7000
"""Bits of a contact's mode: `ContactBounce`, and `ContactApprox1_1`, `_2` and `_N` of ODE 0.16 together."""

CONTACT_TUNED = Preset(
    "Spheres that do not turn on plates, with a layer in which depth is not corrected, and no softness.",
    {
        "units": Option("lane", "SI", "No number comes near a built-in small one."),
        "cfm": Option(0.0, 1e-10, "ODE softens every constraint: boxes would sink in, and creep."),
        "erp": Option(0.2, 0.2, "ODE's own; the surface layer keeps contacts from it."),
        "inertia": Option(
            2.0**60, "none", "Over mass and half edge squared: friction turns nothing, not by round-off."
        ),
        "shape": Option(
            "sphere", "none", "One point of contact: those of a box are redundant, and without softness ODE errs."
        ),
        "mode": Option(
            APPROXIMATION, BOUNCE, "Friction in proportion to the normal force; without it, mu is a force in newtons."
        ),
        "surface_layer": Option(2.0**-10, 0.0, "Over the displacement scale; deeper boxes are pushed out."),
        "depth": Option(2.0**-11, 0.0, "Depth at the start over the displacement scale: round-off opens no contact."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.LIFTING,
    turns=True,
    inclines=True,
    turned_bound=tangents_of_the_world,
    inclined_law=normal_first,
    modulated_options={
        "surface_layer": Option(
            2.0**-20, 0.0, "After a landing spheres stay as deep as this, and take off from there."
        ),
        "depth": Option(2.0**-21, 0.0, "Within the layer, as under a constant normal force."),
    },
)

CONTACT_DEFAULT = Preset(
    "Boxes that touch plates, in SI units, with ODE's own softness and corrections; a run forgets their depth.",
    {
        "units": Option("SI", "SI", "The chain in SI units."),
        "cfm": Option(1e-10, 1e-10, "ODE's own, in double precision."),
        "erp": Option(0.2, 0.2, "ODE's own: a fifth of the depth is corrected in a step."),
        "inertia": Option(2.0**20, "none", "Needed: nothing is to turn; from 2**50 on, redundant points upset ODE."),
        "shape": Option("box", "none", "Needed; the softness distributes the force over four points of contact."),
        "mode": Option(APPROXIMATION, BOUNCE, "Needed: mu would be a force in newtons, whatever presses."),
        "surface_layer": Option(0.0, 0.0, "ODE's own."),
        "depth": Option(0.0, 0.0, "The boxes touch their plates."),
    },
    known_deviation=(
        "four points of contact are soft (CFM 1e-10), so that a box beside a much heavier mass tilts: its normal force "
        "swings by up to 1e-4, and friction that slides is read as below its bound"
    ),
    law=soft_boxes,
    split_tolerance=1e-8,
    normal_force=NormalForce.LIFTING,
    turns=True,
    inclines=True,
    turned_bound=tangents_of_the_world,
)
