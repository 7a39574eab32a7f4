"""The scheme as the paper writes it: equation (5) step by step, its LCP solved by Lemke's method."""

from dataclasses import replace

import numpy as np

from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import normal_motion
from reference_lcp.chain.simulation import Lane, common_cells
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.lcp.static_friction import solve_stick_slip_step
from reference_lcp.lcp.time_step import FrictionalStep, advanced
from reference_lcp.stepping.sequential import LaneModel, SequentialSimulation
from reference_lcp.validation import FloatArray


class LemkeSimulation(SequentialSimulation):
    """The Euler scheme with Lemke's method in every step; a `Simulation`, slower than the closed form.

    Friction at rest may be larger than in motion, see `reference_lcp.lcp.static_friction`.
    """

    def __init__(self, lanes: list[Lane] | tuple[Lane, ...]):
        common_cells(lanes)
        super().__init__([_LemkeLane(lane) for lane in lanes])


class _LemkeLane(LaneModel):
    """One chain under one drive, advanced step by step."""

    def __init__(self, lane: Lane):
        self.lane = lane

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        chain = self.lane.chain
        u, q = state.positions[0].copy(), state.velocities[0].copy()
        positions, velocities = np.empty((steps, u.size)), np.empty((steps, u.size))
        friction = np.empty((steps, chain.cells))
        dt, basis = self.lane.time_step, None
        # With faces along the row nothing couples the normal direction to the row's motion.
        gap, speed = (part[0] for part in state.normal_state(chain.cells)) if self.lane.opens else np.zeros((2, 1))
        normal = normal_motion(self.lane.preloads(start, steps), chain.inner_mass, dt, gap, speed)
        for row, load in enumerate(self.lane.loads(start, steps)):
            step = replace(
                chain_step(chain, u, q, load, dt),
                normal_force=normal.normal_force[row],
                static_friction_coefficient=self.lane.static_ratio * chain.friction_coefficient,
            )
            impulses = solve_stick_slip_step(step, warm_start=basis)
            basis = impulses.basic
            u, q = advanced(step, impulses, u)
            positions[row], velocities[row] = u, q
            friction[row] = impulses.tangential / dt
        times, internal_state = self.lane.times(start, steps), np.concatenate([normal.gap[-1], normal.speed])
        own = (internal_state, normal.gap) if self.lane.opens else (None, None)
        return Trajectory(times, positions, velocities, friction, normal.normal_force, *own)


def chain_step(chain: Chain, u: FloatArray, q: FloatArray, load: float, time_step: float) -> FrictionalStep:
    """Equation (7)'s data for one step of the chain: h = f − K u − C q, contact directions W_T.

    The normal force presses inner on outer mass across the row; it has no part along the motion,
    so W_N is zero and λ_N enters as the friction bound alone.
    """
    force = -chain.stiffness_matrix @ u - chain.damping_matrix @ q
    force[0] += load
    none, still = np.zeros((2 * chain.cells, chain.cells)), np.zeros(chain.cells)
    return FrictionalStep(
        mass_matrix=chain.mass_matrix,
        force=force,
        velocity=q,
        time_step=time_step,
        normal_directions=none,
        tangential_directions=chain.contact_directions,
        tangential_directions_of_position=none,
        normal_motion=still,
        tangential_motion=still,
        normal_gap=still,
        relative_velocity=chain.contact_directions.T @ q,
        friction_coefficient=chain.friction_coefficient,
    )
