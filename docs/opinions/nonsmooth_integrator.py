"""The chain in solve_nivp (Riley and Stefanou): implicit steps, with Coulomb's law by projection in each of them."""

from typing import NamedTuple

import numpy as np
from solve_nivp import solve_ivp_ns

from multibody_xval.scenarios.model import Case
from reference_lcp import exact_steady_state

SOLVER = {"globalization": "linesearch", "tol": 1e-9}
"""Without the line search, which is off unless asked for, the solver gives up a third of the steps."""


class Period(NamedTuple):
    """One period that begins in the exact motion's state."""

    transmittance: complex
    returns: float
    """Largest distance of a mass from where the period began, over U0: zero of a steady state."""
    unsolved: int
    """Steps that the solver gave up."""


def period(case: Case, steps: int, method: str = "composite") -> Period:
    """Integrate one period with so many equal steps; positions of inner masses are relative to the outer ones."""
    chain, drive = case.setting
    cells, omega = case.cells, drive.angular_frequency
    relative = np.eye(2 * cells)
    relative[cells:, :cells] = np.eye(cells)  # absolute from relative positions
    mass, damping, stiffness = (
        relative.T @ own @ relative for own in (chain.mass_matrix, chain.damping_matrix, chain.stiffness_matrix)
    )
    rest, unit = np.zeros_like(mass), np.eye(2 * cells)
    rates = np.block([[rest, unit], [-stiffness, -damping]])
    spring, dashpot = float(chain.chain_stiffness[0]), float(chain.chain_damping[0])
    bounds = np.zeros(4 * cells)
    bounds[3 * cells :] = chain.friction_bound

    def rhs(t: float, y: np.ndarray) -> np.ndarray:
        rate = rates @ y
        base = spring * np.sin(omega * t) + dashpot * omega * np.cos(omega * t)
        rate[2 * cells] += case.displacement * base
        return rate

    begins = exact_steady_state(chain, drive).orbit.trajectory
    state = np.linalg.solve(relative, np.stack([begins.positions[-1], begins.velocities[-1]], axis=1)).T.ravel()
    length = 2 * np.pi / omega
    times, states, *_, ended = solve_ivp_ns(
        rhs, (0.0, length), state, method=method, projection="coulomb", solver="semismooth_newton",
        projection_opts={
            "con_force_func": lambda _y, _t=None, _F=None: bounds, "rhok": 1.0, "conf_jacobian_mode": "none",
            "constraint_indices": np.arange(3 * cells, 4 * cells),
        },
        solver_opts={"rhs_jac": lambda _t, _y: rates, **SOLVER},
        adaptive=False, h0=length / steps, A=np.block([[unit, rest], [rest, mass]]),
    )  # fmt: skip
    last = np.trapezoid(states[:, cells - 1] * np.exp(-1j * omega * times), times)
    away = np.abs((states[-1] - states[0])[: 2 * cells]).max()
    unsolved = sum(not solved for _, solved, _ in ended)
    return Period(2j * complex(last) / length / case.displacement, away / case.displacement, unsolved)
