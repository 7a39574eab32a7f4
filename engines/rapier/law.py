"""The law of Rapier's substeps: forces of the start of a step, and friction solved anew in every part of it."""

import functools
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from engines.interface.law import Constant, Law
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

FASTEST = "normalized_max_linear_velocity"
"""Option: velocity [m/s] at which Rapier cuts off that of a body, which a contact's pressing force has a part in."""

LARGEST_MOTION = 8.0
"""Over the displacement scale, at resonances too."""

FORMULA = "{count} times, with h = Δt/{count} and F = f(t) e_1 − C q̇ − K q of the start of the step: "


def motor_substeps(preset: Preset) -> Law:
    """Give the law of motors, whose impulses are found before positions move, and reported of the last substep."""
    formula = (
        "q̇ ← q̇ + M⁻¹ (h F + W p), |p| ≤ h μ λ_N by Coulomb's law, but that a stuck contact slips at p / (h c); "
        "every |q̇| ≤ v_max; q ← q + h q̇"
    )
    constants = {
        "1/c": Constant(1 / preset["motor factor"], "m/(N s)", "one over the damping of motors", too_small_to_see=True),
        "1/v_max": Constant(1 / preset[FASTEST], "s/m", f"one over {FASTEST}", too_small_to_see=True),
    }
    return replace(_substeps(preset, formula, friction_first=True), constants=constants)


def contact_substeps(preset: Preset) -> Law:
    """Give the law of contacts, whose friction is found after positions have moved, and reported of all substeps."""
    formula = (
        "q ← q + h (q̇ + M⁻¹ (h F + W p)) with p of the substep before, at first of the step's own end; then "
        "q̇ ← q̇ + M⁻¹ (h F + W p), |p| ≤ h μ λ_N by Coulomb's law"
    )
    law = _substeps(preset, formula, friction_first=False)
    return replace(law, unmodelled_reason=lambda lane: _sleep(lane) or _cut_off(lane, preset))


def _substeps(preset: Preset, formula: str, *, friction_first: bool) -> Law:
    count = preset["num_solver_iterations"]
    return Law(
        formula=FORMULA.format(count=count) + formula,
        model=functools.partial(_SubsteppedLane, substeps=count, friction_first=friction_first),
        period_bound=SINGLE_PRECISION_PERIOD,
        bound_growth=0.5,
        bound_reason="single precision: every substep rounds by 2^-24",
        modulated=True,
        unmodelled_reason=_sleep,
    )


def _sleep(lane: Lane) -> str | None:
    """Say where masses may be stopped."""
    if lane.time_step < FALLS_ASLEEP:
        return None
    return f"a step of {lane.time_step:g} s puts every mass to sleep; allowed: below {FALLS_ASLEEP:g} s"


def _cut_off(lane: Lane, preset: Preset) -> str | None:
    """Say where a velocity may be cut off, of the motion or of what presses a contact in a substep."""
    chain, fastest = lane.chain, preset[FASTEST]
    moving = LARGEST_MOTION * lane.drive.displacement_scale(chain) * chain.highest_natural_frequency
    swing = 0.0 if lane.preload is None else lane.preload.modulation
    accelerations = (1 + swing) * chain.normal_force / np.minimum(chain.outer_mass, chain.inner_mass)
    speed = moving + float(np.max(accelerations)) * lane.time_step / preset["num_solver_iterations"]
    if speed < fastest:
        return None
    return f"masses may be faster than Rapier lets them, up to {speed:.3g} m/s; allowed: below {fastest:g} m/s"


class _SubsteppedLane(LaneModel):
    """One chain under forces that are constant over the substeps of a step."""

    def __init__(self, lane: Lane, constants: Mapping[str, float], substeps: int, *, friction_first: bool):
        chain = lane.chain
        self.lane = lane
        self._force = -np.hstack([chain.stiffness_matrix, chain.damping_matrix])
        self._substeps, self._friction_first = substeps, friction_first
        self._slowness, self._yielding = constants.get("1/v_max", 0.0), constants.get("1/c", 0.0)

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
        length = lane.time_step / self._substeps
        numbers = length, self._substeps, self._friction_first, self._slowness, self._yielding
        given = self._force, masses, numbers
        if state.internal_state is not None:
            friction[:] = state.internal_state[0]
        elif not self._friction_first:
            # The first step is taken twice, and only its friction kept of the first time.
            advance(motion.copy(), friction, loads[:1], bounds[:1], *given, record[:0])
        advance(motion, friction, loads, bounds, *given, record)
        position, velocity = np.split(motion[None], 2, axis=1)
        return State(position, velocity, None if self._friction_first else friction[None])
