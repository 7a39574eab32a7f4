"""Presets of Siconos's joint formulation: in every cell a relay; `server` holds its model."""

from engines.interface.presets import Option, Preset
from engines.siconos.law import moreau_jean

SHARED_TUNED_OPTIONS = {
    "units": Option("lane", "SI", "Lemke's pivots and the clock of events then meet no built-in small number."),
    "theta": Option(0.5, "none", "Trapezoidal, of second order while nothing starts or stops; 1 is implicit Euler."),
    "springs": Option("own", "own", "Stiffness and damping matrix of LagrangianLinearTIDS, at the time given by θ."),
    "newton": Option("linear", "nonlinear", "One iteration a step, for all is linear but the friction."),
}
"""Options that the tuned presets of both formulations share."""

JOINT_TUNED = Preset(
    "Moreau–Jean with θ = ½ and relays solved by Lemke: the trapezoidal rule with exact Coulomb friction.",
    {
        **SHARED_TUNED_OPTIONS,
        "activation": Option(
            "always", "gap <= 0", "A large negative offset in the relation: Siconos skips relays of a positive gap."
        ),
        "interactions": Option("one a bound", "one a contact", "One relation of several rows: a quarter of the time."),
        "solver": Option("LEMKE", "AVI_CAOFERRIS", "Exact, and named like the reference's; both give the same."),
    },
    law=moreau_jean,
    split_tolerance=1e-12,
)

JOINT_EULER = Preset(
    "θ = 1 with springs and dashpots as forces at the start of a step: equation (5), solved by another code.",
    {
        **JOINT_TUNED.options,
        "theta": Option(1.0, "none", "Positions advance with the velocity at the end of a step."),
        "springs": Option("forces", "own", "External forces that the adapter computes from the start of the step."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
)

JOINT_DEFAULT = Preset(
    "A relay for each contact in SI units, as a newcomer would write it; it differs from the tuned one in cost only.",
    {
        "units": Option("SI", "SI", "The chain in SI units."),
        "theta": Option(0.5, "none", "Needed; the value of Siconos's examples."),
        "springs": Option("own", "own", "Stiffness and damping matrix of LagrangianLinearTIDS."),
        "newton": Option("nonlinear", "nonlinear", "Siconos's own."),
        "activation": Option(
            "always",
            "gap <= 0",
            "Needed: an inner mass ahead of its outer one would feel no friction, unwarned.",
        ),
        "interactions": Option("one a contact", "one a contact", "As examples do."),
        "solver": Option("AVI_CAOFERRIS", "AVI_CAOFERRIS", "Siconos's own."),
    },
    law=moreau_jean,
    split_tolerance=1e-12,
)
