"""Numbers that hold unless others are given: the canonical chain, steps of a period, and when a search ends."""

import math

CELLS = 7
"""Number of cells n."""

MASS_RATIO = 1.0
"""m_i / m_o."""

STIFFNESS_RATIO = 1.0
"""k_i / k_c."""

DAMPING_RATIO = 0.01
"""ζ = c_c / (2 √(k_c m_o)) of the dashpots between the cells."""

BASE_AMPLITUDE = 0.01
"""U0 [m] of the base, which friction ratios μ λ_N / (k_c U0) refer to."""

OUTER_MASS = 1.0
"""m_o [kg]."""

CHAIN_STIFFNESS = 1000.0
"""k_c [N/m]."""

FRICTION_COEFFICIENT = 0.5
"""μ; only the product μ λ_N enters the motion."""


MINIMUM_STEPS_PER_PERIOD = 400
"""Coarsest sampling of a period: there the Euler scheme's error is below 0.01 dB on most of figure 3."""

LARGEST_PHASE_STEP = 0.4
"""Largest dt ω_max: a fifth of the stability limit 2 of the symplectic Euler scheme."""

FEWEST_STEPS_PER_PERIOD = math.ceil(2 * math.pi / LARGEST_PHASE_STEP)
"""Fewest steps a period that are allowed, 16: with fewer the drive itself breaks dt ω <= 0.4, whatever the chain.

Four a phase, too, of the cycle stick, forward slip, stick, backward slip.
"""


STICK_SLIP_POINTS = ((0.1, 0.6), (0.3, 0.6), (0.3, 0.9), (0.6, 0.9), (0.6, 1.3), (1.0, 0.9))
"""Friction and frequency ratios at which contacts of the canonical chain stick and slip."""


DEFAULT_RESIDUAL = 1e-8
"""Periodicity residual at which an orbit counts as found."""

DEFAULT_PERIODS = 400
"""Periods after which the search gives up."""

EXACT_RESIDUAL = 1e-11
"""Periodicity residual of an exact steady state, some hundred times what the event-driven period map can resolve."""

PROVEN_DIGITS = 20
"""Decimals of a proven transmittance [dB]."""

PROOF_TIME_LIMIT = 60.0
"""Seconds after which a proof is given up."""
