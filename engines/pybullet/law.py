"""The laws of Bullet's damping, which slows every mass down against the ground."""

from dataclasses import replace

from multibody_xval.engines.interface.laws import Constant, Law, Step
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law
from reference_lcp.chain.simulation import Lane


def damped_joints(preset: Preset) -> Law:
    """Give the law of a tree of links, whose damping grows with their speed."""
    damping = preset["linearDamping"]
    return Law(
        formula="equation (5) with the force −m (k v + k_2 v |v|) of the start of the step on every mass",
        constants={
            "k": Constant(damping, "1/s", "linearDamping"),
            "k_2": Constant(damping, "1/m", "linearDamping: the force of a link is m v (k + k |v|), |v| in m/s"),
        },
        step=lambda lane, of: _step(lane, 1 - lane.time_step * of["k"], of["k_2"]),
    )


def damped_bodies(preset: Preset) -> Law:
    """Give the law of free bodies, which lose a part of their velocity before anything else."""
    return Law(
        formula="equation (5) from q̇ (1 − k)^h, h in s, with springs and dashpots from q̇ itself",
        constants={"k": Constant(preset["linearDamping"], "", "linearDamping: the part lost in a second")},
        step=lambda lane, of: _step(lane, (1 - of["k"]) ** lane.time_step, 0.0),
    )


def _step(lane: Lane, kept: float, drag: float) -> Step:
    """Leave this part of a mass's velocity before forces act."""
    chain, h, mass = lane.chain, lane.time_step, lane.chain.mass_matrix
    step = LinearStep.of(chain, h, mass, kept * mass - h * chain.damping_matrix)
    return linear_law(lane, replace(step, quadratic_drag=drag))


LAWS = {"joint:default": damped_joints, "contact:default": damped_bodies}
"""By formulation and preset."""
