"""Presets of ODE's joint formulation: in every cell the motor of a slider; `server` holds its model."""

from engines.interface.presets import NormalForce, Option, Preset
from engines.ode.law import soft_motors, soft_stops
from engines.shared.known_deviations import IMPLICIT_SPRINGS

JOINT_TUNED = Preset(
    "Motors that hold the relative velocity at zero with at most the friction bound, and no softness.",
    {
        "units": Option("lane", "SI", "No number comes near a built-in small one."),
        "cfm": Option(0.0, 1e-10, "ODE softens every constraint: a stuck contact would creep."),
        "erp": Option(0.2, 0.2, "ODE's own; no joint has an error to correct."),
        "springs": Option(
            "forces", "stops", "Forces at the start of a step; soft stops of sliders are implicit Euler."
        ),
        "fmax": Option(5, 3, "Number of dParamFMax in ODE 0.16; pyode's constant is that of another parameter."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
)

JOINT_DEFAULT = Preset(
    "Motors as dry friction in SI units, with ODE's own softness.",
    {
        "units": Option("SI", "SI", "The chain in SI units."),
        "cfm": Option(1e-10, 1e-10, "ODE's own, in double precision."),
        "erp": Option(0.2, 0.2, "ODE's own."),
        "springs": Option("forces", "stops", "Forces, as most users would write them."),
        "fmax": Option(5, 3, "Needed: pyode's constant is that of another parameter, and no friction acts."),
    },
    law=soft_motors,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
)

JOINT_STOPS = Preset(
    "ODE's own springs: sliders whose stops are both at zero and as soft as the spring; motors as friction.",
    {
        **JOINT_DEFAULT.options,
        "springs": Option(
            "stops", "stops", "Stiffness and damping as ERP and CFM, as the manual says: implicit Euler."
        ),
    },
    known_deviation=IMPLICIT_SPRINGS,
    law=soft_stops,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
)
