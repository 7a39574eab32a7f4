"""The chain in pyHarm (SAFRAN): harmonic balance, with friction by dynamic Lagrangian frequency-time (DLFT)."""

import logging
import warnings
from collections.abc import Sequence

import numpy as np
from scipy.optimize import root

from multibody_xval.scenarios.model import Case

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from pyHarm.Maestro import Maestro

SAMPLES = 64
"""Of a period for each harmonic, at least `FEWEST`: with four times as many no error changes in its second digit."""

FEWEST = 256

SOLVED = 1e-8
"""Residual over k U0 of a solution."""

RESTARTS = 6
"""Of the search, each with a fresh Jacobian: SciPy updates it in between."""


def odd(count: int) -> list[int]:
    """Give the first odd harmonics: motion and friction change sign after half a period, so that even ones are zero."""
    return list(range(1, 2 * count, 2))


def transmittance(case: Case, counts: Sequence[int]) -> list[complex]:
    """Give the transmittance with so many odd harmonics, each search from the solution before; NaN without a solution.

    pyHarm's own Jacobian of friction is not the derivative of its residual, and no search with it converges on the
    chain. Its residual is solved by SciPy, with a Jacobian by differences.
    """
    found, start = [], np.zeros(0)
    for count in counts:
        system, omega, unit = built(case, odd(count))
        scale = np.append(np.full(system.ndofs, case.displacement), 1.0)

        def residual(x: np.ndarray, system=system, omega=omega, unit=unit, scale=scale) -> np.ndarray:
            return system.Residual(np.append(x, omega) * scale) / unit

        start = np.append(start, np.zeros(system.ndofs - start.size))
        for _ in range(RESTARTS):
            solution = root(residual, start, jac=lambda x, own=residual: differences(own, x))
            start = solution.x
            if np.linalg.norm(solution.fun) < SOLVED:
                break
        solved = np.linalg.norm(solution.fun) < SOLVED
        found.append(last_mass(system, start, case.cells) if solved else complex("nan"))
    return found


def built(case: Case, harmonics: list[int]):
    """Build the system of a case; give it with ω [rad/s] and the unit of force k U0 [N]."""
    chain, drive = case.setting
    omega, amplitude, cells = drive.angular_frequency, case.displacement, case.cells
    stiffness, damping = float(chain.chain_stiffness[0]), float(chain.chain_damping[0])
    own = {"dirs": [0], "connect": {"chain": [0]}}
    connectors = {
        "spring": {"type": "SinusForcing", "amp": stiffness * amplitude, **own},
        "dashpot": {"type": "GOForcing", "amp": damping * amplitude, "dto": 1, "ho": 1, "phi": np.pi / 2, **own},
    }
    for cell, bound in enumerate(chain.friction_bound.tolist()):
        ends = {"chain": [cells + cell], "INTERNAL": [cell]}
        connectors[f"contact {cell}"] = {
            "type": "DLFTFriction", "connect": ends, "dirs": [0], "mu": 1.0, "N0": bound, "eps": stiffness,
        }  # fmt: skip
    matrices = {"M": chain.mass_matrix, "C": chain.damping_matrix, "K": chain.stiffness_matrix}
    samples = max(FEWEST, SAMPLES * len(harmonics))
    logging.disable(logging.CRITICAL)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        system = Maestro(
            {
                "system": {"type": "Base", "nh": harmonics, "nti": samples},
                "substructures": {"chain": {"matrix": matrices, "ndofs": 1}},
                "connectors": connectors,
            }
        ).system
    logging.disable(logging.NOTSET)
    return system, omega, stiffness * amplitude


def differences(function, x: np.ndarray, step: float = 1e-8) -> np.ndarray:
    """Give a Jacobian by forward differences."""
    at = function(x)
    return np.stack([(function(x + step * unit) - at) / step for unit in np.eye(x.size)], axis=1)


def last_mass(system, x: np.ndarray, cells: int) -> complex:
    """Give the fundamental of the last outer mass over U0, for a base that moves as U0 sin ωt."""
    of = system.expl_dofs
    own = of[(of.node_num == cells - 1) & (of.harm == 1)]
    cosine, sine = (float(x[own.index[own.cs == name][0]]) for name in ("c", "s"))
    return complex(sine, cosine)
