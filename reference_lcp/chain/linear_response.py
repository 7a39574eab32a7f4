"""The two limits without friction's nonlinearity: contacts that slide freely, contacts that never slide."""

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.drives import HarmonicBase, PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain


def frictionless_response(chain: Chain, drive: PeriodicDrive) -> NDArray[np.complex128]:
    """Complex amplitudes [m] of all masses with friction left out, shape (2n,), outer masses first.

    Solves (K + iωC − ω²M) x = f; a displacement is Im(x exp(iωt)), as the base's is U0 sin ωt. To round-off of the
    largest amplitude: deep inside a band gap `reference_lcp.chain.poles_and_zeros` alone gives the last mass.
    """
    return _response(chain, drive, np.eye(2 * chain.cells))


def stuck_response(chain: Chain, drive: PeriodicDrive) -> NDArray[np.complex128]:
    """Complex amplitudes [m] with every inner mass fixed to its outer mass; as `frictionless_response`."""
    return _response(chain, drive, stuck_basis(chain))


def stuck_basis(chain: Chain) -> NDArray[np.float64]:
    """Displacements of all masses in which both of a cell move alike, shape (2n, n)."""
    return np.vstack([np.eye(chain.cells), np.eye(chain.cells)])


def frictionless_transmittance(chain: Chain, drive: PeriodicDrive) -> float:
    """|U_n| over the displacement scale with friction left out."""
    return float(np.abs(frictionless_response(chain, drive)[chain.cells - 1]) / drive.displacement_scale(chain))


def stuck_transmittance(chain: Chain, drive: PeriodicDrive) -> float:
    """|U_n| over the displacement scale with every contact stuck."""
    return float(np.abs(stuck_response(chain, drive)[chain.cells - 1]) / drive.displacement_scale(chain))


def _response(chain: Chain, drive: PeriodicDrive, basis: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Solve in the subspace of `basis`, shape (2n, k)."""
    omega = drive.angular_frequency
    dynamic = chain.stiffness_matrix + 1j * omega * chain.damping_matrix - omega**2 * chain.mass_matrix
    force = np.zeros(2 * chain.cells, dtype=np.complex128)
    if isinstance(drive, HarmonicBase):
        force[0] = (chain.chain_stiffness[0] + 1j * omega * chain.chain_damping[0]) * drive.amplitude
    else:
        force[0] = drive.amplitude
    return basis @ np.linalg.solve(basis.T @ dynamic @ basis, basis.T @ force)
