"""The laws of Bullet's default damping: it slows every mass down against the ground."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from engines.interface.law import Constant, Law
from engines.interface.presets import Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.stepping.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction


def damped_joints(preset: Preset) -> Law:
    """Give the law of a tree of links, whose damping grows with their speed."""
    damping = preset["linearDamping"]
    return Law(
        formula="equation (5) with the force −m (k v + k_2 v |v|) of the start of the step on every mass",
        constants={
            "k": Constant(damping, "1/s", "linearDamping"),
            "k_2": Constant(damping, "1/m", "linearDamping: the force of a link is m v (k + k |v|), |v| in m/s"),
        },
        model=_damped_joints,
        modulated=True,
    )


def damped_bodies(preset: Preset) -> Law:
    """Give the law of free bodies, which lose a part of their velocity before anything else."""
    return Law(
        formula="equation (5) from q̇ (1 − k)^h, h in s, with springs and dashpots from q̇ itself",
        constants={"k": Constant(preset["linearDamping"], "", "linearDamping: the part lost in a second")},
        model=_damped_bodies,
        modulated=True,
    )


def _damped_joints(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    chain, h = lane.chain, lane.time_step
    mass = chain.mass_matrix
    velocity = (1 - h * constants["k"]) * mass - h * chain.damping_matrix
    drag = np.full(2 * chain.cells, constants["k_2"])
    step = replace(LinearStep.of(chain, h, mass, velocity, (1.0, 0.0)), quadratic_drag=drag)
    return LinearImplicitLane(lane, step, ScalarFriction.coulomb(chain.cells))


def _damped_bodies(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    chain, h = lane.chain, lane.time_step
    mass = chain.mass_matrix
    step = LinearStep.of(chain, h, mass, (1 - constants["k"]) ** h * mass - h * chain.damping_matrix, (1.0, 0.0))
    return LinearImplicitLane(lane, step, ScalarFriction.coulomb(chain.cells))
