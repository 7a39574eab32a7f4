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

SINGLE_PRECISION_PERIOD = 6e-5
"""Of U0: positions and velocities, of some U0 and U0 ω, are rounded by 2^-24 in each of 1,600 substeps. Roundings add
up as the root of their number: three standard deviations for motions of up to eight U0."""

FALLS_ASLEEP = 0.5
"""Length of a step [s] from which on Rapier stops every body in it, whatever its speed and the forces on it."""

FORMULA = "{count} times, with h = Δt/{count} and F = f(t) e_1 − C q̇ − K q of the start of the step: "


def motor_substeps(preset: Preset) -> Law:
    """Give the law of motors, whose impulses are found before positions move, and reported of the last substep."""
    formula = "q̇ ← q̇ + M⁻¹ (h F + W p), |p| ≤ h μ λ_N by Coulomb's law; q ← q + h q̇"
    return _substeps(preset, formula, friction_first=True)


def contact_substeps(preset: Preset) -> Law:
    """Give the law of contacts, whose friction is found after positions have moved, and reported of all substeps."""
    formula = (
        "q ← q + h (q̇ + M⁻¹ (h F + W p)) with p of the substep before, at first of the step's own end; then "
        "q̇ ← q̇ + M⁻¹ (h F + W p), |p| ≤ h μ λ_N by Coulomb's law"
    )
    return _substeps(preset, formula, friction_first=False)


def _substeps(preset: Preset, formula: str, *, friction_first: bool) -> Law:
    count = preset["num_solver_iterations"]
    return Law(
        formula=FORMULA.format(count=count) + formula,
        model=functools.partial(_SubsteppedLane, substeps=count, friction_first=friction_first),
        period_bound=SINGLE_PRECISION_PERIOD,
        bound_reason="single precision: every substep rounds by 2^-24",
        modulated=True,
        unmodelled_reason=_sleep,
    )


def _sleep(lane: Lane) -> str | None:
    """Say where masses may be stopped."""
    if lane.time_step < FALLS_ASLEEP:
        return None
    return f"a step of {lane.time_step:g} s puts every mass to sleep; allowed: below {FALLS_ASLEEP:g} s"


class _SubsteppedLane(LaneModel):
    """One chain under forces that are constant over the substeps of a step."""

    def __init__(self, lane: Lane, _: Mapping[str, float], substeps: int, *, friction_first: bool):
        chain = lane.chain
        self.lane = lane
        self._force = -np.hstack([chain.stiffness_matrix, chain.damping_matrix])
        self._substeps, self._friction_first = substeps, friction_first

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        lane, size = self.lane, 2 * self.lane.chain.cells
        record = np.empty((steps, 5 * lane.chain.cells))
        end = self._integrate(state, start, steps, record)
        return Trajectory(
            lane.times(start, steps),
            record[:, :size],
            record[:, size : 2 * size],
            record[:, 2 * size :],
            lane.preloads(start, steps),
            None if end.internal_state is None else end.internal_state[0],
        )

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and keep the end only."""
        return self._integrate(state, start, steps, np.empty((0, 5 * self.lane.chain.cells)))

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        """Run the kernel; gives the end, whose internal state is the friction by which positions move next."""
        from engines.rapier.law_kernel import advance  # numba is imported once something moves

        lane, chain = self.lane, self.lane.chain
        motion = np.concatenate([state.positions[0], state.velocities[0]])
        bounds = np.ascontiguousarray(chain.friction_coefficient * lane.preloads(start, steps))
        masses = np.concatenate([chain.outer_mass, chain.inner_mass])
        friction, loads = np.zeros(chain.cells), lane.loads(start, steps)
        given = self._force, masses, (lane.time_step / self._substeps, self._substeps, self._friction_first)
        if state.internal_state is not None:
            friction[:] = state.internal_state[0]
        elif not self._friction_first:
            # The first step is taken twice, and only its friction kept of the first time.
            advance(motion.copy(), friction, loads[:1], bounds[:1], *given, record[:0])
        advance(motion, friction, loads, bounds, *given, record)
        position, velocity = np.split(motion[None], 2, axis=1)
        return State(position, velocity, None if self._friction_first else friction[None])
