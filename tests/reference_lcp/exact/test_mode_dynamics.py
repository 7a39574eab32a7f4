"""The linear motion between two changes of mode, against the matrix exponential."""

import numpy as np
import pytest
from scipy.linalg import expm

from reference_lcp import Chain, HarmonicBase
from reference_lcp.exact.mode_dynamics import SERIES_ORDER, PiecewiseLinearChain, monodromy
from reference_lcp.validation import FloatArray

PATTERNS = [(False, False, False), (True, False, True), (True, True, True)]


def three_cells(damping_ratio: float) -> tuple[Chain, PiecewiseLinearChain]:
    chain = Chain.from_ratios(
        cells=3, friction_ratio=0.3, mass_ratio=[1.0, 0.5, 2.0], damping_ratio=damping_ratio, inner_damping_ratio=0.02
    )
    return chain, PiecewiseLinearChain.of(chain, HarmonicBase.from_ratio(chain, 0.9))


def rates(chain: Chain, stuck: tuple[bool, ...]) -> FloatArray:
    """A of ẋ = A x with x = (u, v, u̇, v̇), from the matrices of the chain; masses that stick share their forces."""
    forces = -np.hstack([chain.stiffness_matrix, chain.damping_matrix])
    accelerations = forces / np.diag(chain.mass_matrix)[:, None]
    for i in np.flatnonzero(stuck):
        both = forces[[i, chain.cells + i]].sum(axis=0) / (chain.outer_mass[i] + chain.inner_mass[i])
        accelerations[[i, chain.cells + i]] = both
    still, unit = np.zeros((6, 6)), np.eye(6)
    return np.vstack([np.hstack([still, unit]), accelerations])


def propagator(system: PiecewiseLinearChain, stuck: tuple[bool, ...], duration: float) -> FloatArray:
    modes = np.where(stuck, 0, 1).astype(np.int8)[None]
    return monodromy(system, np.array([duration]), np.zeros((1, SERIES_ORDER + 1, 14)), modes).T


@pytest.mark.parametrize("damping_ratio", [0.0, 0.01, 1.0])
@pytest.mark.parametrize("stuck", PATTERNS)
def test_propagator_is_the_exponential_of_the_rates(stuck, damping_ratio) -> None:
    """Of motions whose masses move together where contacts stick."""
    chain, system = three_cells(damping_ratio)
    together = np.eye(12)
    for i in np.flatnonzero(stuck):
        share = chain.inner_mass[i] / (chain.outer_mass[i] + chain.inner_mass[i])
        together[[6 + i, 9 + i], 6 + i], together[[6 + i, 9 + i], 9 + i] = 1 - share, share
    for part in (1.0, 0.3, 1e-9):
        expected = expm(rates(chain, stuck) * part * system.span) @ together
        found = propagator(system, stuck, part * system.span)
        assert np.max(np.abs(found - expected)) < 1e-14 * np.max(np.abs(expected))
