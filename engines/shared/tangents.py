"""The bound of friction in a row that is turned, where each of two tangents of a contact has a bound of its own."""

from reference_lcp.chain.simulation import Lane


def tangents_of_the_world(lane: Lane, _: float = 0.0) -> float:
    """Give the bound of sliding friction over μ λ_N where two fixed tangents have one each: |cos α| + |sin α|.

    Friction is in the corner of a square then, and not on the circle of Coulomb's law: it is too large by up to √2. The
    row is turned by α from one of the tangents; the velocity of the slip has no part in it.
    """
    along, aside = lane.axis
    return abs(along) + abs(aside)
