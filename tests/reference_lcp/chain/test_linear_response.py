"""The linear limits with a force on the first mass; `test_poles_and_zeros` has those of a moving base."""

import pytest

from reference_lcp import Chain, HarmonicForce
from reference_lcp.chain.linear_response import frictionless_response


def test_force_drive_of_a_single_cell_has_the_response_of_two_masses() -> None:
    """One cell by hand: (k_c + k_i − m_o ω²) u − k_i v = P, −k_i u + (k_i − m_i ω²) v = 0."""
    chain = Chain.from_ratios(cells=1, mass_ratio=0.5, stiffness_ratio=0.3, damping_ratio=0.0)
    omega = 0.4 * chain.resonator_frequency
    m_o, m_i = chain.outer_mass[0], chain.inner_mass[0]
    k_c, k_i = chain.chain_stiffness[0], chain.inner_stiffness[0]
    inner = k_i / (k_i - m_i * omega**2)
    outer = 2.0 / (k_c + k_i - m_o * omega**2 - k_i * inner)
    response = frictionless_response(chain, HarmonicForce(2.0, omega))
    assert response == pytest.approx([outer, outer * inner])
