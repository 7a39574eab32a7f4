"""The linear limits against Bloch's theorem for the infinite chain; `test_poles_and_zeros` has the finite one."""

import numpy as np
import pytest
from scipy.optimize import brentq

from reference_lcp import Chain, HarmonicBase, HarmonicForce, frictionless_transmittance
from reference_lcp.chain.linear_response import frictionless_response

UNDAMPED = {"damping_ratio": 0.0}


def wave_number(chain, omega):
    """Complex Bloch wave number κ: cos κ = 1 − ω² m_eff / (2 k_c)."""
    outer, inner, stiffness = chain.outer_mass[0], chain.inner_mass[0], chain.chain_stiffness[0]
    resonator = chain.resonator_frequency**2
    effective = outer + inner * resonator / (resonator - omega**2)
    return np.arccos(1 - omega**2 * effective / (2 * stiffness) + 0j)


def test_band_edges_of_the_infinite_chain_bound_the_attenuation_of_a_long_one() -> None:
    """Bloch: κ = π at the lower edge, κ = 0 at the upper one, √(1 + m_i/m_o); 60 cells attenuate between them."""
    chain = Chain.from_ratios(cells=60, **UNDAMPED)
    omega_r = chain.resonator_frequency

    def cosine_above_minus_one(eta):
        return np.real(np.cos(wave_number(chain, eta * omega_r))) + 1

    lower, upper = brentq(cosine_above_minus_one, 0.5, 0.99), np.sqrt(2.0)
    for eta in np.linspace(lower + 0.02, upper - 0.02, 9):
        assert frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, eta)) < 1e-3
    inside = [
        frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, eta)) for eta in (0.3, 0.6, 0.8, 1.5, 2.0)
    ]
    assert min(inside) > 0.3
    assert np.real(wave_number(chain, lower * omega_r)) == pytest.approx(np.pi, abs=1e-5)


def test_force_drive_of_a_single_cell_has_the_response_of_two_masses() -> None:
    """One cell by hand: (k_c + k_i − m_o ω²) u − k_i v = P, −k_i u + (k_i − m_i ω²) v = 0."""
    chain = Chain.from_ratios(cells=1, mass_ratio=0.5, stiffness_ratio=0.3, **UNDAMPED)
    omega = 0.4 * chain.resonator_frequency
    m_o, m_i = chain.outer_mass[0], chain.inner_mass[0]
    k_c, k_i = chain.chain_stiffness[0], chain.inner_stiffness[0]
    inner = k_i / (k_i - m_i * omega**2)
    outer = 2.0 / (k_c + k_i - m_o * omega**2 - k_i * inner)
    response = frictionless_response(chain, HarmonicForce(2.0, omega))
    assert response == pytest.approx([outer, outer * inner])
