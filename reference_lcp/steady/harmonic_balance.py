"""Harmonic balance with one harmonic: the approximate response of a chain with Coulomb friction to a periodic drive.

A contact whose masses move past each other by Δ sin ωt dissipates 4 F Δ a cycle, as a dashpot 4 F / (π ω Δ) would
(Jacobsen 1930; Den Hartog 1931). The chain with such dashpots is linear; Δ is found by iteration. Its response is that
of the scheme of equation (5) in steps of time: a chain without friction is in its steady state. What is found is where
a search for the steady state begins, and nothing else depends on it.
"""

from collections.abc import Sequence
from typing import Any

import numba
import numpy as np

from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State

ITERATIONS = 12
"""Of the equivalent dashpots."""

LEAST_SLIP = 1e-6
"""Δ, in displacement scales of the drive, below which a dashpot grows no more."""

LOSS_FACTOR = 1e-3
"""Hysteretic damping of all springs where a cell has no dashpot: a resonance stays finite."""

LOAD_SAMPLES = 64
"""Times in a period at which the drive's load is taken, for its first harmonic."""

LOAD_PHASES = np.arange(LOAD_SAMPLES) / LOAD_SAMPLES
FIRST_HARMONIC = 2j * np.exp(-2j * np.pi * LOAD_PHASES) / LOAD_SAMPLES
"""Weights of the complex amplitude P of a load Im(P exp(iωt))."""


def harmonic_balance_start(lanes: Sequence[Lane], steps_per_period: int) -> State:
    """Approximate the steady states of lanes at phase zero of their drives, of preloads by their mean; bodies rest."""
    first: Any = lanes[0].chain
    if not isinstance(first, Chain):
        rest = np.zeros((len(lanes), first.freedoms))
        return State(rest, rest)
    rates = np.array([_rate(lane, steps_per_period) for lane in lanes])
    amplitudes = np.array([_amplitudes(*own, steps_per_period) for own in zip(lanes, rates.tolist(), strict=True)])
    return State(amplitudes.imag.copy(), (rates[:, None] * amplitudes).imag.copy())


def _rate(lane: Lane, steps_per_period: int) -> complex:
    """Complex amplitude of a velocity over that of its position [1/s]: iω, as the difference over a step."""
    return complex(1 - np.exp(-2j * np.pi / steps_per_period)) / lane.time_step


def _amplitudes(lane: Lane, rate: complex, steps_per_period: int) -> Any:
    """Complex amplitudes [m] of all masses of a lane, shape (2n,), outer masses first.

    As in a step of the scheme: forces of its start and friction of its end change velocities, which move positions.
    """
    chain, least = lane.chain, LEAST_SLIP * lane.drive.displacement_scale(lane.chain)
    loss = 1 + 1j * (0.0 if chain.damped else LOSS_FACTOR)
    springs = loss * chain.chain_stiffness + rate * chain.chain_damping
    inner = loss * chain.inner_stiffness + rate * chain.inner_damping
    inertia = abs(rate) ** 2 * np.array([chain.outer_mass, chain.inner_mass])
    friction = 4j / np.pi * np.exp(1j * np.pi / steps_per_period) * chain.friction_bound
    load = complex(FIRST_HARMONIC @ lane.drive.load(chain, LOAD_PHASES * (lane.time_step * steps_per_period)))
    return _balanced(springs, inner, inertia, friction, load, least)


@numba.njit(cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _solve_tridiagonal(diagonal: Any, springs: Any, load: Any, x: Any) -> None:
    """Solve for x, without pivots, in place of `diagonal` too: a chain of `springs`, the load on its first mass."""
    n = diagonal.shape[0]
    x[0] = load
    for i in range(1, n):
        factor = springs[i] / diagonal[i - 1]
        diagonal[i] -= factor * springs[i]
        x[i] = factor * x[i - 1]
    for i in range(n - 1, -1, -1):
        rest = x[i]
        if i + 1 < n:
            rest += springs[i + 1] * x[i + 1]
        x[i] = rest / diagonal[i]


@numba.njit(cache=True, error_model="numpy")
def _balanced(springs: Any, inner: Any, inertia: Any, friction: Any, load: Any, least: float) -> Any:
    """Amplitudes of a chain whose contacts are dashpots, after `ITERATIONS` of these."""
    n = springs.shape[0]
    slip_of, diagonal, amplitudes = np.empty_like(springs), np.empty_like(springs), np.empty(2 * n, springs.dtype)
    outer, slip = amplitudes[:n], amplitudes[n:]
    slip[:] = load / springs[0]
    for _ in range(ITERATIONS):
        for i in range(n):
            coupling = inner[i] + friction[i] / max(abs(slip[i]), least)
            slip_of[i] = inertia[1, i] / (coupling - inertia[1, i])
            diagonal[i] = springs[i] - inertia[0, i] - coupling * slip_of[i]
            if i + 1 < n:
                diagonal[i] += springs[i + 1]
        _solve_tridiagonal(diagonal, springs, load, outer)
        for i in range(n):
            slip[i] = slip_of[i] * outer[i]
    for i in range(n):
        slip[i] += outer[i]
    return amplitudes
