"""What a point of figure 3 costs, and how wrong it is, by the scheme, with its error bar, and by harmonic balance."""

import timeit
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from reference_lcp.accuracy.benchmark import SAMPLES, canonical_lane
from reference_lcp.accuracy.error_bar import measured_error_bars
from reference_lcp.accuracy.multiharmonic_balance import balanced_transmittance
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.step_limits import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.exact.steady import exact_orbit
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.steady.orbits import PeriodicOrbit, periodic_orbits
from reference_lcp.stepping.euler_compiled import CompiledSimulation
from reference_lcp.validation import FloatArray

FRICTION_RATIOS = (0.1, 0.3, 1.0)
FREQUENCY_RATIOS = (0.5, 0.7, 0.9, 1.1, 1.4)


def bench_points(
    friction_ratios: Sequence[float] = FRICTION_RATIOS, frequency_ratios: Sequence[float] = FREQUENCY_RATIOS
) -> list[dict[str, Any]]:
    """Measure cost and error of several methods at the same points, on one core, with compilation left out.

    Returns
    -------
    list of dict
        ``method``; ``seconds_per_point``, best of several samples; ``failed``, points without an answer;
        ``median_error_db`` and ``largest_error_db`` of the others, against the exact steady state; ``median_bar_db``
        and ``covered``, the part of the points whose error is within its bar: ``None`` for methods without one.
    """
    lanes = [canonical_lane(friction, ratio) for friction in friction_ratios for ratio in frequency_ratios]
    begin = timeit.default_timer()
    exact = np.array([decibel(transmittance(exact_orbit(lane.chain, lane.drive)[0])) for lane in lanes])  # type: ignore[arg-type]
    seconds = (timeit.default_timer() - begin) / len(lanes)
    return [
        _measured(f"scheme, {MINIMUM_STEPS_PER_PERIOD} steps", lambda: _levels(lanes), exact),
        _measured("scheme with error bar", lambda: _levels_and_bars(lanes), exact),
        _measured("harmonic balance", lambda: _balanced_levels(lanes), exact),
        _row("exact", seconds, np.zeros(len(lanes)), None),
    ]


def _measured(method: str, work: Callable[[], FloatArray], exact: FloatArray) -> dict[str, Any]:
    """Time a method that gives the level [dB] of every point, and where it has bars, those as a second row."""
    levels, *bars = np.atleast_2d(work())
    seconds = min(timeit.repeat(work, number=1, repeat=SAMPLES)) / len(exact)
    return _row(method, seconds, np.abs(levels - exact), bars[0] if bars else None)


def _row(method: str, seconds: float, errors: FloatArray, bars: FloatArray | None) -> dict[str, Any]:
    return {
        "method": method,
        "seconds_per_point": seconds,
        "failed": int(np.sum(np.isnan(errors))),
        "median_error_db": float(np.nanmedian(errors)),
        "largest_error_db": float(np.nanmax(errors)),
        "median_bar_db": None if bars is None else float(np.median(bars)),
        "covered": None if bars is None else float(np.mean(errors <= bars)),
    }


def _orbits(lanes: Sequence[Lane]) -> list[PeriodicOrbit]:
    """Certified orbits of all lanes at once."""
    return periodic_orbits(CompiledSimulation(lanes), MINIMUM_STEPS_PER_PERIOD)


def _levels(lanes: Sequence[Lane]) -> FloatArray:
    return np.array([decibel(transmittance(orbit)) for orbit in _orbits(lanes)])


def _levels_and_bars(lanes: Sequence[Lane]) -> FloatArray:
    orbits = _orbits(lanes)
    bars = [bar.transmittance_db for bar in measured_error_bars(orbits)]
    return np.array([[decibel(transmittance(orbit)) for orbit in orbits], bars])


def _balanced_levels(lanes: Sequence[Lane]) -> FloatArray:
    return np.array([decibel(balanced_transmittance(lane, MINIMUM_STEPS_PER_PERIOD)) for lane in lanes])
