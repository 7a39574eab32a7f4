"""The two limits without friction's nonlinearity: contacts that slide freely, contacts that never slide."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.drives import HarmonicBase, PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.output import shown_in_notebooks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FREQUENCY_RATIOS = np.linspace(0.1, 3.0, 1451)
"""η_r at which both limits are drawn: every 0.002."""

LOWEST_DB = -80.0
"""Lowest transmittance that is drawn [dB]."""


def frictionless_response(chain: Chain, drive: PeriodicDrive) -> NDArray[np.complex128]:
    """Complex amplitudes [m] of all masses with friction left out, shape (2n,), outer masses first.

    Solves (K + iωC − ω²M) x = f; a displacement is Im(x exp(iωt)), as the base's is U0 sin ωt.
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


def plot_limits(chain: Chain) -> "Figure":
    """Draw both transmittances [dB] over η_r; see `Chain.plot`."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.0, 3.0), layout="constrained")
    axes = figure.subplots()
    drives = [HarmonicBase.from_ratio(chain, eta) for eta in FREQUENCY_RATIOS.tolist()]
    for name, transmittance in {"contacts free": frictionless_transmittance, "stuck": stuck_transmittance}.items():
        level = np.array([transmittance(chain, drive) for drive in drives])
        with np.errstate(divide="ignore"):  # nothing arrives where an undamped inner mass is in resonance
            axes.plot(FREQUENCY_RATIOS, 20 * np.log10(level), label=name)
    axes.axhline(0.0, color="0.4", linewidth=0.6)
    axes.set(xlabel="frequency ratio ω / ω_r [-]", ylabel="transmittance [dB]", xlim=FREQUENCY_RATIOS[[0, -1]])
    axes.set_ylim(bottom=max(axes.get_ylim()[0], LOWEST_DB))
    axes.legend(frameon=False)
    axes.grid(alpha=0.3)
    return shown_in_notebooks(figure)


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
