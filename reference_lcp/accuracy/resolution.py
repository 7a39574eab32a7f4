"""What residual and round-off leave open of a transmittance, whatever the time step."""

import math

ROUND_OFF = 1e-12
"""Round-off of positions over the displacement scale after forty periods of 400 steps, in double precision.

Motions do not drift apart, so that it grows as the root of the number of steps only. Engines that share the scheme
agree to it.
"""

ROUND_OFF_STEPS = 40 * 400
"""Steps for which a round-off is stated."""


def unresolved_amplitude(
    residual: float, amplification: float, steps: int, transmittance_db: float, round_off: float = ROUND_OFF
) -> float:
    """How far, over the displacement scale, an amplitude may be from that of the steady state of its own scheme.

    A motion that repeats to its residual is up to `amplification` times that from its steady state. Round-off adds up:
    in proportion to the motion, at least as large as the base's, and to the root of the number of steps.

    Parameters
    ----------
    residual
        Periodicity residual, see `PeriodicOrbit.residual`.
    amplification
        See `residual_amplification`.
    steps
        Steps that were simulated to find the steady state.
    transmittance_db
        Transmittance in whose motion round-off is made [dB].
    round_off
        Of `ROUND_OFF_STEPS` steps, over the displacement scale.
    """
    motion = max(1.0, 10 ** (transmittance_db / 20))
    return residual * amplification + round_off * math.sqrt(steps / ROUND_OFF_STEPS) * motion


def amplitude_in_db(amplitude: float, transmittance_db: float) -> float:
    """What a change of the amplitude, over the displacement scale, makes of a transmittance [dB].

    A negative change that leaves nothing of the amplitude gives −inf.
    """
    change = amplitude * 10 ** (-transmittance_db / 20)
    return -math.inf if change <= -1 else 20 * math.log10(1 + change)
