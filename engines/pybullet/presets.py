"""Options and presets of PyBullet, and the laws of its damping, which slows every mass down against the ground."""

from dataclasses import replace

import numpy as np

from multibody_xval.engines.interface.law import Constant, Law
from multibody_xval.engines.interface.presets import NormalForce, Option, Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.schemes.linear_implicit import LinearImplicitLane, LinearStep


def damped_joints(preset: Preset) -> Law:
    """Give the law of a tree of links, whose damping grows with their speed."""
    damping = preset["linearDamping"]
    return Law(
        formula="equation (5) with the force −m (k v + k_2 v |v|) of the start of the step on every mass",
        constants={
            "k": Constant(damping, "1/s", "linearDamping", ideal=0.0),
            "k_2": Constant(
                damping, "1/m", "linearDamping: the force of a link is m v (k + k |v|), |v| in m/s", ideal=0.0
            ),
        },
        model=lambda lane, of: _damped(lane, 1 - lane.time_step * of["k"], of["k_2"]),
        modulated=True,
    )


def damped_bodies(preset: Preset) -> Law:
    """Give the law of free bodies, which lose a part of their velocity before anything else."""
    return Law(
        formula="equation (5) from q̇ (1 − k)^h, h in s, with springs and dashpots from q̇ itself",
        constants={"k": Constant(preset["linearDamping"], "", "linearDamping: the part lost in a second", ideal=0.0)},
        model=lambda lane, of: _damped(lane, (1 - of["k"]) ** lane.time_step),
        modulated=True,
    )


def _damped(lane: Lane, kept: float, drag: float = 0.0) -> LinearImplicitLane:
    """Give the step in which this part of a mass's velocity is left before forces act."""
    chain, h, mass = lane.chain, lane.time_step, lane.chain.mass_matrix
    step = LinearStep.of(chain, h, mass, kept * mass - h * chain.damping_matrix, (1.0, 0.0))
    return LinearImplicitLane(lane, replace(step, quadratic_drag=np.full(2 * chain.cells, drag)))


UNITS = Option.own("SI", "The chain in SI units.")
DAMPING = Option.own(0.04, "Bullet's own; it slows every body down, against the ground.")

TUNED = {
    "units": ("lane", "No number comes near Bullet's built-in smallest and largest ones."),
    "linearDamping": (0.0, "Bullet slows every body down, against the ground."),
}
"""What the tuned presets of both formulations change alike."""

JOINT_OPTIONS = {
    "units": UNITS,
    "velocityGain": Option.own(1.0, "Bullet's own."),
    "outer motor force": Option(0.0, "large", "Needed: a new joint has a motor that locks it."),
    "linearDamping": DAMPING,
    "maxJointVelocity": Option.own(100.0, "Bullet's own."),
}

JOINT_TUNED = Preset(
    "Dry friction emulated, as is usual, by velocity motors that hold with at most its bound; no damping by Bullet.",
    JOINT_OPTIONS,
    {
        **TUNED,
        "velocityGain": (1.0, "The motor's share of the velocity that it removes in one step."),
        "outer motor force": (0.0, "A new joint has a motor that locks it."),
        "maxJointVelocity": (1e30, "Bullet cuts joint velocities off, whatever the units."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

JOINT_DEFAULT = Preset(
    "Dry friction emulated by the same motors in SI units, and Bullet's default options.",
    JOINT_OPTIONS,
    known_deviation=(
        "Bullet's damping, 0.04 /s of the velocity v and 0.04 /m of v |v|, slows every mass down against the ground, "
        "whatever the time step"
    ),
    law=damped_joints,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
)

CONTACT_OPTIONS = {
    "units": UNITS,
    "localInertiaDiagonal": Option((0.0, 0.0, 0.0), "of the box", "Needed: the chain moves along a line."),
    "linearDamping": DAMPING,
    "solverResidualThreshold": Option.own(1e-7, "Bullet's own; below it the solver stops."),
}

CONTACT_TUNED = Preset(
    "Boxes without rotation or damping, and a contact solver that never stops early: it then equals equation (5).",
    CONTACT_OPTIONS,
    {
        **TUNED,
        "localInertiaDiagonal": ((0.0, 0.0, 0.0), "Bullet takes zero for infinite: no rotation."),
        "solverResidualThreshold": (0.0, "The solver stops early otherwise, and stuck contacts creep."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.LIFTING,
    turns=True,
    judged=("chain", "blocks"),
)

CONTACT_DEFAULT = Preset(
    "The same boxes in SI units, with Bullet's own damping and its own solver.",
    CONTACT_OPTIONS,
    known_deviation=(
        "Bullet's linear damping, 0.04 a second, slows every mass down against the ground, whatever the time step"
    ),
    law=damped_bodies,
    split_tolerance=1e-12,
    normal_force=NormalForce.LIFTING,
    turns=True,
)

JOINT_RECOMMENDED = Preset(
    "For joints of any model: motors as dry friction, without Bullet's damping; more does not help an arm.",
    JOINT_OPTIONS,
    {"linearDamping": (0.0, "Bullet slows every body down, against the ground.")},
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
    optional=True,
    judged=("scenes",),
)

CONTACT_RECOMMENDED = Preset(
    "For contacts of any model: no damping, a solver that does not stop early, and anchors where bodies stick.",
    {
        **CONTACT_OPTIONS,
        "angularDamping": Option.own(0.04, "Bullet's own."),
        "frictionAnchor": Option.own(0, "Bullet's own: a stuck contact is not drawn back to where it began to stick."),
    },
    {
        "linearDamping": (0.0, "Bullet slows every body down, against the ground: the largest error of what slides."),
        "angularDamping": (0.0, "Likewise."),
        "solverResidualThreshold": (0.0, "The solver stops early otherwise, and stuck contacts creep."),
        "frictionAnchor": (
            1,
            "In stacks, what is left of creep is drawn back. The chain has none: no run could begin in one.",
        ),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.LIFTING,
    turns=True,
    optional=True,
    judged=("scenes",),
)
