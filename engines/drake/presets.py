"""Options and presets of Drake."""

from dataclasses import replace

from multibody_xval.engines.drake.step_model import (
    actuator,
    lagged_contact,
    near_rigid_actuator,
    sap_contact,
    similar_contact,
)
from multibody_xval.engines.interface.law import NotModelled
from multibody_xval.engines.interface.presets import Option, Preset

SMOOTH_LAW_MARGIN = 1e-3
"""Drake's friction is μ λ_N v / √(v² + v_s²): at 22 v_s it has come to within a thousandth of its bound, never nearer
than (v_s / v)² / 2. Read with the margin of laws that reach the bound, a contact would stick up to 700 v_s."""

OPTIONS = {
    "units": Option.own("SI", "The chain in SI units."),
    "gravity": Option(0.0, 9.81, "Needed: the chain has no weight."),
    "output ports": Option.own("sampled", "Drake's own."),
}

TUNED = {
    "units": ("lane", "No number comes near Drake's built-in smallest and largest ones."),
    "gravity": (0.0, "The chain has no weight."),
    "output ports": ("live", "The same forces, without keeping them in every step: a tenth faster."),
}
"""What the tuned presets of both formulations change alike."""

JOINT_TUNED = Preset(
    "Dry friction emulated by actuators of a gain beyond what Drake resolves, which takes the largest that it does.",
    {
        **OPTIONS,
        "d": Option(
            1e6, 0.0, "Gain of velocity over m_red / δt. Above 4e3 m_i / δt, where Drake cuts off, all act alike."
        ),
    },
    TUNED,
    known_deviation=(
        "dashpots act with the velocity at the end of a step; a stuck contact is a damper as strong as Drake's "
        "near-rigid limit lets it be, and creeps with λ_T / d, a thousandth of that"
    ),
    law=near_rigid_actuator,
    split_tolerance=1e-12,
    judged=("chain",),
    accuracy={"transmittance": 0.009, "drift": 0.01},
    accuracy_reason=(
        "Dashpots act with the velocity at the end of a step: an error of the step, but not Euler's. A block that has "
        "stopped, without a load, moves by less than a hundredth of a µm/s; under a load it drifts by more."
    ),
)

JOINT_DEFAULT = Preset(
    "Dry friction emulated by actuators with a gain that a newcomer would write, in SI units.",
    {
        **OPTIONS,
        "PdControllerGains.d": Option(1e3, 0.0, "[N s/m] Needed: a joint of Drake has no dry friction of its own."),
    },
    known_deviation="a stuck contact is a damper of 1e3 N s/m and creeps with λ_T / d, whatever the time step",
    law=actuator,
    split_tolerance=1e-12,
)

CONTACT_OPTIONS = {
    **OPTIONS,
    "contact_model": Option.own("kHydroelasticWithFallback", "Drake's own."),
    "approximation": Option.own("kLagged", "Drake's own."),
    "hunt_crossley_dissipation": Option.own(50.0, "[s/m] Drake's own; nothing moves across the plane."),
}

CONTACT_TUNED = Preset(
    "Friction bounded by the normal force at the start of the step: nothing moves across the plane.",
    {
        **CONTACT_OPTIONS,
        "stiction": Option(
            3e-5, 1e-3, "v_stiction over s ω_r, with s the displacement scale of the drive; at 1e-7 orbits of nearly "
            "stuck cells stall, for Drake's solver stops at a part of 1e-6.",
        ),
        "depth": Option(
            2.0**-3, 0.0, "Of the sphere at rest, over s; sets point_stiffness. Without effect with kLagged; with the "
            "others a sliding sphere would leave a stiffer plane.",
        ),
    },
    {
        **TUNED,
        "contact_model": ("kPoint", "The same points; the shapes need no more."),
        "approximation": ("kLagged", "The others press and lift a sliding sphere; see their presets."),
        "hunt_crossley_dissipation": (0.0, "[s/m] Nothing moves across the plane."),
    },
    known_deviation=(
        "friction is μ λ_N v / √(v² + v_s²) with the stiction velocity v_s = 3e-5 s ω_r: a stuck contact creeps, "
        "and none reaches its bound, whatever the time step"
    ),
    law=lagged_contact,
    split_tolerance=1e-12,
    stick_margin=SMOOTH_LAW_MARGIN,
    turns=True,
    judged=("chain",),
    accuracy={"transmittance": 0.001, "drift": 0.01},
    accuracy_reason=(
        "A stuck contact creeps within the stiction velocity, and none reaches its bound. A block that has stopped, "
        "without a load, moves by less than a hundredth of a µm/s; under a load it drifts by more."
    ),
)  # fmt: skip

