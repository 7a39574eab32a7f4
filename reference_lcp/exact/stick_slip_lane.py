"""The exact motion of a chain whose friction at rest is larger than in motion."""

import math

import numpy as np

from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.exact.event_driven_system import EventDrivenSystem
from reference_lcp.exact.mode_dynamics import harmonic_load
from reference_lcp.lcp.mass_spring_system import FrictionContact, MassSpringSystem, Spring
from reference_lcp.lcp.signal import Harmonic, Signal
from reference_lcp.refusal import ParameterError
from reference_lcp.stepping.sequential import LaneModel


class StickSlipLane(LaneModel):
    """A lane, advanced from event to event as a `MassSpringSystem` and read at the ends of its time steps.

    Parameters
    ----------
    lane
        Its drive is harmonic, or still.

    Raises
    ------
    ParameterError
        If the drive is another, or the normal force changes.
    """

    def __init__(self, lane: Lane):
        if lane.preload is not None:
            raise ParameterError("the event-driven solver cannot represent a modulated normal force; allowed: constant")
        self.lane = lane
        self._frequency, (sine, cosine) = harmonic_load(lane.chain, lane.drive)
        self._amplitude, self._phase = math.hypot(sine, cosine), math.atan2(cosine, sine)

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`; λ_T is that of the instant of each row."""
        lane = self.lane
        phase = self._phase + self._frequency * start * lane.time_step
        load = Harmonic(amplitude=self._amplitude, angular_frequency=self._frequency, phase=phase)
        system = system_of(lane.chain, load, lane.static_ratio)
        motion = EventDrivenSystem(system).motion(
            position=state.positions[0], velocity=state.velocities[0], times=lane.times(0, steps)
        )
        return Trajectory(
            lane.times(start, steps), motion.positions, motion.velocities, motion.friction, motion.normal_force
        )


def system_of(chain: Chain, load: Signal, static_ratio: float = 1.0) -> MassSpringSystem:
    """Give a chain body by body, outer masses first.

    Parameters
    ----------
    chain
        The chain; its base stands still.
    load
        Force on the first outer mass [N].
    static_ratio
        μ_s / μ_k of every contact.
    """
    n = chain.cells
    outer = [Spring(k, k - 1 if k else None, chain.chain_stiffness[k], chain.chain_damping[k]) for k in range(n)]
    inner = [Spring(n + k, k, chain.inner_stiffness[k], chain.inner_damping[k]) for k in range(n)]
    friction = [
        FrictionContact(n + k, k, float(chain.normal_force[k]), mu, static_ratio * mu)
        for k, mu in enumerate(chain.friction_coefficient.tolist())
    ]
    masses = np.concatenate([chain.outer_mass, chain.inner_mass])
    return MassSpringSystem(masses=masses, springs=[*outer, *inner], friction=friction, forces={0: load})
