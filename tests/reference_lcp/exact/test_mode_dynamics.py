"""The linear motion between two changes of mode, against the matrix exponential."""

import numpy as np
import pytest
from scipy.linalg import expm

from reference_lcp import Chain, HarmonicBase
from reference_lcp.exact.mode_dynamics import PiecewiseLinearChain


@pytest.mark.parametrize("damping_ratio", [0.0, 0.01, 1.0])
@pytest.mark.parametrize("stuck", [(False, False, False), (True, False, True), (True, True, True)])
def test_propagator_is_the_exponential_of_the_rates(stuck, damping_ratio) -> None:
    """The rates are read from motions that begin with one unit vector each."""
    chain = Chain.from_ratios(cells=3, friction_ratio=0.3, damping_ratio=damping_ratio)
    system = PiecewiseLinearChain(chain, HarmonicBase.from_ratio(chain, 0.9))
    pattern = np.array(stuck)
    units = np.eye(system.size)[:, :12]
    rates = np.array([system.rates(unit, pattern)[:12] for unit in units.T]).T
    for part in (1.0, 0.3, 1e-9):
        expected = expm(rates * part * system.span)
        propagator = system.propagator(pattern, part * system.span)
        assert np.max(np.abs(propagator - expected)) < 1e-14 * np.max(np.abs(expected))
