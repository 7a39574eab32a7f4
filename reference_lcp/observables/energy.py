"""Energy of the chain."""

import numpy as np

from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.validation import FloatArray


def mechanical_energy(chain: Chain, positions: FloatArray, velocities: FloatArray) -> FloatArray:
    """Kinetic energy and energy of the springs [J], the base at zero.

    Sums over the elements: no matrix of the chain is built, however long it is.

    Parameters
    ----------
    chain
        What moves.
    positions, velocities
        [m] and [m/s], outer masses first, shape (times, 2n).

    Returns
    -------
    ndarray
        Shape (times,).
    """
    cells = chain.cells
    outer, inner = positions[:, :cells], positions[:, cells:]
    kinetic = velocities[:, :cells] ** 2 @ chain.outer_mass + velocities[:, cells:] ** 2 @ chain.inner_mass
    elastic = np.diff(outer, axis=1, prepend=0.0) ** 2 @ chain.chain_stiffness
    total: FloatArray = (kinetic + elastic + (inner - outer) ** 2 @ chain.inner_stiffness) / 2
    return total
