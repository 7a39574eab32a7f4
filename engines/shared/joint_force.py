"""Friction of joints in engines of single precision that tell the force along a joint, whatever it is made of."""

import numpy as np

from engines.interface.tolerances import SINGLE
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.validation import FloatArray

ROUNDINGS = 16
"""Of the forces that make up the one along a joint. Measured are 4 where a step, or each of ten substeps, has one
impulse, and 10 where those of 32 substeps are added."""


def friction_of_joints(along: FloatArray, applied: FloatArray, bound: FloatArray, chain: Chain) -> FloatArray:
    """Give the friction on the carried masses of `CarriedCoordinates`, shape (steps, n).

    It is taken for its bound where it is as near to it as single precision can tell.

    Parameters
    ----------
    along
        What the engine says after a step that acts along the joints of carried masses, shape (steps, n): friction, and
        what was applied.
    applied
        Generalised forces that were applied in the step, shape (steps, 2n).
    bound
        μ λ_N in the step, shape (steps, n).
    chain
        The chain, in the same units.
    """
    on_both, on_carried = np.split(applied, 2, axis=-1)
    friction = along - on_carried
    heavier, lighter = np.maximum(chain.outer_mass, chain.inner_mass), np.minimum(chain.outer_mass, chain.inner_mass)
    # What accelerates the carrier pulls at what it carries.
    pulling = lighter / heavier * (np.abs(on_both - on_carried) + bound)
    rounding = ROUNDINGS * SINGLE * (bound + np.abs(on_carried) + pulling)
    return np.where(np.abs(friction) > bound - rounding, np.copysign(bound, friction), friction)
