"""The frictionless chain of any number of equal cells in closed form: its transfer function by poles and zeros.

With s = iω, the complex stiffnesses κ_c = k_c + s c_c and κ_i = k_i + s c_i, and the resonators eliminated, the outer
masses obey κ_c A u + s² (m_o + m_i κ_i / d) u = κ_c U0 e_1, d = κ_i + m_i s². A is the matrix of a row of unit springs
that is fixed at the left and free at the right. Its determinant is one, so is the cofactor that leads to the last mass,
and its eigenvalues are λ_j = 4 sin²((2j − 1) π / (4n + 2)). Hence

    U_n / U0 = Π_j λ_j κ_c d / (λ_j κ_c d + s² (m_o d + m_i κ_i)),        j = 1 … n,

with n zeros at each root of d and of κ_c, and four poles for every j. Al Ba'ba'a, Nouh and Singh, "Formation of local
resonance band gaps in finite acoustic metamaterials: A closed-form transfer function model" (2017, arXiv 1701.02431),
derive such functions. It needs no matrix, and so is a limit independent of `reference_lcp.chain.linear_response`.
"""

import numpy as np

from reference_lcp.chain.drives import HarmonicBase, PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

EQUAL = ("outer_mass", "inner_mass", "chain_stiffness", "inner_stiffness", "chain_damping", "inner_damping")
"""Parameters that all cells have to share."""


def closed_form_response(chain: Chain, drive: PeriodicDrive, *, stuck: bool = False) -> complex:
    """Complex amplitude [m] of the last outer mass with friction left out, or with every contact stuck.

    A displacement is Im(x exp(iωt)), as the base's is U0 sin ωt, and a force P0 sin ωt.

    Raises
    ------
    ParameterError
        If cells differ: there is no closed form.
    """
    outer, inner, spring, resonator = _polynomials(chain)
    s = 1j * drive.angular_frequency
    if stuck:
        stiffness, inertia = np.polyval(spring, s), s**2 * (chain.outer_mass[0] + chain.inner_mass[0])
    else:
        stiffness, inertia = np.polyval(np.polymul(spring, resonator), s), np.polyval(np.polyadd(outer, inner), s)
    eigenvalues = row_eigenvalues(chain.cells)
    ratio = complex(np.prod(eigenvalues * stiffness / (eigenvalues * stiffness + inertia)))
    # a force P0 on cell 1 is a base that moves by P0 / κ_c
    return ratio * drive.amplitude / (1.0 if isinstance(drive, HarmonicBase) else complex(np.polyval(spring, s)))


def row_eigenvalues(cells: int) -> FloatArray:
    """λ_j of a row of unit masses and springs, fixed at one end, shape (n,), in rising order."""
    return np.asarray(4 * np.sin((2 * np.arange(1, cells + 1) - 1) * np.pi / (4 * cells + 2)) ** 2)


def _polynomials(chain: Chain) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Give s² m_o d, s² m_i κ_i, κ_c and d as polynomials in s, highest power first."""
    for name in EQUAL:
        values = getattr(chain, name)
        if np.ptp(values) > 0:
            raise ParameterError(
                f"{name} = {values.min():g} to {values.max():g}; allowed: one value in all cells, for a closed form"
            )
    m_o, m_i, k_c, k_i, c_c, c_i = (float(getattr(chain, name)[0]) for name in EQUAL)
    resonator = np.array([m_i, c_i, k_i])
    return m_o * np.append(resonator, [0.0, 0.0]), m_i * np.array([c_i, k_i, 0.0, 0.0]), np.array([c_c, k_c]), resonator
