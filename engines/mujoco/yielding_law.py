"""The law of MuJoCo's springs that yield, in the steps of its Euler integrator."""

from collections.abc import Mapping

import numpy as np

from engines.interface.law import Constant, Law
from engines.interface.presets import Preset
from engines.mujoco.yielding_state import deflections_at, yield_stiffness
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.linear_implicit import LinearStep
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray


def yielding_spring(preset: Preset) -> Law:
    """Give the law of a spring that yields."""
    return Law(
        formula=(
            "q̇⁺ = q̇ + h M⁻¹ (f(t) e_1 − C q̇ − K q − W k_s x), q⁺ = q + h q̇⁺, x⁺ = clip(x + h w⁺, ±F / k_s), "
            "k_s = m_red (θ / h)², 1 / m_red = 1 / m_o + 1 / m_i"
        ),
        constants={"θ": Constant(preset["spring_phase"], "", "spring_phase, and so stiffness and springyield")},
        model=_model,
    )


def _model(lane: Lane, constants: Mapping[str, float]) -> "YieldingLane":
    return YieldingLane(lane, constants["θ"])


class YieldingLane(LaneModel):
    """One chain under one drive; every contact is a spring in series with a slider.

    Parameters
    ----------
    lane
        The chain, its drive and the time step.
    phase
        θ: the angle by which a stuck contact oscillates in a step.
    """

    def __init__(self, lane: Lane, phase: float):
        self.lane = lane
        chain, step = lane.chain, LinearStep.explicit(lane.chain, lane.time_step)
        count = 2 * chain.cells
        self._stiffness = yield_stiffness(chain, lane.time_step, phase)
        self._matrices = step.state[:count], step.load[:count, 0], -lane.time_step * step.response * self._stiffness

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        size = 2 * self.lane.chain.cells
        record = np.empty((steps, 5 * self.lane.chain.cells))
        end = self._integrate(state, start, steps, record)
        return Trajectory(
            self.lane.times(start, steps),
            record[:, :size],
            record[:, size : 2 * size],
            -self._stiffness * record[:, 2 * size :],
            self.lane.preloads(start, steps),
            record[-1, 2 * size :] if end.internal_state is not None else None,
        )

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and keep the end only."""
        return self._integrate(state, start, steps, np.empty((0, 5 * self.lane.chain.cells)))

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        from engines.mujoco.yielding_kernel import advance  # numba is imported once something moves

        lane = self.lane
        motion = np.vstack([state.positions[0], state.velocities[0]])
        deflection = deflections_at(state, lane, start, self._stiffness)
        limit = lane.chain.friction_bound / self._stiffness
        matrices = [np.ascontiguousarray(matrix) for matrix in self._matrices]
        advance(motion, deflection, lane.loads(start, steps), *matrices, lane.time_step, limit, record)
        return State(motion[:1], motion[1:], deflection[None])
