"""What several engines state alike: known deviations, bounds in a turned row, limits of single precision."""

from collections.abc import Sequence

import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.errors import ParameterError

IMPLICIT_SPRINGS = (
    "springs are implicit and damp as dashpots of k dt beside them would, about as strongly as its own: "
    "the error is of first order, but not yet in proportion to the step"
)


def check_mass_ratio(lanes: Sequence[Lane], largest: float, title: str) -> None:
    """Refuse chains with an inner mass over `largest` times its outer one, which single precision loses beside it."""
    ratio = max(float(np.max(lane.chain.inner_mass / lane.chain.outer_mass)) for lane in lanes)
    if ratio > largest:
        raise ParameterError(
            f"inner mass over outer mass = {ratio:g}; allowed: at most {largest:g} in {title}, of single precision"
        )


def tangents_of_the_world(lane: Lane, _: float = 0.0) -> float:
    """Give the bound of sliding friction over μ λ_N where two fixed tangents have one each: |cos α| + |sin α|.

    Friction is in the corner of a square then, and not on the circle of Coulomb's law: it is too large by up to √2. The
    row is turned by α from one of the tangents; the velocity of the slip has no part in it.
    """
    along, aside = lane.axis
    return abs(along) + abs(aside)
