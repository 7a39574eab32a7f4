"""Systems of bodies and contacts whose step is written down as a function."""

from dataclasses import dataclass

import numpy as np

from reference_lcp import FrictionalStep

GRAVITY = 9.81
ROUND_OFF = 1e-10
"""Relative; the motion within a step is exact here, and some thousand steps add their roundings."""


@dataclass
class System:
    """A system whose step is a function of time, position, velocity and time step."""

    freedoms: int
    contacts: int
    step: object


def step_data(mass, force, velocity, dt, w_n, w_t, gap, slip, mu, *, w_tilde=None, motion_n=0.0, motion_t=0.0):
    """Equation (7)'s data; directions as rows, one a contact."""
    w_n, w_t = np.array(w_n, dtype=float).T, np.array(w_t, dtype=float).T
    contacts = w_n.shape[1]
    return FrictionalStep(
        mass_matrix=np.diag(mass) * 1.0, force=np.array(force, dtype=float), velocity=velocity, time_step=dt,
        normal_directions=w_n, tangential_directions=w_t,
        tangential_directions_of_position=np.zeros_like(w_n) if w_tilde is None else np.array(w_tilde).T,
        normal_motion=np.full(contacts, motion_n), tangential_motion=np.full(contacts, motion_t),
        normal_gap=np.array(gap, dtype=float), relative_velocity=np.array(slip, dtype=float),
        friction_coefficient=np.full(contacts, mu),
    )  # fmt: skip
