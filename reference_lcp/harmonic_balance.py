"""Harmonic balance with one harmonic: about how a chain with Coulomb friction answers a periodic drive.

A contact whose masses move past each other by Δ sin ωt dissipates 4 F Δ a cycle, as a dashpot 4 F / (π ω Δ) would
(Jacobsen 1930; Den Hartog 1931). The chain with such dashpots is linear; they depend on Δ, which is found by
iteration. A contact that sticks is one whose dashpot grows without end. Higher harmonics are left out: what is found
is where a search for the steady state begins, and nothing else depends on it.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reference_lcp.simulation import Lane
from reference_lcp.trajectory import State
from reference_lcp.validation import FloatArray

ITERATIONS = 12
"""Of the equivalent dashpots; more of them save no period in a hundred of the search on figure 3."""

LEAST_SLIP = 1e-6
"""Δ, in displacement scales of the drive, below which a dashpot grows no more."""

LOSS_FACTOR = 1e-3
"""Hysteretic damping of all springs: a resonance without friction or dashpots stays finite."""

SAMPLES = 64
"""Times in a period at which the drive's load is taken, for its first harmonic."""


def harmonic_balance_start(lanes: Sequence[Lane], steps_per_period: int) -> State:
    """Approximate the steady states of lanes at phase zero of their drives.

    Parameters
    ----------
    lanes
        Chains of one length, under periodic drives; of a preload, its mean counts.
    steps_per_period
        Steps of one period of each drive.

    Returns
    -------
    State
        Im x and ω Re x of the complex amplitudes x of all masses.
    """
    omega = np.array([2 * np.pi / (lane.time_step * steps_per_period) for lane in lanes])
    load = np.array([_first_harmonic(lane, steps_per_period) for lane in lanes])
    amplitudes = _balanced(lanes, omega, load)
    return State(amplitudes.imag.copy(), omega[:, None] * amplitudes.real)


def _first_harmonic(lane: Lane, steps_per_period: int) -> complex:
    """Complex amplitude P [N] of the load Im(P exp(iωt)) on the outer mass of cell 1."""
    phases = np.arange(SAMPLES) / SAMPLES
    load = lane.drive.load(lane.chain, phases * lane.time_step * steps_per_period)
    return complex(2j * np.mean(load * np.exp(-2j * np.pi * phases)))


def _balanced(lanes: Sequence[Lane], omega: FloatArray, load: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Complex amplitudes [m] of all masses, shape (lanes, 2n).

    With the receptances R of the chain without friction, the forces f = −z Δ of the dashpots z = iω c on the inner
    masses leave Δ = Δ_0 + R_Δ f between the masses of the cells: n equations instead of 2n.
    """
    n = lanes[0].chain.cells
    friction = np.array([lane.chain.friction_bound for lane in lanes])
    scale = np.array([lane.drive.displacement_scale(lane.chain) for lane in lanes])[:, None]
    across = np.vstack([-np.eye(n), np.eye(n)])
    unit = np.hstack([np.eye(2 * n, 1), across])
    receptances = np.linalg.solve(np.array([_dynamic_stiffness(*one) for one in zip(lanes, omega, strict=True)]), unit)
    free, by_contacts = receptances[:, :, 0] * load[:, None], receptances[:, :, 1:]
    free_slip, slip_by_contacts = (free[:, n:] - free[:, :n])[:, :, None], across.T @ by_contacts
    amplitude, forces = np.repeat(scale, n, axis=1), np.zeros((len(lanes), n), dtype=complex)
    for _ in range(ITERATIONS):
        dashpots = 4j * friction / (np.pi * np.maximum(amplitude, LEAST_SLIP * scale))
        slip = np.linalg.solve(np.eye(n) + slip_by_contacts * dashpots[:, None, :], free_slip)[:, :, 0]
        amplitude, forces = np.abs(slip), -dashpots * slip
    balanced: NDArray[np.complex128] = free + (by_contacts @ forces[:, :, None])[:, :, 0]
    return balanced


def _dynamic_stiffness(lane: Lane, omega: float) -> NDArray[np.complex128]:
    """K (1 + iη) + iωC − ω²M, shape (2n, 2n)."""
    chain = lane.chain
    stiffness = (1 + 1j * LOSS_FACTOR) * chain.stiffness_matrix
    dynamic = stiffness + 1j * omega * chain.damping_matrix - omega**2 * chain.mass_matrix
    return np.asarray(dynamic, dtype=np.complex128)
