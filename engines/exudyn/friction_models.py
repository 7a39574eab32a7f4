"""Friction of Exudyn's contacts as models: what a contact does in a substep, and what it keeps from one to the next.

The end of a substep has elongations x = v_i − u_i and slip velocities w, of which the forces φ = −λ of the contacts
take their part: x = x_free − P φ, w = w_free − V φ. `contacts`, shape (2, n), is what is kept: nothing for a zone; for
a disc the slip velocity of the last correction; for a bristle the force of its slip, 0 in stick, and the place of its
foot.
"""

from dataclasses import dataclass

from reference_lcp.validation import FloatArray

ZONE, DISC, BRISTLE = 0, 1, 2

DISC_CORRECTIONS = 5
"""Exudyn's own discontinuous.maxIterations: the fifth correction is taken, whatever its error."""


@dataclass(frozen=True)
class ContactNumbers:
    """Friction of all contacts of a chain.

    Parameters
    ----------
    kind
        Which of the models.
    bound
        F [N], shape (n,).
    first
        Shape (n,): width of the zone [m/s], or stiffness of the bristles [N/m].
    second
        Shape (n,): dashpots of the bristles [N s/m].
    tolerance
        Error of the force [N] at which a disc is corrected no more.
    """

    kind: int
    bound: FloatArray
    first: FloatArray
    second: FloatArray
    tolerance: float = 0.0
