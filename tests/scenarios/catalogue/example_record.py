"""The formula of the record that ships with the suite."""

import numpy as np

from reference_lcp.validation import FloatArray

SPACING, SAMPLES, PEAK = 0.02, 600, 0.01
"""Time between samples [s], their number, and the largest displacement [m]."""

GROUND_FREQUENCY, GROUND_DAMPING = 2 * np.pi * 4.0, 0.6
"""ω_g [rad/s] and ζ_g of the ground, a firm soil in Kanai's and Tajimi's model."""

PHASE_SEED = 20


def example_samples() -> tuple[FloatArray, FloatArray]:
    """Times [s] and displacements [m] of the example, shape (600,), rounded as in the file.

    Noise of evenly drawn phases with the spectrum of Kanai and Tajimi, (1 + 4 ζ_g² r²) / ((1 − r²)² + 4 ζ_g² r²)
    with r = ω / ω_g (H. Tajimi, Proc. 2nd World Conf. Earthquake Eng., 1960), here of the displacement, between
    2 and 12 Hz, under the envelope (t/2 s) exp(1 − t/2 s) (1 − (t/T)⁴)², which begins and ends at rest. Slower
    shaking would set the whole chain swinging, for much longer than the record lasts.
    """
    time = SPACING * np.arange(SAMPLES)
    omega = 2 * np.pi * np.arange(2.0, 12.0, 0.05)
    r = omega / GROUND_FREQUENCY
    ground = (2 * GROUND_DAMPING * r) ** 2
    amplitude = np.sqrt((1 + ground) / ((1 - r**2) ** 2 + ground))
    phase = 2 * np.pi * np.random.Generator(np.random.PCG64(PHASE_SEED)).random(omega.size)
    envelope = time / 2 * np.exp(1 - time / 2) * (1 - (time / time[-1]) ** 4) ** 2
    shaking = envelope * (np.sin(np.outer(time, omega) + phase) @ amplitude)
    return np.round(time, 2), np.round(PEAK * shaking / np.max(np.abs(shaking)), 8)
