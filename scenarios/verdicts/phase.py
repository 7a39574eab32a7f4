"""The phase of the transmittance: two motions of one size may still be apart by a delay."""

import math
from collections.abc import Callable

from scenarios.tasks.result import Result
from scenarios.verdicts.finding import FLOOR_DB, Metric

PHASE = Metric("phase", "°", "by which the fundamental of the last outer mass is ahead of the drive's sine")


def phase_reader(expected: float, transmittance_db: float) -> Callable[[Result], float]:
    """Give what reads the phase of a result [°], within half a turn of what is expected.

    Below the floor of `TRANSMITTANCE` differences are those of amplitudes, as there: a phase counts less and less.

    Parameters
    ----------
    expected
        The expected phase [rad].
    transmittance_db
        The expected transmittance [dB].
    """
    weight = min(1.0, 10 ** ((transmittance_db - FLOOR_DB) / 20))

    def read(result: Result) -> float:
        return math.degrees(expected + weight * math.remainder(result.phase - expected, 2 * math.pi))

    return read


def amplitude_in_degrees(amplitude: float, transmittance_db: float) -> float:
    """What a change of the amplitude, over U0, makes of the phase at this transmittance [°]; at most half a turn."""
    return min(180.0, math.degrees(amplitude * 10 ** (-max(transmittance_db, FLOOR_DB) / 20)))
