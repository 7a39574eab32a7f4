"""Options and presets of Exudyn's two laws of friction."""

from dataclasses import replace

from multibody_xval.engines.exudyn.step_model import bristle, disc, zone
from multibody_xval.engines.interface.presets import Option, Preset

OPTIONS = {
    "units": Option.own("SI", "The chain in SI units."),
    "module": Option("fast", "checked", "Changes the cost only."),
    "solver": Option.own("generalised alpha", "Exudyn's own, of spectral radius 0.9."),
    "relative_tolerance": Option.own(1e-8, "Exudyn's own."),
    "absolute_tolerance": Option.own(1e-10, "Exudyn's own."),
    "smallest_step": Option(1e-6, 1e-8, "Over dt, not in seconds; met by no motion of a stable step."),
    "substeps": Option.own(1, "One step inside each dt."),
}

TUNED = {
    "units": ("lane", "Tolerances are then relative to what moves, whatever its size."),
    "module": ("fast", "The build without range checks needs a quarter less time."),
    "solver": ("Newmark", "Accelerations then follow from the state: restarts are exact."),
    "relative_tolerance": (1e-10, "Newton residual over the first; a period then repeats to 1e-8."),
    "absolute_tolerance": (1e-13, "Newton residual in the units of the lane, where forces are small."),
    "smallest_step": (1e-6, "Over dt, not in seconds; adaptive steps fail below it."),
}
"""What all tuned presets change alike."""

DISC_OPTIONS = {
    "discontinuous_tolerance": Option.own(1.0, "Exudyn's own."),
    "useLinearProportionalZone": Option.own(False, "Exudyn's own."),
}

ZONE_OF_A_NEWCOMER = Option(
    1e-3, 0.0, "[m/s] Needed: without a zone or a bristle, friction jumps. Exudyn's own for spheres."
)

REGULARISED_TUNED = Preset(
    "Steps and proportional zone small enough that creep stays below what a transmittance shows.",
    {
        **OPTIONS,
        "zone": Option(2.5e-4, 0.0, "frictionProportionalZone over s ω_r, with s the displacement scale of the drive."),
        "zone_per_kick": Option(
            0.5, 0.0, "Smallest frictionProportionalZone over F h / m_red, h the substep: in less, Newton may fail."
        ),
    },
    {
        **TUNED,
        "substeps": (
            32,
            "Steps inside each dt: the zone is as wide as they are long, and the error in proportion to it.",
        ),
    },
    known_deviation=(
        "friction is proportional to the slip velocity within a zone: a stuck contact creeps, and the error is in"
        " proportion to the width of the zone, whatever the time step"
    ),
    law=zone,
    static_friction=True,
    split_tolerance=1e-9,
    judged=("chain",),
    accuracy={"transmittance": 0.01},
    accuracy_reason="Friction is proportional to the slip velocity within a zone: a stuck contact is a damper there.",
)

# A restart has to find the accelerations anew, which generalised alpha carries from step to step: runs split inexactly.
REGULARISED_DEFAULT = Preset(
    "The solver with its own settings, and a proportional zone that a newcomer would write.",
    {**OPTIONS, "frictionProportionalZone": ZONE_OF_A_NEWCOMER},
    known_deviation=(
        "friction is proportional to the slip velocity within a zone of 1e-3 m/s: a stuck contact creeps, "
        "whatever the time step"
    ),
    law=zone,
    static_friction=True,
    split_tolerance=1e-4,
)

REGULARISED_RECOMMENDED = replace(
    REGULARISED_DEFAULT,
    description="For joints of any model: a hundredth of the zone, and of its creep; with less arms fail.",
    changes={"frictionProportionalZone": (1e-5, "[m/s, rad/s] A joint creeps by its load over its bound, times this.")},
    known_deviation=(
        "friction is proportional to the slip velocity within a zone of 1e-5 m/s: a stuck contact creeps, "
        "whatever the time step"
    ),
    split_tolerance=0.05,
    optional=True,
    varied={"frictionProportionalZone": (1e-4, 1e-6)},
    judged=("scenes",),
    settles=False,
)

