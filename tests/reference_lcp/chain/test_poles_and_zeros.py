"""The closed form of the finite chain against the linear solution and Bloch's waves."""

from dataclasses import replace

import numpy as np
import pytest

from reference_lcp import Chain, HarmonicBase, HarmonicForce, ParameterError
from reference_lcp.chain.linear_response import frictionless_response, stuck_response
from reference_lcp.chain.poles_and_zeros import closed_form_response

CELLS = (1, 2, 7, 20, 60)

ROUND_OFF = 1e-13
"""Of the displacement scale, and of what a change of the frequency makes of the response: some 500 units of 2^-53."""

SHIFT = 1e-7
"""Relative change of the frequency that shows the slope of a response."""


def random_case(seed: int, cells: int):
    """A chain of equal cells, with one dashpot, both or none, and a base or a force that drives it."""
    rng = np.random.default_rng([seed, cells])
    chain = Chain.from_ratios(
        cells=cells, mass_ratio=rng.uniform(0.2, 2), stiffness_ratio=rng.uniform(0.2, 2),
        damping_ratio=rng.choice([0.0, 0.01, 0.3]), inner_damping_ratio=rng.choice([0.0, 0.02]),
    )  # fmt: skip
    omega = rng.uniform(0.1, 3) * chain.resonator_frequency
    return chain, HarmonicBase(0.01, omega) if seed % 2 else HarmonicForce(3.0, omega)


@pytest.mark.parametrize("cells", CELLS)
@pytest.mark.parametrize("stuck", [False, True])
def test_matrix_and_closed_form_have_one_response(cells, stuck) -> None:
    linear = stuck_response if stuck else frictionless_response
    for seed in range(200):
        chain, drive = random_case(seed, cells)
        exact, found = closed_form_response(chain, drive, stuck=stuck), linear(chain, drive)[cells - 1]
        nearby = replace(drive, angular_frequency=drive.angular_frequency * (1 + SHIFT))
        slope = abs(closed_form_response(chain, nearby, stuck=stuck) - exact) / SHIFT
        assert abs(found - exact) <= ROUND_OFF * (drive.displacement_scale(chain) + slope)


def waves(chain: Chain, omega: float) -> complex:
    """U_n / U0 by the wave that runs to the free end and back: cos(κ/2) / cos((n + 1/2) κ)."""
    stiffness = chain.inner_stiffness[0] + 1j * omega * chain.inner_damping[0]
    moved = chain.outer_mass[0] + chain.inner_mass[0] * stiffness / (stiffness - omega**2 * chain.inner_mass[0])
    spring = chain.chain_stiffness[0] + 1j * omega * chain.chain_damping[0]
    kappa = np.arccos(1 - omega**2 * moved / (2 * spring) + 0j)
    return complex(np.cos(kappa / 2) / np.cos((chain.cells + 0.5) * kappa))


@pytest.mark.parametrize("cells", CELLS)
def test_response_deep_inside_a_band_gap_is_that_of_an_evanescent_wave(cells) -> None:
    """Down to 1e-93 of the base, where the round-off of a matrix is all that it gives."""
    smallest = 1.0
    for seed in range(1, 400, 2):
        chain, base = random_case(seed, cells)
        exact = waves(chain, base.angular_frequency)
        # of the phase (n + 1/2) κ, which arccos gives to round-off but near the edges of the bands
        assert closed_form_response(chain, base) / base.amplitude == pytest.approx(exact, rel=1e-11 * cells, abs=0)
        smallest = min(smallest, abs(exact))
    assert smallest < 10.0**-cells


def test_the_base_does_not_move_the_end_at_the_frequency_of_undamped_resonators() -> None:
    chain = Chain.from_ratios(cells=3, damping_ratio=0.0)
    assert closed_form_response(chain, HarmonicBase.from_ratio(chain, 1.0)) == 0


def test_chain_of_unequal_cells_is_refused_with_what_differs() -> None:
    chain = Chain.from_ratios(cells=2, mass_ratio=[1.0, 0.5])
    with pytest.raises(ParameterError, match=r"inner_mass = 0\.5 to 1; allowed: one value"):
        closed_form_response(chain, HarmonicBase.from_ratio(chain, 0.8))
