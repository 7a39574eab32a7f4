"""That all multipliers lie inside the unit circle: a power of the map's derivative has a norm below one."""

import numpy as np
from flint import arb, arb_mat
from numpy.typing import NDArray

from reference_lcp.exact.proof.candidate import Candidate
from reference_lcp.exact.proof.dynamics import Dynamics, identity
from reference_lcp.exact.proof.krawczyk import Equations, Solution
from reference_lcp.watching import tell

MOST_DOUBLINGS = 20
"""Squarings of the map's derivative: a million periods, in which a multiplier of 1 - 1e-6 shows."""


def contracts(dynamics: Dynamics, solution: Solution) -> bool:
    """Whether all multipliers, but for offsets of contacts that always stick, are proven to be inside the unit circle.

    The Jacobian on the wide box of the proof often suffices; where not, that on the enclosure of the solution is taken.
    """
    if _contracts(dynamics, solution.candidate, solution.jacobian):
        return True
    equations, candidate = Equations(dynamics, solution.candidate), solution.candidate
    box = [arb(candidate.state[k]) for k in candidate.unknown] + [arb(time) for time in candidate.times]
    rows, _ = equations.shoot(box, solution.flows, gradients=True)
    return _contracts(dynamics, candidate, arb_mat([row[1:] for row in rows]))


def _contracts(dynamics: Dynamics, candidate: Candidate, jacobian: arb_mat) -> bool:
    """Eliminate the times of events, and square the derivative M of the map: multipliers are within ‖M^p‖^(1/p).

    M is taken in coordinates in which the energy is the sum of squares: there it does not expand, so that balls of its
    powers grow slowly. That only helps: any coordinates would prove the same.
    """
    rows, m = jacobian.tolist(), len(candidate.events)
    size = len(rows) - m
    M = arb_mat([row[:size] for row in rows[m:]]) + dynamics.sign * identity(size)
    if m:
        by_state, by_time = (arb_mat([row[part] for row in rows[:m]]) for part in (slice(size), slice(size, size + m)))
        M -= arb_mat([row[size:] for row in rows[m:]]) * by_time.solve(by_state)
    scale = arb_mat(_energy_root(dynamics, candidate.unknown).tolist())
    M = scale * M * scale.inv()
    for _ in range(MOST_DOUBLINGS):
        tell()
        norm = sum((abs(entry) ** 2 for entry in M.entries()), arb(0)).sqrt().upper()
        if not norm.is_finite():
            break
        if norm < 1:
            return True
        M = M * M
    return False


def _energy_root(dynamics: Dynamics, unknown: list[int]) -> NDArray[np.floating]:
    """S with energy |S x|² / 2 of the unknown entries x of (u, g, u̇, ġ)."""
    chain, n = dynamics.exact.floating()[0], dynamics.cells
    energy = np.zeros((4 * n, 4 * n))
    elongation = np.eye(n) - np.eye(n, k=-1)
    energy[:n, :n] = elongation.T @ np.diag(chain.chain_stiffness) @ elongation
    energy[n : 2 * n, n : 2 * n] = np.diag(chain.inner_stiffness)
    inner = np.diag(chain.inner_mass)
    energy[2 * n :, 2 * n :] = np.block([[np.diag(chain.outer_mass) + inner, inner], [inner, inner]])
    return np.linalg.cholesky(energy[np.ix_(unknown, unknown)]).T
