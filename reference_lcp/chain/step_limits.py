"""How many steps a period of the drive takes."""

import math

MINIMUM_STEPS_PER_PERIOD = 400
"""Coarsest sampling of a period: there the Euler scheme's error is below 0.01 dB on most of figure 3."""

LARGEST_PHASE_STEP = 0.4
"""Largest dt ω_max: a fifth of the stability limit 2 of the symplectic Euler scheme."""

FEWEST_STEPS_PER_PERIOD = math.ceil(2 * math.pi / LARGEST_PHASE_STEP)
"""Fewest steps a period that are allowed, 16: with fewer the drive itself breaks dt ω <= 0.4, whatever the chain.

Four a phase, too, of the cycle stick, forward slip, stick, backward slip.
"""
