"""The law of joints in PhysX's temporal Gauss–Seidel solver: substeps under constant forces, and soft links."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from engines.interface.law import Constant, Law
from engines.interface.presets import Preset
from engines.shared.kernel_lane import Kernel, KernelLane, keep
from reference_lcp.chain.simulation import Lane

SINGLE_PRECISION_PERIOD = 2e-4
"""Of U0: the 32 substeps of a step add the same small change to velocities, of some U0 ω, and round it alike, by up to
32 × 2^-24; those of 400 steps add up as the root of their number: three standard deviations for motions of up to three
U0. What one substep makes is 2^-5 of it, and is measured so (`tests/engines/adapters/test_ovphysx.py`)."""


def temporal_substeps(preset: Preset) -> Law:
    """Give the law of joint friction in substeps, with the forces of a step at its start."""
    substeps, corrections = preset["solverPositionIterationCount"], preset["solverVelocityIterationCount"]

    def model(lane: Lane, constants: Mapping[str, float]) -> KernelLane:
        inverse = 1 / lane.chain.outer_mass, 1 / lane.chain.inner_mass
        stopping = 1 / (inverse[0] + inverse[1] + constants["c"] * np.maximum(*inverse))
        return KernelLane(lane, advance, (stopping, lane.time_step, substeps, corrections))

    return Law(
        formula=(
            f"with h = Δt/{substeps}, F = f(t) e_1 − C q̇ − K q of the start of the step and "
            f"g(w) = −w / (1/m_o + 1/m_i + c max(1/m_o, 1/m_i)) of the slip velocity w: {substeps} times "
            "q̇ ← q̇ + M⁻¹ (h F + W p) with p = clip(g, ± h μ λ_N) of what F alone makes of w, and q ← q + h q̇; "
            f"then {corrections} times P ← clip(P + g(w), ± Δt μ λ_N) for their sum P, which moves q̇ alone"
        ),
        constants={"c": Constant(preset["cfmScale"], "", "cfmScale of links", too_small_to_see=True)},
        model=model,
        period_bound=SINGLE_PRECISION_PERIOD,
        bound_growth=0.5,
        bound_reason="single precision: every substep rounds by 2^-24, all of a step alike",
        modulated=True,
    )


@Kernel
def advance(motion: Any, loads: Any, bounds: Any, force_matrix: Any, masses: Any, numbers: Any, record: Any) -> None:
    """Advance one lane in place, see `KernelLane`.

    `numbers` are impulses over the slip velocity that they are to stop, shape (n,), the time step, how many substeps
    make one, and how often velocities are corrected after them.
    """
    stopping, step_length, substeps, corrections = numbers
    h, cells = step_length / substeps, bounds.shape[1]
    count = 2 * cells
    position, velocity = motion[:count], motion[count:]
    force, impulse, total = np.empty(count), np.empty(cells), np.empty(cells)
    for step in range(loads.size):
        np.dot(force_matrix, motion, force)
        force[0] += loads[step]
        total[:] = 0.0
        for _ in range(substeps):
            for i in range(count):
                velocity[i] += h * force[i] / masses[i]
            impulse[:] = 0.0
            _rub(velocity, impulse, h, bounds[step], masses, stopping)
            for cell in range(cells):
                total[cell] += impulse[cell]
            for i in range(count):
                position[i] += h * velocity[i]
        for _ in range(corrections):
            _rub(velocity, total, step_length, bounds[step], masses, stopping)
        if record.shape[0] > 0:
            keep(record[step], position, velocity, total, step_length)


@Kernel
def _rub(velocity: Any, impulse: Any, length: Any, bounds: Any, masses: Any, stopping: Any) -> None:
    """Bring the impulse of every cell nearer to that which stops it, within its bound over this length of time."""
    cells = impulse.size
    for cell in range(cells):
        wanted = impulse[cell] - stopping[cell] * (velocity[cells + cell] - velocity[cell])
        bound = length * bounds[cell]
        given = min(max(wanted, -bound), bound)
        velocity[cell] -= (given - impulse[cell]) / masses[cell]
        velocity[cells + cell] += (given - impulse[cell]) / masses[cells + cell]
        impulse[cell] = given
