"""The law of Chipmunk's damped springs: positions first, then springs, then sweeps over frictions and dashpots."""

from typing import Any

import numpy as np

from multibody_xval.engines.interface.law import Law
from multibody_xval.engines.interface.presets import NormalForce, Preset
from multibody_xval.engines.shared.kernel_lane import Kernel, KernelLane, keep
from reference_lcp.chain.simulation import Lane
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
        model=lambda lane, _: DampedSpringsLane(lane, sweeps),
        modulated=preset.represents(NormalForce.MODULATED),
    )


class DampedSpringsLane(KernelLane):
    """One chain of damped springs, with so many sweeps a step."""

    def __init__(self, lane: Lane, sweeps: int):
        super().__init__(lane)
        chain, h = lane.chain, lane.time_step
        inverse_mass = 1 / self._masses
        # The first chain spring hangs on the ground.
        left = np.concatenate([[0.0], inverse_mass[: chain.cells - 1], inverse_mass[: chain.cells]])
        damping = np.concatenate([chain.chain_damping, chain.inner_damping])
        dashpots = 1 - np.exp(-damping * h * (left + inverse_mass))
        self._numbers = inverse_mass, h * chain.stiffness_matrix, dashpots, (h, sweeps)

    def _take(self, motion: FloatArray, loads: FloatArray, bounds: FloatArray, record: FloatArray) -> None:
        advance(motion.reshape(2, -1), self.lane.time_step * loads, bounds, *self._numbers, record)

    def _bounds(self, start: int, steps: int) -> FloatArray:
        """Give them as impulses."""
        lane = self.lane
        return np.ascontiguousarray(lane.time_step * lane.chain.friction_coefficient * lane.preloads(start, steps))


@Kernel
def advance(
    motion: Any, loads: Any, bounds: Any, inverse_mass: Any, springs: Any, dashpots: Any, numbers: Any, record: Any
) -> None:
    """Advance one lane in place; `record` is (steps, 5n), or has no rows when nothing is kept."""
    h, sweeps = numbers
    position, velocity = motion[0], motion[1]
    cells = bounds.shape[1]
    force, friction, rates = np.empty(2 * cells), np.empty(cells), np.empty(2 * cells)
    for step in range(loads.size):
        for i in range(2 * cells):
            position[i] += h * velocity[i]
        np.dot(springs, position, force)
        force[0] -= loads[step]
        for i in range(2 * cells):
            velocity[i] -= inverse_mass[i] * force[i]
        friction[:], rates[:] = 0.0, 0.0
        for _ in range(sweeps):
            _rub(velocity, friction, bounds[step], inverse_mass)
            _damp(velocity, rates, dashpots, inverse_mass)
        if record.shape[0] > 0:
            keep(record[step], position, velocity, friction, h)


@Kernel
def _rub(velocity: Any, friction: Any, bounds: Any, inverse_mass: Any) -> None:
    """Bring every cell to rest, as far as the sums of its impulses are within their bounds."""
    cells = friction.size
    for cell in range(cells):
        outer, inner = inverse_mass[cell], inverse_mass[cells + cell]
        slip = velocity[cells + cell] - velocity[cell]
        total = friction[cell] - slip / (outer + inner)
        total = min(max(total, -bounds[cell]), bounds[cell])
        velocity[cells + cell] += inner * (total - friction[cell])
        velocity[cell] -= outer * (total - friction[cell])
        friction[cell] = total


@Kernel
def _damp(velocity: Any, target: Any, parts: Any, inverse_mass: Any) -> None:
    """Let the dashpots of the row act, the one to the ground first, then those of the inner masses."""
    cells = velocity.size // 2
    for right in range(velocity.size):
        left = right - 1 if right < cells else right - cells
        hangs = left < 0
        rate = velocity[right] - (0.0 if hangs else velocity[left])
        change = (target[right] - rate) * parts[right]
        target[right] = rate + change
        inverse = inverse_mass[right] + (0.0 if hangs else inverse_mass[left])
        velocity[right] += inverse_mass[right] * change / inverse
        if not hangs:
            velocity[left] -= inverse_mass[left] * change / inverse
