"""Contacts whose faces are inclined to the row, and the friction at which their motion is no longer unique."""

import math

import numpy as np

from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.refusal import ParameterError
from reference_lcp.validation import FloatArray, checked_scalar


def uniqueness_margin(chain: Chain, inclination: float) -> FloatArray:
    """Give m_i (G_NN − μ |G_NT|) = 1 + (sin² α − μ |sin α cos α|) m_i / m_o of every contact, shape (n,).

    Where it is positive a step of a contact has one solution. Where it is not, friction that a normal force makes
    presses a slipping contact together more than that force parts it (Painlevé, 1895): there may be several solutions
    or none. That takes outer masses below m_i (√(1 + μ²) − 1) / 2.
    """
    along, across = math.cos(inclination), math.sin(inclination)
    coupling = across**2 - chain.friction_coefficient * abs(across * along)
    margin: FloatArray = 1 + coupling * chain.inner_mass / chain.outer_mass
    return margin


def check_inclination(chain: Chain, inclination: float) -> None:
    """Raise a `ParameterError` unless −π/2 < `inclination` < π/2 [rad], and the motion of every contact is unique."""
    if abs(checked_scalar("inclination", inclination)) >= math.pi / 2:
        raise ParameterError(f"inclination = {inclination:g} is outside its range; allowed: (-pi/2, pi/2)")
    margin = uniqueness_margin(chain, inclination)
    if np.any(margin <= 0):
        cell = int(np.argmin(margin))
        across, along = math.sin(inclination), abs(math.cos(inclination))
        largest = (float(chain.outer_mass[cell] / chain.inner_mass[cell]) + across**2) / abs(across * along)
        raise ParameterError(
            f"friction_coefficient = {chain.friction_coefficient[cell]:g} in cell {cell + 1} with inclination = "
            f"{inclination:g}: its motion is not unique; allowed: < {largest:.4g}"
        )
