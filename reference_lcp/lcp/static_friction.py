"""A step of equation (7) with friction at rest that may be larger than in motion.

With μ_s > μ_k the law of a contact is

    |λ_T| <= μ_s λ_N where ġ_T = 0,        λ_T = −μ_k λ_N sign ġ_T elsewhere,

and a step is a sequence of LCPs, each equation (7) with one coefficient a contact:

1. contacts at rest at the start of the step have μ_s, all others μ_k;
2. a contact with μ_s that slips in the solution is released: it has μ_k from then on. One with μ_k whose relative
   velocity has changed its sign passed rest within the step, and has μ_s. The LCP is solved anew.

Each contact changes at most twice, so that at most 2c + 1 LCPs are solved; what the last one gives fulfils the law in
every contact. With a given normal force each LCP is that of a convex quadratic programme, whose relative velocities are
unique. The law is not monotone, though, where μ_s > μ_k: other sets of sliding contacts may fulfil it too, and of
these it is the rule above that chooses: rest before slip, and all that break away in one LCP are released together.
With μ_s = μ_k there is one LCP, and nothing to choose.
"""

import dataclasses

import numpy as np
from numpy.typing import NDArray

from reference_lcp.lcp.time_step import ContactImpulses, FrictionalStep, solve_step, solve_step_given_normal_force

REST_TOLERANCE = 1e-12
"""Relative velocity over the largest velocity of the step at which a contact is at rest: roundings of its solution."""


def solve_stick_slip_step(step: FrictionalStep, *, warm_start: NDArray[np.bool_] | None = None) -> ContactImpulses:
    """Solve a step by Lemke's method: with its given normal force if it has one, with μ_s of what is at rest.

    `warm_start` and what is raised are as in `solve_step`.
    """
    if step.contacts == 0:
        none = np.zeros(0)
        return ContactImpulses(none, none, none, none, np.zeros(0, dtype=bool))
    static = step.static_friction_coefficient
    if static is None or np.array_equal(static, step.friction_coefficient):
        return _solved(step, warm_start)
    rest = REST_TOLERANCE * _fastest(step)
    before = np.where(np.abs(step.relative_velocity) > rest, np.sign(step.relative_velocity), 0.0)
    holds, released = before == 0, np.zeros(step.contacts, dtype=bool)
    while True:
        coefficient = np.where(holds, static, step.friction_coefficient)
        impulses = _solved(dataclasses.replace(step, friction_coefficient=coefficient), warm_start)
        slips = np.abs(impulses.relative_velocity) > rest
        breaks = holds & slips
        turns = ~holds & ~released & slips & (impulses.relative_velocity * before < 0)
        if not np.any(breaks | turns):
            return impulses
        holds, released, warm_start = (holds | turns) & ~breaks, released | breaks, impulses.basic


def _solved(step: FrictionalStep, warm_start: NDArray[np.bool_] | None) -> ContactImpulses:
    if step.normal_force is None:
        return solve_step(step, warm_start=warm_start)
    return solve_step_given_normal_force(step, step.normal_force * step.time_step, warm_start=warm_start)


def _fastest(step: FrictionalStep) -> float:
    """Largest velocity of the step, or what its forces make [m/s]."""
    gained = step.free_acceleration * step.time_step
    return float(np.max(np.abs(step.velocity), initial=0.0) + np.max(np.abs(gained), initial=0.0))
