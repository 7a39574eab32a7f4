"""Options and presets of Siconos, and the law of its steps; `server` holds its model."""

from multibody_xval.engines.interface.law import Constant, Law, NotModelled
from multibody_xval.engines.interface.presets import Option, Preset
from reference_lcp.schemes.linear_implicit import LinearImplicitLane, LinearStep


def moreau_jean(preset: Preset) -> Law:
    """Give the law of springs, dashpots and load at the time that θ says, and friction as an impulse."""
    return Law(
        formula=(
            "(M + h θ C + h² θ² K) q̇⁺ = (M − h (1−θ) C − h² θ (1−θ) K) q̇ − h K q "
            "+ h ((1−θ) f(t) + θ f(t+h)) e_1 + W p; q⁺ = q + h (θ q̇⁺ + (1−θ) q̇); Coulomb's law of w⁺"
        ),
        constants={"θ": Constant(preset["theta"], "", "theta")},
        model=lambda lane, of: LinearImplicitLane(lane, LinearStep.theta(lane.chain, lane.time_step, of["θ"])),
    )


def opening_contacts(_: Preset) -> NotModelled:
    """Say why no model follows contacts that act where their gap is not positive only."""
    return NotModelled("round-off opens a contact now and then for a step or two, which have no friction")


OPTIONS = {
    "units": Option.own("SI", "The chain in SI units."),
    "theta": Option(0.5, "none", "Needed; the value of Siconos's examples."),
    "springs": Option.own("own", "Stiffness and damping matrix of LagrangianLinearTIDS."),
    "newton": Option.own("nonlinear", "Siconos's own."),
}

TUNED = {
    "units": ("lane", "Lemke's pivots and the clock of events then meet no built-in small number."),
    "theta": (0.5, "Trapezoidal, of second order while nothing starts or stops; 1 is implicit Euler."),
    "springs": ("own", "Stiffness and damping matrix of LagrangianLinearTIDS, at the time given by θ."),
    "newton": ("linear", "One iteration a step, for all is linear but the friction."),
}
"""What the tuned presets of both formulations change alike."""

JOINT_OPTIONS = {
    **OPTIONS,
    "activation": Option(
        "always", "gap <= 0", "Needed: an inner mass ahead of its outer one would feel no friction, unwarned."
    ),
    "interactions": Option.own("one a contact", "As examples do."),
    "solver": Option.own("AVI_CAOFERRIS", "Siconos's own."),
}

TUNED_RELAYS = {
    **TUNED,
    "activation": ("always", "A large negative offset in the relation: Siconos skips relays of a positive gap."),
    "interactions": ("one a bound", "One relation of several rows: a quarter of the time."),
    "solver": ("LEMKE", "Exact, and named like the reference's; both give the same."),
}

TRAPEZOIDAL = "Springs act at the middle of a step and friction at its end: an error of the step, but not Euler's."

JOINT_TUNED = Preset(
    "Moreau–Jean with θ = ½ and relays solved by Lemke: the trapezoidal rule with exact Coulomb friction.",
    JOINT_OPTIONS,
    TUNED_RELAYS,
    law=moreau_jean,
    split_tolerance=1e-12,
    judged=("chain", "blocks"),
    accuracy={"transmittance": 0.014},
    accuracy_reason=TRAPEZOIDAL,
)

JOINT_EULER = Preset(
    "θ = 1 with springs and dashpots as forces at the start of a step: equation (5), solved by another code.",
    JOINT_OPTIONS,
    {
        **TUNED_RELAYS,
        "theta": (1.0, "Positions advance with the velocity at the end of a step."),
        "springs": ("forces", "External forces that the adapter computes from the start of the step."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
)

JOINT_DEFAULT = Preset(
    "A relay for each contact in SI units, as a newcomer would write it; it differs from the tuned one in cost only.",
    JOINT_OPTIONS,
    law=moreau_jean,
    split_tolerance=1e-12,
)

CONTACT_OPTIONS = {
    **OPTIONS,
    "solver": Option.own("NSGS", "Siconos's own."),
    "tolerance": Option.own(1e-4, "Siconos's own."),
    "threshold": Option.own(0.0, "Siconos's own: a contact acts where its gap is not positive."),
}

CONTACT_TUNED = Preset(
    "Moreau–Jean with θ = ½, and a contact solver that goes on to round-off.",
    CONTACT_OPTIONS,
    {
        **TUNED,
        "solver": ("NSGS", "Gauss–Seidel over the contacts; Lemke's method sometimes opens a contact."),
        "tolerance": (1e-14, "Of NSGS: it stops early otherwise, and motions err by 1e-6 of U0."),
        "threshold": (1e-6, "Gap over the displacement scale up to which a contact acts; round-off must not open it."),
    },
    law=moreau_jean,
    split_tolerance=1e-12,
    judged=("chain", "blocks"),
    accuracy={"transmittance": 0.0025},
    accuracy_reason=TRAPEZOIDAL,
)

CONTACT_DEFAULT = Preset(
    "The same contacts in SI units, with Siconos's own solver and tolerance.",
    CONTACT_OPTIONS,
    split_tolerance=1e-12,
    known_deviation=(
        "a contact acts where its gap is not positive only: round-off opens a closed one now and then for a step or "
        "two, which have no friction; and the contact solver stops at 1e-4"
    ),
    law=opening_contacts,
)
