"""The law of Rapier's substeps: forces of the start of a step, and friction solved anew in every part of it."""

import functools
from collections.abc import Mapping

import numpy as np

from engines.interface.law import Law
from engines.interface.presets import Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray

SINGLE_PRECISION_PERIOD = 3e-5
"""Of U0: positions and velocities are rounded to 2^-24 in each of 1,600 substeps."""


def motor_substeps(preset: Preset) -> Law:
    """Give the law of a motor, which reports its impulse of the last substep."""
    return _substeps(preset, friction_of_last=True)


def contact_substeps(preset: Preset) -> Law:
    """Give the law of a contact, which reports its impulses of all substeps."""
    return _substeps(preset, friction_of_last=False)


def _substeps(preset: Preset, *, friction_of_last: bool) -> Law:
    count = preset["num_solver_iterations"]
    return Law(
        formula=(
            f"{count} times, with h = Δt/{count} and F = f(t) e_1 − C q̇ − K q of the start of the step: "
            "q̇ ← q̇ + M⁻¹ (h F + W p), Coulomb's law with |p| ≤ h μ λ_N; q ← q + h q̇"
        ),
        model=functools.partial(_SubsteppedLane, substeps=count, friction_of_last=friction_of_last),
        period_bound=SINGLE_PRECISION_PERIOD,
        bound_reason="single precision: every substep rounds to 2^-24",
        modulated=True,
    )


class _SubsteppedLane(LaneModel):
    """One chain under forces that are constant over the substeps of a step."""

    def __init__(self, lane: Lane, _: Mapping[str, float], substeps: int, *, friction_of_last: bool):
        chain = lane.chain
        self.lane = lane
        self._force = -np.hstack([chain.stiffness_matrix, chain.damping_matrix])
        # The part of every substep in the friction that is reported.
        self._reported = np.full(substeps, 0.0 if friction_of_last else 1 / substeps)
        self._reported[-1] += friction_of_last

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
        return State(motion[None, : motion.size // 2], motion[None, motion.size // 2 :])

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> FloatArray:
        """Run the kernel; gives positions, then velocities, at the end, shape (4n,)."""
        from engines.rapier.law_kernel import advance  # numba is imported once something moves

        lane, chain = self.lane, self.lane.chain
        motion = np.concatenate([state.positions[0], state.velocities[0]])
        bounds = np.ascontiguousarray(chain.friction_coefficient * lane.preloads(start, steps))
        masses = np.stack([chain.outer_mass, chain.inner_mass])
        advance(
            motion, lane.loads(start, steps), bounds, self._force, masses, self._reported,
            lane.time_step / self._reported.size, record,
        )  # fmt: skip
        return motion
