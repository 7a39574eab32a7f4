"""The law of Rapier's substeps: forces of the start of a step, and friction solved anew in every part of it."""

import functools
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from multibody_xval.engines.interface.law import Constant, Law
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.kernel_lane import Kernel, KernelLane, keep
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
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
        formula=f"{count} times, with h = Δt/{count} and F = f(t) e_1 − C q̇ − K q of the start of the step: {formula}",
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


class _SubsteppedLane(KernelLane):
    """One chain under forces that are constant over the substeps of a step."""

    def __init__(self, lane: Lane, constants: Mapping[str, float], substeps: int, *, friction_first: bool):
        super().__init__(lane)
        self._substeps, self._friction_first = substeps, friction_first
        self._slowness, self._yielding = constants.get("1/v_max", 0.0), constants.get("1/c", 0.0)

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        """Run the kernel; gives the end, whose internal state is the friction by which positions move next."""
        lane, chain = self.lane, self.lane.chain
        motion = np.concatenate([state.positions[0], state.velocities[0]])
        friction, loads, bounds = np.zeros(chain.cells), lane.loads(start, steps), self._bounds(start, steps)
        length = lane.time_step / self._substeps
        numbers = length, self._substeps, self._friction_first, self._slowness, self._yielding
        given = self._force, self._masses, numbers
        if state.internal_state is not None:
            friction[:] = state.internal_state[0]
        elif not self._friction_first:
            # The first step is taken twice, and only its friction kept of the first time.
            advance(motion.copy(), friction, loads[:1], bounds[:1], *given, record[:0])
        advance(motion, friction, loads, bounds, *given, record)
        position, velocity = np.split(motion[None], 2, axis=1)
        return State(position, velocity, None if self._friction_first else friction[None])


@Kernel
def advance(
    motion: Any, friction: Any, loads: Any, bounds: Any, force_matrix: Any, masses: Any, numbers: Any, record: Any
) -> None:
    """Advance one lane in place; `record` is (steps, 5n), or has no rows when nothing is kept.

    `friction`, shape (n,), is the force of the substep before, then of the last one; `bounds`, shape (steps, n), are
    forces; `numbers` are the length of a substep, how many make a step, whether friction is found before positions
    move; one over the largest velocity that is then left, and over the damping of motors.
    """
    h, substeps, friction_first, slowness, yielding = numbers
    cells = bounds.shape[1]
    count = 2 * cells
    position, velocity = motion[:count], motion[count:]
    force, total = np.empty(count), np.empty(cells)
    for step in range(loads.size):
        np.dot(force_matrix, motion, force)
        force[0] += loads[step]
        total[:] = 0.0
        for _ in range(substeps):
            for i in range(count):
                velocity[i] += h * force[i] / masses[i]
            if friction_first:
                _rub(velocity, friction, bounds[step], masses, h, yielding)
                for i in range(count):  # Velocities are cut off before positions move by them.
                    velocity[i] /= max(1.0, slowness * abs(velocity[i]))
            for i in range(count):
                position[i] += h * velocity[i]
            if not friction_first:
                _push(position, h * h, friction, masses)
                _rub(velocity, friction, bounds[step], masses, h, yielding)
            for cell in range(cells):
                total[cell] += friction[cell]
        if record.shape[0] > 0:
            if friction_first:
                keep(record[step], position, velocity, friction, 1.0)
            else:
                keep(record[step], position, velocity, total, substeps)


@Kernel
def _rub(velocity: Any, friction: Any, bounds: Any, masses: Any, h: Any, yielding: Any) -> None:
    """Find the forces that bring every cell to rest, within their bounds, and let them act."""
    cells = friction.size
    for cell in range(cells):
        slip = velocity[cells + cell] - velocity[cell]
        stopping = -slip / (h * (1 / masses[cell] + 1 / masses[cells + cell]) + yielding)
        friction[cell] = min(max(stopping, -bounds[cell]), bounds[cell])
    _push(velocity, h, friction, masses)


@Kernel
def _push(moved: Any, factor: Any, friction: Any, masses: Any) -> None:
    """Add what a factor times friction on the inner masses, and back on the outer ones, makes."""
    cells = friction.size
    for cell in range(cells):
        moved[cell] -= factor * friction[cell] / masses[cell]
        moved[cells + cell] += factor * friction[cell] / masses[cells + cell]
