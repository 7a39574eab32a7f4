"""SAPIEN's own settings, and the presets that change them."""

from dataclasses import replace

from multibody_xval.engines.interface.presets import NormalForce, Option, Preset
from multibody_xval.engines.sapien.step_model import damped_links, temporal_gauss_seidel
from multibody_xval.engines.shared.claims import tangents_of_the_world
from multibody_xval.engines.shared.units import Units
from reference_lcp.chain.simulation import Lane

OPTIONS = {
    "units": Option.own("SI", "The chain in SI units."),
    "enable_tgs": Option.own(True, "SAPIEN's own solver, the temporal Gauss–Seidel."),
    "solver_position_iterations": Option.own(10, "SAPIEN's own: each of the temporal solver is a substep."),
    "solver_velocity_iterations": Option.own(
        1, "SAPIEN's own: velocities are corrected once more after positions have moved."
    ),
}

JOINT_OPTIONS = {
    **OPTIONS,
    "linear damping": Option.own(0.05, "PhysX's own; it slows every link down, against the ground."),
    "joint friction": Option(0.0, 0.05, "A dimensionless one of PhysX's, which is no bound of a force."),
    "drive damping": Option(1e20, 0.0, "A smaller one lets stuck contacts creep."),
    "max joint velocity": Option(1e30, 100.0, "No motion is cut off, however large."),
    "max linear velocity": Option(1e30, 10.0, "Neither is that of a link, which SAPIEN cuts off at 10 m/s."),
}

CONTACT_UNITS = "light"

CONTACT_OPTIONS = {
    **OPTIONS,
    "enable_tgs": Option.own(True, "SAPIEN's own solver, the temporal Gauss–Seidel: ten substeps a step."),
    "units": Option(
        CONTACT_UNITS, "SI", "Where four contacts are solved together, each may pass its bound by 1e-5 units."
    ),
    # Bodies do not turn, and yet a smaller one would yield under forces beside its centre.
    "inertia": Option(1e30, None, "A locked rotation still yields to a force beside the centre, within a step."),
}

LEAST_SPEED_OF_TANGENTS = 0.01
"""Of a slip, in the units of the scene: PhysX's projected solver has its tangents along and across faster ones."""


def _tangents_of_a_slow_slip(lane: Lane, slip_velocity: float) -> float:
    """Give the bound of friction over μ λ_N: two tangents, each with its own, which a slow slip finds in the world."""
    slow = abs(slip_velocity) < LEAST_SPEED_OF_TANGENTS * Units.named(CONTACT_UNITS, lane).velocity
    return tangents_of_the_world(lane) if slow else 1.0


JOINT_TUNED = Preset(
    "Dry friction emulated by drives of bounded force in one articulation; springs, dashpots and load as forces.",
    JOINT_OPTIONS,
    {
        "units": ("lane", "Numbers of order one: single precision ends at 1e-38."),
        "enable_tgs": (False, "The temporal solver moves masses ten times a step, and rounds each time."),
        "solver_position_iterations": (1, "Drives stop a joint at once."),
        "linear damping": (0.0, "PhysX slows every link down, against the ground."),
    },
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

JOINT_DEFAULT = Preset(
    "The same emulation and forces in SI units, with SAPIEN's own solver and damping of links.",
    JOINT_OPTIONS,
    known_deviation="every mass is slowed down against the ground, by 5 % of its velocity in a second",
    law=damped_links,
    normal_force=NormalForce.MODULATED,
)

CONTACT_TUNED = Preset(
    "Spheres pressed on plates; springs, dashpots and drive as forces at the start of the step.",
    CONTACT_OPTIONS,
    {"enable_tgs": (False, "Projected Gauss–Seidel finds friction before masses move.")},
    shares_scheme=True,
    # A stuck contact is drawn back to where it began to stick, from wherever roundings have brought it since; a run
    # that begins takes where it is.
    split_tolerance=1e-5,
    normal_force=NormalForce.MODULATED,
    turns=True,
    static_friction=True,
    turned_bound=_tangents_of_a_slow_slip,
    judged=("chain", "blocks"),
)

CONTACT_DEFAULT = Preset(
    "The same spheres and forces with SAPIEN's own solver.",
    CONTACT_OPTIONS,
    known_deviation=(
        "a contact that comes to rest in a step still slips in its first substeps, of which each takes 63 % of the "
        "slip, and is drawn back in the last ones"
    ),
    law=temporal_gauss_seidel,
    split_tolerance=1e-4,
    normal_force=NormalForce.MODULATED,
    turns=True,
    static_friction=True,
)

JOINT_RECOMMENDED = replace(
    JOINT_DEFAULT,
    description="For joints of any model: drives as dry friction, without PhysX's damping; more does not help an arm.",
    changes={"linear damping": (0.0, "PhysX slows every link down, against the ground.")},
    optional=True,
    judged=("scenes",),
)

CONTACT_RECOMMENDED = replace(
    CONTACT_DEFAULT,
    description="For contacts of any model: as SAPIEN comes, for any other number of iterations creeps more somewhere.",
    optional=True,
    varied={"solver_velocity_iterations": (0, 2), "solver_position_iterations": (4, 50)},
    judged=("scenes",),
)