CONTACT_TUNED = Preset(
    "As in the joint formulation: steps and proportional zone small enough for a transmittance.",
    {
        **OPTIONS,
        **DISC_OPTIONS,
        "zone": Option(5e-4, 0.0, "As in the joint, but twice as wide: in a narrower one some orbits do not repeat."),
        "zone_per_kick": Option(
            0.15, 0.0, "Smallest width over F h / m_red: a disc does not leave its zone within Newton's iteration."
        ),
    },
    {
        **TUNED,
        "substeps": (4, "An eighth of those in the joint formulation: a step costs five times as much."),
        "discontinuous_tolerance": (
            1e-9,
            "iterationTolerance: at 1 a disc leaves the zone at the end of a step only, and orbits stall.",
        ),
        "useLinearProportionalZone": (True, "The zone of the joint formulation; the other is quadratic."),
    },
    known_deviation=REGULARISED_TUNED.known_deviation,
    law=disc,
    split_tolerance=1e-9,
    judged=("chain",),
    accuracy={"transmittance": 0.015},
    accuracy_reason="Friction is regularised as in the joint, with a zone twice as wide and longer substeps.",
)

CONTACT_DEFAULT = Preset(
    "The solver with its own settings, and a proportional zone that a newcomer would write.",
    {**OPTIONS, **DISC_OPTIONS, "frictionProportionalZone": ZONE_OF_A_NEWCOMER},
    known_deviation=(
        "friction is F s (2 − s) within a zone of 1e-3 m/s, s the slip velocity over its width, which a disc leaves at "
        "the end of a correction only: until then friction falls again beyond the zone"
    ),
    law=disc,
    split_tolerance=0.05,
    batch_lanes=1,  # one whose motion never settles takes twenty seconds
)

BRISTLE_OPTIONS = {**OPTIONS, "discontinuous_iterations": Option.own(5, "Exudyn's own.")}

BRISTLE_TUNED = Preset(
    "Bristles as stiff as the step resolves, and one correction of the friction state a step.",
    {
        **BRISTLE_OPTIONS,
        "bristle_phase": Option(
            0.4, 0.0, "h √(k_s / m_red), and so stickingStiffness k_s; at 1.8 far cells err by 0.8 dB, at 0.6 by 0.5."
        ),
        "bristle_damping": Option(0.4, 0.0, "stickingDamping over 2 √(k_s m_red); more delays reversals, 0 rings."),
    },
    {
        **TUNED,
        "substeps": (4, "Steps inside each dt: reversals that graze are seen at the end of a step only."),
        "discontinuous_iterations": (
            1,
            "Corrections of the friction state a step, whatever their error; 5 at coarse steps stall the orbit.",
        ),
    },
    known_deviation=(
        "a stuck contact is a stiff spring that gives way by F / k_s, and sticks only from the end of a substep "
        "on: short sticks are missed or made up"
    ),
    law=bristle,
    static_friction=True,
    split_tolerance=1e-9,
    accuracy={"transmittance": 0.015},
    accuracy_reason=(
        "A stuck contact is a spring that gives way, and short sticks are missed or made up. Deep in the band it is "
        "off by up to 2.1 %, so that this preset is measured and not judged."
    ),
)

BRISTLE_DEFAULT = Preset(
    "The solver with its own settings, and the bristle of Exudyn's own friction oscillator.",
    {
        **BRISTLE_OPTIONS,
        "stickingStiffness": Option(1e4, 0.0, "[N/m] Needed; the value of Exudyn's example of a friction oscillator."),
        "stickingDamping": Option(1e2, 0.0, "[N s/m] As there: a hundredth of the stiffness."),
    },
    known_deviation="a stuck contact is a spring of 1e4 N/m, so soft that it gives way by as much as the chain moves",
    law=bristle,
    static_friction=True,
    split_tolerance=0.05,
)

BRISTLE_RECOMMENDED = replace(
    BRISTLE_DEFAULT,
    description="For joints of any model, at small steps: bristles as they come, whose state is corrected once a step.",
    changes={
        "discontinuous_iterations": (
            1,
            "discontinuous.maxIterations: what should stick in an arm else turns to slip and back, and it comes down.",
        )
    },
    optional=True,
    judged=("scenes",),
)
