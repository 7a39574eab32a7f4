"""The law of SolverSteel's friction anchors, which draw a contact back to where it was taken to stick."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from multibody_xval.engines.interface.law import Constant, Law
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.box_geometry import BOX
from multibody_xval.engines.shared.kernel_lane import Kernel, KernelLane, keep
from multibody_xval.engines.shared.units import power_of_two
from reference_lcp.chain.simulation import Lane

LEAST_SLIP = 1e-5
"""Of a step, over the radius of the smaller body, from which SolverSteel takes it for slip."""

SATURATION = 0.95
"""Of its bound, from which SolverSteel takes friction for that of slip."""

ANCHORED_PERIOD = 7e-5
"""Of U0: positions and velocities are rounded by 2^-24 in each of 400 steps, which makes three standard deviations of
3e-5 for motions of up to eight U0. Where single precision decides whether a contact lets go of its anchor, that moves
it by the least slip of a sphere of four U0, 4e-5."""

LARGEST_MASS = 1e5
"""Of an inner mass [kg]: SolverSteel adds a `cfm` of 1e-6 to one over it, for which twelve iterations make up to
3e-13 here, to 2e-4 at ten times as much."""

SMALLEST_RADIUS = 1e-4
"""Radius [m] of a body below which SolverSteel takes it to be as large."""


def friction_anchors(preset: Preset) -> Law:
    """Give the law of spheres on planes in SI units, with friction that remembers where contacts stick."""
    return Law(
        formula=(
            "q̇ ← q̇ + Δt M⁻¹ (f(t) e_1 − C q̇ − K q + W λ_T), with λ_T by Coulomb's law for the slip w + β e/Δt; "
            "q ← q + Δt q̇; e ← 0 where λ_N = 0, or |λ_T| ≥ s μ λ_N and w opposes it by more than ε R/Δt, with R the "
            "radius of the sphere; else e ← e + Δt w"
        ),
        constants={
            # What is drawn back is small itself; chains in which it is larger are among the tests of the adapter.
            "β": Constant(preset["friction_anchor_beta"], "", "friction_anchor_beta", visible_error=10.0),
            "s": Constant(SATURATION, "", "where SolverSteel takes friction for that of slip", visible_error=0.1),
            "ε": Constant(LEAST_SLIP, "", "where SolverSteel takes a motion for slip", visible_error=1.0),
        },
        model=_model,
        period_bound=ANCHORED_PERIOD,
        bound_reason="single precision: it may decide whether a contact lets go of its anchor",
        modulated=True,
        unmodelled_reason=_softened,
    )


def _softened(lane: Lane) -> str | None:
    """Say where the solver ends before contacts are hard."""
    heaviest = float(np.max(lane.chain.inner_mass))
    if heaviest <= LARGEST_MASS:
        return None
    return f"contacts of {heaviest:g} kg sink in; allowed: at most {LARGEST_MASS:g} kg"


def _model(lane: Lane, constants: Mapping[str, float]) -> KernelLane:
    radius = max(SMALLEST_RADIUS, BOX * power_of_two(lane.drive.displacement_scale(lane.chain)))
    least = constants["ε"] * radius / lane.time_step
    return KernelLane(lane, advance, (lane.time_step, constants["β"], constants["s"], least))


@Kernel
def advance(motion: Any, loads: Any, bounds: Any, force_matrix: Any, masses: Any, numbers: Any, record: Any) -> None:
    """Advance one lane in place, see `KernelLane`, whose contacts have not slipped at first.

    `numbers` are the time step, the part of a displacement that is taken back
    in a step, the part of its bound and the slip velocity from which friction lets go of its anchor.
    """
    h, gain, saturation, slipping = numbers
    cells = bounds.shape[1]
    count = 2 * cells
    position, velocity = motion[:count], motion[count:]
    force, displacement, friction = np.empty(count), np.zeros(cells), np.zeros(cells)
    for step in range(loads.size):
        np.dot(force_matrix, motion, force)
        force[0] += loads[step]
        for i in range(count):
            velocity[i] += h * force[i] / masses[i]
        for cell in range(cells):
            outer, inner, bound = masses[cell], masses[cells + cell], bounds[step, cell]
            slip = velocity[cells + cell] - velocity[cell]
            stopping = -(slip + gain * displacement[cell] / h) / (h * (1 / outer + 1 / inner))
            friction[cell] = min(max(stopping, -bound), bound)
            velocity[cell] -= h * friction[cell] / outer
            velocity[cells + cell] += h * friction[cell] / inner
            slip = velocity[cells + cell] - velocity[cell]
            slips = abs(friction[cell]) >= saturation * bound and slip * friction[cell] < -bound * slipping
            displacement[cell] = 0.0 if slips or bound <= 0 else displacement[cell] + h * slip
        for i in range(count):
            position[i] += h * velocity[i]
        if record.shape[0] > 0:
            keep(record[step], position, velocity, friction, 1.0)