CONTACT_SIMILAR = replace(
    CONTACT_TUNED,
    description="As tuned, with the approximation that Drake advises for strong transients.",
    changes={
        "approximation": ("kSimilar", "A sliding sphere glides: friction lifts it by μ |ġ_T| δt."),
    },
    known_deviation=(
        "friction lifts a sliding sphere by μ |ġ_T| dt: it bounces, and its normal force, which bounds friction, swings"
    ),
    law=similar_contact,
    judged=(),
    accuracy={},
    accuracy_reason="",
)

CONTACT_SAP = replace(
    CONTACT_SIMILAR,
    description="As tuned, with the approximation of Drake's solver itself, the convex one of Castro et al., 2022.",
    options={
        **CONTACT_TUNED.options,
        "relaxation_time": Option(0.0, 0.1, "[s] Dissipation; at 0.1 s a sliding sphere would leave its plane."),
    },
    changes={
        "approximation": ("kSap", "A sliding sphere glides as with kSimilar, and higher still with a relaxation time."),
    },
    law=sap_contact,
    judged=(),
)

CONTACT_DEFAULT = Preset(
    "A sphere on a plane with a coefficient of friction, in SI units, and Drake's own options elsewhere.",
    {
        **CONTACT_OPTIONS,
        "v_stiction": Option.own(1e-3, "[m/s] Drake's own: a stuck contact may creep this fast, at any time step."),
        "point_stiffness": Option.own(1e6, "[N/m] Drake's own, of each of the two bodies."),
    },
    known_deviation=(
        "friction is μ λ_N v / √(v² + v_s²) with the stiction velocity v_s = 1e-3 m/s: a stuck contact creeps, "
        "and none reaches its bound, whatever the time step"
    ),
    law=lagged_contact,
    split_tolerance=1e-12,
    stick_margin=SMOOTH_LAW_MARGIN,
    turns=True,
)

JOINT_RECOMMENDED = replace(
    JOINT_DEFAULT,
    description="For joints of any model: actuators with a gain far above what bodies need, at no cost.",
    changes={
        "PdControllerGains.d": (
            1e6,
            "[N s/m] A stuck joint creeps with λ_T / d; Drake cuts larger ones off by itself.",
        ),
    },
    known_deviation="a stuck contact is a damper of 1e6 N s/m, or as strong as Drake resolves, and creeps with λ_T / d",
    law=lambda _: NotModelled("whether the gain decides, or Drake's near-rigid limit, depends on masses and step"),
    optional=True,
    judged=("scenes",),
)

CONTACT_RECOMMENDED = replace(
    CONTACT_DEFAULT,
    description="For contacts of any model: patches of contact instead of points, and a small stiction velocity.",
    options={
        **CONTACT_DEFAULT.options,
        "hydroelastic_modulus": Option(
            None, None, "[Pa] Drake's own: none, and two boxes touch in one point, on which they rock."
        ),
    },
    changes={
        "hydroelastic_modulus": (1e7, "[Pa] Boxes then touch in a patch. Spheres of the chain have one point anyway."),
        "v_stiction": (1e-5, "[m/s] Creep goes with it; below 1e-6 Drake's solver leaves as much."),
    },
    known_deviation=CONTACT_DEFAULT.known_deviation.replace("1e-3", "1e-5"),
    optional=True,
    judged=("scenes",),
)
