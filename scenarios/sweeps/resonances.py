"""Natural frequencies of a chain, with free and with stuck contacts: where its curves have narrow peaks."""

import numpy as np
import scipy.linalg

from reference_lcp.chain.linear_response import stuck_basis
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.validation import FloatArray
from scenarios.tasks.parameters import ChainRatios


def resonances(ratios: ChainRatios) -> FloatArray:
    """Natural frequencies over ω_r of the chain with free and with stuck contacts, ascending.

    Between them, the transmittance of every friction ratio is smooth; narrow peaks are at them.
    """
    chain = ratios.chain(0.0)
    return np.sort(np.concatenate([free_resonances(ratios), _in_subspace(chain, stuck_basis(chain))]))


def free_resonances(ratios: ChainRatios) -> FloatArray:
    """Natural frequencies over ω_r of the chain without friction, ascending; shape (2n,)."""
    chain = ratios.chain(0.0)
    return _in_subspace(chain, np.eye(2 * chain.cells))


def _in_subspace(chain: Chain, basis: FloatArray) -> FloatArray:
    """Natural frequencies over ω_r in the subspace of `basis`, ascending."""
    stiffness, mass = (basis.T @ matrix @ basis for matrix in (chain.stiffness_matrix, chain.mass_matrix))
    return np.sqrt(scipy.linalg.eigh(stiffness, mass, eigvals_only=True)) / chain.resonator_frequency
