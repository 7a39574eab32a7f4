"""Transmittance: the amplitude of a steady state over the base's."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.simulation import PeriodicOrbit
from reference_lcp.validation import FloatArray


def fundamental(signal: FloatArray) -> NDArray[np.complex128]:
    """Complex amplitude A exp(iφ), shape (...), of A sin(ωt + φ) over one period at ends of N steps, shape (N, ...)."""
    rows = signal.reshape(signal.shape[0], -1)
    return (_weights(signal.shape[0]) @ rows).reshape(signal.shape[1:])


@lru_cache(maxsize=8)
def _weights(steps: int) -> NDArray[np.complex128]:
    """2i exp(−iωt) / N at the ends of N steps."""
    phase = 2 * np.pi * np.arange(1, steps + 1) / steps
    weights: NDArray[np.complex128] = 2j * np.exp(-1j * phase) / steps
    weights.flags.writeable = False
    return weights


def complex_transmittance(orbit: PeriodicOrbit) -> complex:
    """Complex amplitude of the fundamental harmonic of the last outer mass over the displacement scale."""
    scale = orbit.lane.drive.displacement_scale(orbit.lane.chain)
    return complex(fundamental(orbit.trajectory.outer_positions[:, -1]) / scale)


def transmittance(orbit: PeriodicOrbit) -> float:
    """Amplitude of the fundamental harmonic of the last outer mass over the displacement scale."""
    return abs(complex_transmittance(orbit))


def decibel(ratio: float | FloatArray) -> float:
    """20 log10 of an amplitude ratio; −inf for zero."""
    with np.errstate(divide="ignore"):
        return float(20 * np.log10(ratio))
