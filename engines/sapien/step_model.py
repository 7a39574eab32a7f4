"""The laws of SAPIEN's presets: damped links, and the substeps of the temporal Gauss–Seidel solver."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from multibody_xval.engines.interface.law import Constant, Law
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.kernel_lane import Kernel, KernelLane, keep
from reference_lcp.chain.simulation import Lane
from reference_lcp.schemes.linear_implicit import LinearImplicitLane, LinearStep

SINGLE_PRECISION_PERIOD = 4e-5
"""Of U0: positions and velocities, of some U0 and U0 ω, are rounded by 2^-24 in each of 4,000 substeps. Roundings add
up as the root of their number: three standard deviations for motions of up to three U0."""

DRAWN_BACK_PERIOD = 6e-4
"""Of U0: a contact that sticks at the edge of its bound is drawn back to where it began to, and what draws it is as
uncertain as positions are, by 2^-24 of them over a substep: that alone may decide whether it slips in a step. It then
gains or lacks 7e-6 U0 a step of velocity, which carries it on for up to 400 / 2π steps, more at a resonance.
"""

PRECISION = "single precision: every substep rounds by 2^-24"


def damped_links(preset: Preset) -> Law:
    """Give the law of an articulation, whose links are slowed down; its drives are exact."""
    damping = preset["linear damping"]
    return Law(
        formula="equation (5) with the force −k m v of the start of the step on every mass",
        constants={"k": Constant(damping, "1/s", "linear damping of links", ideal=0.0, too_small_to_see=not damping)},
        model=_damped_links,
        period_bound=SINGLE_PRECISION_PERIOD,
        bound_growth=0.5,
        bound_reason=PRECISION,
        modulated=True,
    )


def _damped_links(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    chain, h = lane.chain, lane.time_step
    mass = chain.mass_matrix
    step = LinearStep.of(chain, h, mass, (1 - h * constants["k"]) * mass - h * chain.damping_matrix, (1.0, 0.0))
    return LinearImplicitLane(lane, step)


def temporal_gauss_seidel(preset: Preset) -> Law:
    """Give the law of the temporal Gauss–Seidel solver, with the forces of a step at its start."""
    substeps, corrections = preset["solver_position_iterations"], preset["solver_velocity_iterations"]
    # PhysX's own: 0.8, or less where there are many substeps.
    relaxation = min(0.8, 2 / math.sqrt(substeps))

    def model(lane: Lane, constants: Mapping[str, float]) -> KernelLane:
        return KernelLane(lane, advance, (lane.time_step, substeps, corrections, constants["c"]))

    return Law(
        formula=(
            "q̇ ← q̇ + Δt M⁻¹ (f(t) e_1 − C q̇ − K q); then with e the slip since a contact began to stick, and "
            f"h = Δt/{substeps}, {substeps} times p ← clip(p − c m (w + c e / h), ± Δt μ λ_N), q ← q + h q̇, "
            f"and {corrections} times p alone; e ← 0 where p was cut off at last"
        ),
        constants={"c": Constant(relaxation, "", "relaxation: PhysX takes min(0.8, 2/√n)", visible_error=1.0)},
        model=model,
        period_bound=DRAWN_BACK_PERIOD,
        bound_reason="single precision: at the edge of its bound it decides whether a contact slips in a step",
        modulated=True,
    )


@Kernel
def advance(motion: Any, loads: Any, bounds: Any, force_matrix: Any, masses: Any, numbers: Any, record: Any) -> None:
    """Advance one lane in place, see `KernelLane`, whose contacts never stuck before.

    `numbers` are the time step, how many substeps make one, how often velocities are corrected after them, and the
    relaxation.
    """
    h, substeps, corrections, relaxation = numbers
    cells = bounds.shape[1]
    count = 2 * cells
    position, velocity = motion[:count], motion[count:]
    drift, slipped, impulse = np.zeros(cells), np.empty(cells), np.zeros(cells)
    force, moved, stuck = np.empty(count), np.zeros(count), np.ones(cells, dtype=np.bool_)
    for step in range(loads.size):
        np.dot(force_matrix, motion, force)
        force[0] += loads[step]
        for i in range(count):
            velocity[i] += h * force[i] / masses[i]
        impulse[:], moved[:] = 0.0, 0.0
        for sweep in range(substeps + corrections):
            for cell in range(cells):
                slipped[cell] = (drift[cell] + moved[cells + cell] - moved[cell]) * substeps / h
            _rub(velocity, impulse, stuck, h, bounds[step], slipped, masses, relaxation)
            for i in range(count if sweep < substeps else 0):
                moved[i] += velocity[i] * (h / substeps)
        for i in range(count):
            position[i] += moved[i]
        for cell in range(cells):
            drift[cell] = drift[cell] + moved[cells + cell] - moved[cell] if stuck[cell] else 0.0
        if record.shape[0] > 0:
            keep(record[step], position, velocity, impulse, h)


@Kernel
def _rub(
    velocity: Any, impulse: Any, stuck: Any, h: Any, bounds: Any, drawing_back: Any, masses: Any, relaxation: Any
) -> None:
    """Bring the impulse of every cell nearer to that which stops it and draws it back, within its bound."""
    cells = impulse.size
    for cell in range(cells):
        outer, inner = masses[cell], masses[cells + cell]
        slip = velocity[cells + cell] - velocity[cell] + relaxation * drawing_back[cell]
        wanted = impulse[cell] - relaxation * slip / (1 / outer + 1 / inner)
        bound = h * bounds[cell]
        given = min(max(wanted, -bound), bound)
        stuck[cell] = given == wanted
        velocity[cell] -= (given - impulse[cell]) / outer
        velocity[cells + cell] += (given - impulse[cell]) / inner
        impulse[cell] = given
