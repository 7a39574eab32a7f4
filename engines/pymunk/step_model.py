"""The law of Chipmunk's damped springs: positions first, then springs, then sweeps over frictions and dashpots."""

from typing import Any

import numpy as np

from engines.interface.law import Law
from engines.interface.presets import NormalForce, Preset
from engines.shared.kernel_lane import Kernel, KernelLane
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
        inverse_outer, inverse_inner = 1 / chain.outer_mass, 1 / chain.inner_mass
        # The first chain spring hangs on the ground.
        left = np.concatenate([[0.0], inverse_outer[:-1]])
        dashpots = (
            1 - np.exp(-chain.chain_damping * h * (left + inverse_outer)),
            1 - np.exp(-chain.inner_damping * h * (inverse_outer + inverse_inner)),
        )
        self._numbers = (inverse_outer, inverse_inner), h * chain.stiffness_matrix, dashpots, (h, sweeps)

    def _take(self, motion: FloatArray, loads: FloatArray, bounds: FloatArray, record: FloatArray) -> None:
        advance(motion.reshape(2, -1), self.lane.time_step * loads, bounds, *self._numbers, record)

    def _bounds(self, start: int, steps: int) -> FloatArray:
        """Give them as impulses."""
        lane = self.lane
        return np.ascontiguousarray(lane.time_step * lane.chain.friction_coefficient * lane.preloads(start, steps))


@Kernel
def advance(
    motion: Any, loads: Any, bounds: Any, masses: Any, springs: Any, dashpots: Any, numbers: Any, record: Any
) -> None:
    """Advance one lane in place; `record` is (steps, 5n), or has no rows when nothing is kept."""
    h, sweeps = numbers
    position, velocity = motion[0], motion[1]
    cells = masses[0].size
    inverse_mass = np.concatenate(masses)
    for step in range(loads.size):
        position += h * velocity
        impulse = -(springs @ position)
        impulse[0] += loads[step]
        velocity += inverse_mass * impulse
        friction, chain_rate, inner_rate = np.zeros(cells), np.zeros(cells), np.zeros(cells)
        for _ in range(sweeps):
            _rub(velocity, friction, bounds[step], masses)
            _damp_chain(velocity, chain_rate, dashpots[0], masses[0])
            _damp_inner(velocity, inner_rate, dashpots[1], masses)
        if record.shape[0] > 0:
            record[step, : 2 * cells] = position
            record[step, 2 * cells : 4 * cells] = velocity
            record[step, 4 * cells :] = friction / h


@Kernel
def _rub(velocity: Any, friction: Any, bounds: Any, masses: Any) -> None:
    """Bring every cell to rest, as far as the sums of its impulses are within their bounds."""
    outer, inner = masses
    cells = outer.size
    for cell in range(cells):
        slip = velocity[cells + cell] - velocity[cell]
        total = friction[cell] - slip / (outer[cell] + inner[cell])
        total = min(max(total, -bounds[cell]), bounds[cell])
        velocity[cells + cell] += inner[cell] * (total - friction[cell])
        velocity[cell] -= outer[cell] * (total - friction[cell])
        friction[cell] = total


@Kernel
def _damp_chain(velocity: Any, target: Any, parts: Any, outer: Any) -> None:
    """Let the dashpots of the row act, the one to the ground first."""
    for cell in range(outer.size):
        before = velocity[cell - 1] if cell > 0 else 0.0
        inverse = outer[cell] + (outer[cell - 1] if cell > 0 else 0.0)
        rate = velocity[cell] - before
        change = (target[cell] - rate) * parts[cell]
        target[cell] = rate + change
        velocity[cell] += outer[cell] * change / inverse
        if cell > 0:
            velocity[cell - 1] -= outer[cell - 1] * change / inverse


@Kernel
def _damp_inner(velocity: Any, target: Any, parts: Any, masses: Any) -> None:
    """Let the dashpots of the inner masses act."""
    outer, inner = masses
    cells = outer.size
    for cell in range(cells):
        rate = velocity[cells + cell] - velocity[cell]
        change = (target[cell] - rate) * parts[cell]
        target[cell] = rate + change
        inverse = outer[cell] + inner[cell]
        velocity[cells + cell] += inner[cell] * change / inverse
        velocity[cell] -= outer[cell] * change / inverse
