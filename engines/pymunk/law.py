"""The law of Chipmunk's damped springs: positions first, then springs, then sweeps over frictions and dashpots."""

import functools
from collections.abc import Mapping

import numpy as np

from engines.interface.law import Law
from engines.interface.presets import NormalForce, Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray


def damped_springs(preset: Preset) -> Law:
    """Give the law of damped springs; it has no constants beside the chain's."""
    sweeps = preset["iterations"]
    return Law(
        formula=(
            "q⁺ = q + h q̇; q̇ ← q̇ + h M⁻¹ (f(t) e_1 − K q⁺); "
            f"then {sweeps} sweeps: every friction impulse to rest, in sum within ±h μ λ_N, then every dashpot, c_c "
            "before c_i: d = (r_0 − r)(1 − exp(−c h A)) on its rate r, r_0 ← r + d, r_0 = 0 at first, "
            "A the sum of the inverse masses at its ends"
        ),
        model=functools.partial(_damped_springs, sweeps=sweeps),
        modulated=preset.represents(NormalForce.MODULATED),
    )


def _damped_springs(lane: Lane, _: Mapping[str, float], sweeps: int) -> "_ChipmunkLane":
    return _ChipmunkLane(lane, sweeps)


class _ChipmunkLane(LaneModel):
    """One chain of damped springs."""

    def __init__(self, lane: Lane, sweeps: int):
        self.lane = lane
        chain, h = lane.chain, lane.time_step
        inverse_outer, inverse_inner = 1 / chain.outer_mass, 1 / chain.inner_mass
        # The first chain spring hangs on the ground.
        left = np.concatenate([[0.0], inverse_outer[:-1]])
        self._masses = inverse_outer, inverse_inner
        self._springs = h * chain.stiffness_matrix
        self._dashpots = (
            1 - np.exp(-chain.chain_damping * h * (left + inverse_outer)),
            1 - np.exp(-chain.inner_damping * h * (inverse_outer + inverse_inner)),
        )
        self._sweeps = sweeps

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        lane, size = self.lane, 2 * self.lane.chain.cells
        record = np.empty((steps, 5 * lane.chain.cells))
        self._integrate(state, start, steps, record)
        return Trajectory(
            lane.times(start, steps),
            record[:, :size],
            record[:, size : 2 * size],
            record[:, 2 * size :],
            lane.preloads(start, steps),
        )

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and keep the end only."""
        motion = self._integrate(state, start, steps, np.empty((0, 5 * self.lane.chain.cells)))
        return State(motion[:1], motion[1:])

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> FloatArray:
        """Run the kernel; gives positions and velocities at the end, shape (2, 2n)."""
        from engines.pymunk.law_kernel import advance  # numba is imported once something moves

        lane, h = self.lane, self.lane.time_step
        motion = np.vstack([state.positions[0], state.velocities[0]])
        bounds = np.ascontiguousarray(h * lane.chain.friction_coefficient * lane.preloads(start, steps))
        advance(
            motion, h * lane.loads(start, steps), bounds, self._masses, self._springs, self._dashpots,
            (h, self._sweeps), record,
        )  # fmt: skip
        return motion
