"""What the tuned options of an engine put away: with its own value of one of them it moves otherwise, and how far."""

import dataclasses
import math

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.drives import StillBase
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    STEPS,
    chain_of,
    distance,
    lane_of,
    random_state,
    run,
    uneven_lane,
    with_coefficients,
)

REST = State.at_rest(1, 7)


def left_alone(friction_ratio: float, **ratios: float) -> tuple[Lane, State, int]:
    """A motion slower than 0.01 m/s, for more than half a second."""
    slow = State(random_state(size=1e-3).positions, np.zeros((1, 14)))
    return dataclasses.replace(lane_of(friction_ratio, **ratios), drive=StillBase(1e-5)), slow, 3 * STEPS


MOTIONS = {
    "random": (lane_of(), random_state(), STEPS),
    "from rest": (lane_of(), REST, STEPS),
    "for long": (lane_of(0.3, 0.9), REST, 10 * STEPS),
    "uneven": (uneven_lane(), random_state(), STEPS),
    "stuck": (lane_of(5.0, 0.3), REST, 3 * STEPS),
    "stuck aside": (lane_of(5.0), State(np.repeat([0, AMPLITUDE], 7)[None], REST.velocities), STEPS),
    "stuck in tenths of a millimetre": (chain_of(1.0, 1e3, AMPLITUDE / 100, 5.0), REST, STEPS),
    "undamped": (lane_of(0.0, damping_ratio=0.0), random_state(), 2 * STEPS),
    "a coefficient of 3": (with_coefficients(3.0), random_state(), STEPS),
    "far": (lane_of(), random_state(size=1e7), STEPS // 8),
    "slow": left_alone(0.3),
    "slow and free": left_alone(0.0, damping_ratio=0.0),
}

DEFAULT: dict[str, object] = {}

OWN_VALUES = [
    # Implicit springs of joints damp, and so do forces that stay over four substeps.
    ("box2d3", "random", {"springs": "prismatic joints"}, 0.3),
    ("box2d3", "random", {"sub_step_count": 4}, 0.07),
    # No body is faster than 400 units.
    ("box2d3", "far", {"maximum_linear_speed": 400.0}, 1.2),
    # What is slower than 0.05 m/s for half a second sleeps.
    ("box2d3", "slow and free", {"units": "SI", "sleeping_enabled": True}, 0.6),
    # The regularised law itself: a stuck joint creeps.
    ("mujoco", "stuck", {"noslip_iterations": 0}, 0.012),
    # Sliding contacts are solved for to a fixed 1e-10.
    ("mujoco:contact", "a coefficient of 3", {"units": "lane"}, 4e-4),
    # One iteration has not converged; a sweep without softness makes up for it.
    ("mujoco-warp", "uneven", {"units": "SI", "iterations": 1, "noslip_iterations": 0}, 0.1),
    # A tolerance of 1e-6 in units of the model takes anything for converged, where accelerations are smaller.
    ("mujoco-warp", "uneven", {"iterations": 100, "noslip_iterations": 0}, 0.1),
    # ODE 0.16 has a new number before dParamFMax: the binding sets the lowest velocity, and nothing rubs.
    ("ode", "random", {"fmax": 3}, 0.3),
    # Soft constraints creep.
    ("ode", "stuck", {"units": "SI", "cfm": 1e-10}, 3.5e-9),
    # Redundant points of a hard contact, without a word.
    ("ode:contact", "for long", {"shape": "box", "inertia": 2.0**20}, 0.6),
    ("ode:contact", "for long", {"shape": "box", "inertia": 2.0**60}, 0.6),
    # Positions come first: forces set at the start of a step act a step late, and feed vibrations.
    ("pymunk", "undamped", {"positions": "as they are"}, 1.2),
    # The bias of joints pulls contacts back to where they started.
    ("pymunk", "stuck aside", {"max_bias": math.inf}, 0.6),
    # Every joint is born with a motor, which freezes the chain.
    ("pybullet", "from rest", {"outer motor force": 1e6}, 1.0),
    # Damping of bodies is a rate: 0.04 in a second is another one in a time step.
    ("pybullet", "from rest", {"linearDamping": 0.04}, 0.85),
    # A motor of a weak gain leaves nine tenths of the slip.
    ("pybullet", "stuck", {"velocityGain": 0.1}, 0.27),
    ("rapier:contact", "random", {"contact_recycling": True}, 8e-3),
    ("rapier", "stuck", {"motor factor": 1e3}, 3.5e-5),
    # No body is faster than 400 units.
    ("rapier", "far", {"normalized_max_linear_velocity": 400.0}, 1.2),
    # Forces keep bodies awake, but for steps as long as the time after which a slow one sleeps.
    ("rapier", "slow", {"can_sleep": True}, 0.9),
    ("rapier:contact", "slow", {"can_sleep": True}, 0.9),
    # Links are slowed down, joints rub, and both are cut off unless they are told not to be.
    ("sapien", "random", {"units": "SI", "linear damping": 0.05}, 6e-3),
    ("sapien", "random", {"joint friction": 0.05}, 0.12),
    ("sapien", "far", {"max joint velocity": 100.0}, 1.2),
    ("sapien", "far", {"max linear velocity": 10.0}, 1.1),
    # A rotation that is locked still yields unless it is heavy.
    ("sapien:contact", "random", {"inertia": 1e6}, 0.08),
    # Default contacts that stick creep, whatever the step.
    ("mujoco:joint:default", "stuck", DEFAULT, 0.1),
    ("mujoco:contact:default", "stuck", DEFAULT, 0.036),
    ("exudyn-bristle:joint:default", "stuck", DEFAULT, 0.045),
    # Its zone is in metres per second.
    ("exudyn-regularised:joint:default", "stuck in tenths of a millimetre", DEFAULT, 0.06),
]


@pytest.mark.parametrize(
    ("name", "motion", "values", "apart"),
    [pytest.param(*row, id=f"{row[0]} {' '.join(row[2])}", marks=pytest.mark.needs(row[0].split(":")[0]))
     for row in OWN_VALUES],
)  # fmt: skip
def test_its_own_value_moves_a_chain_otherwise_and_the_tuned_one_does_not(name, motion, values, apart) -> None:
    """Largest distance from the scheme, over the largest displacement."""
    lane, state, steps = MOTIONS[motion]
    own, sound = run(name, lane, state, steps, **values), run(str(Variant.parse(name).tuned), lane, state, steps)
    assert distance(lane, state, own) == pytest.approx(apart, rel=0.5)
    assert distance(lane, state, sound) < apart / 20
