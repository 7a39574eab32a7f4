"""The canonical chain: figure 3 of Sethi, Banerjee and Manna, and the units of chains that are made from ratios."""

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
