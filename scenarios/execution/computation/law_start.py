"""Where the search for an engine's steady state begins: in that of the law by which the engine says that it steps.

The law's orbit is found in milliseconds. An engine that obeys its law repeats it in its first period, whose residual
certifies it as that of any other start would; one that does not goes on from there. Where the law itself has no steady
state, the engine is given some periods beside the best that was found of it, and no more. Where no law says, the search
begins beside the steady state of the reference's scheme.
"""

from collections.abc import Sequence

from engines.interface.law import Law
from engines.interface.law_engine import LAW_SUFFIX
from engines.interface.variant import Variant
from engines.shared.law_distance import stepped_by, unclaimed_reason
from reference_lcp.chain.simulation import Lane
from reference_lcp.steady.neighbours import orbits_beside_euler
from reference_lcp.steady.orbits import PeriodicOrbit, periodic_orbits

LAW_RESIDUAL = 0.1
"""Residual of the law's orbit over the one that certifies the engine's: what is left of it is the engine's own."""


def begins_beside(variant: Variant) -> bool:
    """Whether searches of a variant begin at steady states of models, or beside: not those of models themselves."""
    return variant.engine != "reference" and not variant.engine.endswith(LAW_SUFFIX)


def law_orbits(variant: Variant, lanes: Sequence[Lane], steps: int) -> list[PeriodicOrbit | None]:
    """Search the steady state of each lane's law; ``None`` where no law says.

    Those are variants of the reference and of laws themselves, presets whose steps are not modelled, and lanes that a
    law does not claim.
    """
    law = stepped_by(variant) if begins_beside(variant) else None
    every: list[PeriodicOrbit | None] = [None] * len(lanes)
    claimed = [number for number, lane in enumerate(lanes) if law is not None and unclaimed_reason(law, lane) is None]
    if law is None or not claimed:
        return every
    model, tolerance = law.build([lanes[number] for number in claimed]), LAW_RESIDUAL * variant.capabilities.residual
    search = orbits_beside_euler if isinstance(law, Law) else periodic_orbits
    orbits = search(model, steps, tolerance=tolerance, longest_multiple=1)
    for number, orbit in zip(claimed, orbits, strict=True):
        every[number] = orbit
    return every
