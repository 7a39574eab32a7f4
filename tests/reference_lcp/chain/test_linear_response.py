"""The linear limits against Bloch's theorem for the infinite chain and the closed form of the finite one."""

import numpy as np
import pytest

from reference_lcp import Chain, HarmonicForce, frictionless_transmittance
from reference_lcp import stuck_transmittance as stuck
from reference_lcp.chain.linear_response import frictionless_response
from tests.reference_lcp.cases import driven

UNDAMPED = {"damping_ratio": 0.0}


def wave_number(chain, omega, *, locked=False):
    """Complex Bloch wave number κ: cos κ = 1 − ω² m_eff / (2 k_c)."""
    outer, inner, stiffness = chain.outer_mass[0], chain.inner_mass[0], chain.chain_stiffness[0]
    resonator = chain.resonator_frequency**2
    effective = outer + inner if locked else outer + inner * resonator / (resonator - omega**2)
    return np.arccos(1 - omega**2 * effective / (2 * stiffness) + 0j)


def closed_form(chain, omega, *, locked=False):
    """|U_n| / U0 of a chain of n cells with a free end: cos(κ/2) / cos((n + 1/2) κ)."""
    kappa = wave_number(chain, omega, locked=locked)
    return float(np.abs(np.cos(kappa / 2) / np.cos((chain.cells + 0.5) * kappa)))


@pytest.mark.parametrize("cells", [1, 2, 7, 20])
@pytest.mark.parametrize("ratio", [0.2, 0.55, 0.95, 1.3, 1.9, 2.4])
@pytest.mark.parametrize(("transmittance", "locked"), [(frictionless_transmittance, False), (stuck, True)])
def test_finite_chain_has_the_transmittance_of_its_closed_form(transmittance, locked, ratio, cells) -> None:
    """In pass bands and in gaps; the transfer matrix of the finite chain (Al Ba'ba'a, Nouh, Singh 2017)."""
    chain, drive = driven(ratio, cells=cells, mass_ratio=0.7, stiffness_ratio=0.6, **UNDAMPED)
    exact = closed_form(chain, drive.angular_frequency, locked=locked)
    assert transmittance(chain, drive) == pytest.approx(exact, rel=1e-9)


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
