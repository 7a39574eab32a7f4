"""How much friction changes a steady state at all: the measure of which errors of a step are too large to say anything.

Between contacts that slide freely and contacts that never slide, a linear chain each, lies what friction can do. An
engine whose own step leaves open a large part of that has not been tested by a comparison that it passes.
"""

import cmath
import math
from dataclasses import dataclass

from reference_lcp.chain.harmonic import PeriodicDrive
from reference_lcp.chain.linear_response import frictionless_response, stuck_response
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.observables.transmittance import decibel
from scenarios.verdicts.finding import TRANSMITTANCE


@dataclass(frozen=True)
class FrictionEffect:
    """How far a steady state may be from the farther one of the two linear limits.

    Parameters
    ----------
    transmittance_db
        Of the transmittance [dB].
    phase
        Of its phase [°].
    """

    transmittance_db: float
    phase: float


def friction_effect(
    chain: Chain, drive: PeriodicDrive, transmittance_db: float, phase: float, inclination: float = 0.0
) -> FrictionEffect:
    """Give how far a transmittance [dB] and its phase [rad] are from the linear limit that is farther from each."""
    scale = drive.displacement_scale(chain)
    responses = frictionless_response(chain, drive, inclination), stuck_response(chain, drive)
    limits = [complex(response[chain.cells - 1]) / scale for response in responses]
    level = TRANSMITTANCE.scaled(transmittance_db)
    return FrictionEffect(
        max(abs(TRANSMITTANCE.scaled(decibel(abs(limit))) - level) for limit in limits),
        max(abs(math.degrees(math.remainder(cmath.phase(limit) - phase, 2 * math.pi))) for limit in limits),
    )
