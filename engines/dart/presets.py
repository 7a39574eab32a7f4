"""Options and presets of DART, and the laws of its own springs and of spheres, which are a little soft."""

from collections.abc import Mapping
from dataclasses import replace

from multibody_xval.engines.interface.law import Constant, Law
from multibody_xval.engines.interface.presets import NormalForce, Option, Preset
from multibody_xval.engines.shared.claims import IMPLICIT_SPRINGS, tangents_of_the_world
from reference_lcp.chain.simulation import Lane
from reference_lcp.schemes.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction

JOINT_MIXING = 1e-9
"""DART's constraint force mixing of joint friction: the least that it takes, and its default."""

CONTACT_MIXING = 1e-5
"""DART's constraint force mixing of a point of contact, which Python cannot set; four points share a box."""

OWN_SPRINGS_PERIOD = 1e-12
"""Of U0: 400 steps of some ten roundings of 1e-16, each of U0. A hundredth of DART's softness is above it."""

SPHERE_PERIOD = 2e-6
"""Of U0: in the first step of a run a sphere presses, and rubs, by a part of 1e-5 less."""


def own_springs(preset: Preset) -> Law:
    """Give the law of the joints' own springs."""

    def model(lane: Lane, of: Mapping[str, float]) -> LinearImplicitLane:
        step = LinearStep.implicit(lane.chain, lane.time_step, response_matrix=lane.chain.mass_matrix)
        return _softened(lane, step, of["ε"])

    return Law(
        formula=(
            "(M + h C + h² K) q̇_free = M q̇ − h K q + h f(t) e_1; q̇⁺ = q̇_free + M⁻¹ W p; "
            "Coulomb's law, softened by the part ε of (Wᵀ M⁻¹ W)_ii"
        ),
        constants={"ε": Constant(preset["constraint force mixing"], "", "constraint force mixing")},
        model=model,
        period_bound=OWN_SPRINGS_PERIOD,
        modulated=True,
    )


def soft_sphere(preset: Preset) -> Law:
    """Give the law of a sphere on a plate, whose one point of contact is soft."""
    source = "DART's constraint force mixing of a point of contact, which Python cannot set"

    def model(lane: Lane, of: Mapping[str, float]) -> LinearImplicitLane:
        return _softened(lane, LinearStep.explicit(lane.chain, lane.time_step), of["ε"], tangents_of_the_world(lane))

    return Law(
        formula=(
            "equation (5), with Coulomb's law softened by the part ε of (Wᵀ M⁻¹ W)_ii; in a row that is turned by α "
            "the bound is (|cos α| + |sin α|) μ λ_N"
        ),
        constants={"ε": Constant(preset.residual_slip_compliance, "", source, too_small_to_see=True)},
        model=model,
        period_bound=SPHERE_PERIOD,
        bound_reason="the normal force is as soft: in the first step of a run it lacks a part of 1e-5",
        modulated=True,
    )


def _softened(lane: Lane, step: LinearStep, part: float, bound_share: float = 1.0) -> LinearImplicitLane:
    compliance = part * step.coupling.diagonal()
    return LinearImplicitLane(lane, step, ScalarFriction.coulomb(lane.chain.cells, compliance, bound_share=bound_share))


OPTIONS = {
    "units": Option.own("SI", "The chain in SI units."),
    "deactivation": Option.own(True, "DART's own."),
}

TUNED = {
    "units": ("lane", "No number comes near DART's built-in smallest ones."),
    "deactivation": (
        False,
        "Slow bodies must not be put to sleep. With it on, none was in the chains that were tried.",
    ),
}
"""What the tuned presets of both formulations change alike."""

JOINT_OPTIONS = {
    **OPTIONS,
    "springs": Option.own("of the joints", "DART's own: implicit, which damps every vibration."),
    "constraint force mixing": Option.own(JOINT_MIXING, "DART's own.", fixed=True),
}

JOINT_TUNED = Preset(
    "Coulomb friction of joints under springs, dashpots and drive as forces at the start of the step.",
    JOINT_OPTIONS,
    {
        **TUNED,
        "springs": ("forces", "At the start of the step, as in equation (5); DART's are implicit."),
        "constraint force mixing": (JOINT_MIXING, "DART raises smaller values to this one."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    residual_slip_compliance=JOINT_MIXING,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

JOINT_DEFAULT = Preset(
    "The joints' own springs, dashpots and Coulomb friction in SI units.",
    JOINT_OPTIONS,
    known_deviation=f"{IMPLICIT_SPRINGS}; friction is solved after them, with the bare masses",
    law=own_springs,
    split_tolerance=1e-12,
    residual_slip_compliance=JOINT_MIXING,
    normal_force=NormalForce.MODULATED,
)

CONTACT_DEFAULT = Preset(
    "The same boxes in SI units; springs are forces all the same, for DART's belong to joints.",
    {**OPTIONS, "shape": Option.own("box", "The plainest body to press on a plate.")},
    shares_scheme=True,
    split_tolerance=1e-6,
    residual_slip_compliance=CONTACT_MIXING / 4,
    normal_force=NormalForce.LIFTING,
    turns=True,
    turned_bound=tangents_of_the_world,
)

CONTACT_TUNED = replace(
    CONTACT_DEFAULT,
    description="Boxes pressed on plates; springs, dashpots and drive as forces at the start of the step.",
    changes={**TUNED, "shape": ("box", "Its four points share DART's constraint force mixing of 1e-5 a point.")},
    judged=("chain", "blocks"),
)

CONTACT_SPHERE = replace(
    CONTACT_TUNED,
    description="Spheres, which do not roll, on plates: one point of contact a cell, and half the cost.",
    changes={"shape": ("sphere", "One point of contact, with the whole of its constraint force mixing.")},
    shares_scheme=False,
    law=soft_sphere,
    split_tolerance=1e-5,
    residual_slip_compliance=CONTACT_MIXING,
    turned_bound=None,
    judged=(),
)

JOINT_RECOMMENDED = replace(
    JOINT_DEFAULT,
    description="For joints of any model: as DART comes, which holds them.",
    optional=True,
    judged=("scenes",),
)

CONTACT_RECOMMENDED = replace(
    CONTACT_DEFAULT,
    description="For contacts of any model: as DART comes, which holds them.",
    optional=True,
    judged=("scenes",),
)
