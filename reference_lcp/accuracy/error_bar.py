"""Error bars: how far a steady state of the Euler scheme is from that of the continuous motion.

The steady state is found with three step sizes, and `reference_lcp.accuracy.richardson` estimates the error from them.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from reference_lcp.accuracy.richardson import richardson
from reference_lcp.chain.harmonic import PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import FEWEST_STEPS_PER_PERIOD, Lane
from reference_lcp.observables.stick_slip import stuck_fraction
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.steady.orbits import DEFAULT_PERIODS, DEFAULT_RESIDUAL, PeriodicOrbit, periodic_orbits
from reference_lcp.stepping.euler_compiled import CompiledSimulation
from reference_lcp.validation import FloatArray, checked_count

REFINEMENTS = (1, 2, 4)
"""Numbers of steps that are compared, over the fewest of them."""


@dataclass(frozen=True)
class ErrorBar:
    """Discretisation error of a steady state.

    Parameters
    ----------
    transmittance_db
        The true transmittance lies within this distance of the computed one [dB]; NaN where a finer
        step found no steady state.
    stuck_fraction
        The same for the stuck fraction of each contact, shape (n,).
    order
        Order measured over three step sizes; NaN where differences vanish. Far from one, the steps are
        too coarse for the motion, or a grazing contact changes its mode between them.
    extrapolated_db
        Transmittance extrapolated to Δt → 0 from the two finest steps [dB].
    steps_per_period
        The step numbers that were compared.
    """

    transmittance_db: float
    stuck_fraction: FloatArray
    order: float
    extrapolated_db: float
    steps_per_period: tuple[int, ...]

    def as_dict(self) -> dict[str, Any]:
        """Give the numbers, ready for JSON; what is not known is ``None``."""
        return {
            "error_bar_db": _known(self.transmittance_db),
            "error_bar_stuck_fraction": self.stuck_fraction.tolist(),
            "order": _known(self.order),
            "extrapolated_db": _known(self.extrapolated_db),
        }


def measured_error_bar(
    chain: Chain,
    drive: PeriodicDrive,
    steps_per_period: int,
    *,
    tolerance: float = DEFAULT_RESIDUAL,
    max_periods: int = DEFAULT_PERIODS,
) -> ErrorBar:
    """Measure the discretisation error of the Euler scheme at `steps_per_period`.

    The bar is `richardson`'s, from the steps Δt, Δt/2 and Δt/4; that of a stuck fraction has one step of resolution
    besides.

    Parameters
    ----------
    chain, drive
        What moves, and what moves it.
    steps_per_period
        Steps of the result whose error is measured.
    tolerance, max_periods
        As for `periodic_orbits`.

    Raises
    ------
    ParameterError
        If an argument is outside its range.
    """
    checked_count("steps_per_period", steps_per_period, FEWEST_STEPS_PER_PERIOD)
    steps = tuple(steps_per_period * factor for factor in REFINEMENTS)
    orbits = [euler_orbit(chain, drive, count, tolerance, max_periods) for count in steps]
    values = np.array([decibel(transmittance(orbit)) if orbit.converged else np.nan for orbit in orbits])
    stuck = np.array([stuck_fraction(orbit) for orbit in orbits])
    transmittance_error = richardson(steps, values, at=steps_per_period)
    return ErrorBar(
        transmittance_db=float(transmittance_error.error),
        stuck_fraction=richardson(steps, stuck, at=steps_per_period).error + 1 / steps_per_period,
        order=transmittance_error.order,
        extrapolated_db=float(transmittance_error.extrapolated),
        steps_per_period=steps,
    )


def euler_orbit(
    chain: Chain,
    drive: PeriodicDrive,
    steps: int,
    tolerance: float = DEFAULT_RESIDUAL,
    max_periods: int = DEFAULT_PERIODS,
) -> PeriodicOrbit:
    """Find the periodic orbit of the compiled Euler scheme with so many steps a period; see `periodic_orbits`."""
    simulation = CompiledSimulation([Lane.periodic(chain, drive, steps)])
    return periodic_orbits(simulation, steps, tolerance=tolerance, max_periods=max_periods)[0]


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value
