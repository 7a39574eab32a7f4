"""Distance of a number from its limit for ever finer steps, and what residual and round-off leave open of it.

This is the one error estimate of the suite. A number that is computed with n steps a period is
v(n) = v* + c / n + d / n² + …, for a scheme of first order. Several estimates of its error |v(n) − v*| are made, and
the largest counts, times `SAFETY`:

- of every two neighbouring numbers of steps a < b, the first-order part alone: |v(a) − v(b)| / (1/a − 1/b) / n;
- of every three neighbours that n is one of, both parts: |v(n) − p(0)|, p being the parabola through the three in 1/n;
- of the finest of three or more, the sum of the parts of the last two pairs: nothing finer stands beside it, and where
  contacts stick and slip between the steps, c depends on where.

One difference may vanish by chance where the error does not.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

SAFETY = 1.25
"""Factor on the error that the differences of steps show.

Of 500 random chains with three step sizes, bars 1.25 times smaller cover the true error of the transmittance of the
coarsest, the middle and the finest step in 99, 97 and 97 %, these in 99.6, 98.7 and 98.7 %; two step sizes alone cover
that of the finer one in 82 and 87 %. A test of error bars holds 100 of them
against the exact motion.
"""

ROUND_OFF = 1e-12
"""Round-off of positions over the displacement scale after `ROUND_OFF_STEPS`; it grows as the root of their number."""

ROUND_OFF_STEPS = 40 * 400
"""Steps for which a round-off is stated."""


@dataclass(frozen=True)
class Estimate:
    """A number at one number of steps, and how far it is from the limit for ever finer ones."""

    value: FloatArray
    error: FloatArray
    """Estimated largest |value − limit|, >= 0."""
    order: FloatArray
    """Of the last three values; NaN unless their steps grow by one factor and the differences are not zero."""
    extrapolated: FloatArray
    """Limit of the first-order part, from the two finest steps."""


def richardson(
    steps: Sequence[int], values: Sequence[float] | Sequence[FloatArray] | FloatArray, at: int | None = None
) -> Estimate:
    """Estimate the error of the value `at` some number of steps, the finest by default, from values by ascending steps.

    Values are numbers or arrays of one shape, and so are the results; NaN leaves the error unknown.
    """
    array = np.asarray(values, dtype=np.float64)
    place = _checked_place(steps, array.shape[0], at)
    sizes = [1 / count for count in steps]
    finest = (array[-1] - array[-2]) * sizes[-1] / (sizes[-2] - sizes[-1])
    return Estimate(
        value=array[place],
        error=SAFETY * np.max(_errors(sizes, array, place), axis=0),
        order=_order(np.asarray(steps, dtype=np.float64), array),
        extrapolated=array[-1] + finest,
    )


@lru_cache(maxsize=100_000)
def richardson_error(steps: tuple[int, ...], values: tuple[float, ...], at: int | None = None) -> float:
    """Give the error that `richardson` estimates of a number, fast, and at once where it was asked for before."""
    place = _checked_place(steps, len(values), at)
    if any(map(math.isnan, values)):
        return math.nan
    return SAFETY * max(_errors([1 / count for count in steps], values, place))


def _checked_place(steps: Sequence[int], count: int, at: int | None) -> int:
    if len(steps) < 2 or any(a >= b for a, b in pairwise(steps)) or steps[0] <= 0 or len(steps) != count:
        raise ParameterError(
            f"steps = {list(steps)} with {count} values; allowed: two at least, ascending, a value for each"
        )
    if at is not None and at not in steps:
        raise ParameterError(f"at = {at}; allowed: one of {list(steps)}")
    return len(steps) - 1 if at is None else list(steps).index(at)


def _errors(sizes: Sequence[float], values: Any, place: int) -> list[Any]:
    """Give all estimates of the error at a place, of numbers or of arrays."""
    errors = [
        abs(later - earlier) / (a - b) * sizes[place]
        for (a, b), (earlier, later) in zip(pairwise(sizes), pairwise(values), strict=True)
    ]
    if place == len(sizes) - 1:
        errors.append(sum(errors[-2:]))
    for first in range(max(place - 2, 0), min(place, len(sizes) - 3) + 1):
        a, b, c = sizes[first : first + 3]
        at_zero = (
            values[first] * (b * c / ((b - a) * (c - a)))
            + values[first + 1] * (a * c / ((a - b) * (c - b)))
            + values[first + 2] * (a * b / ((a - c) * (b - c)))
        )
        errors.append(abs(values[place] - at_zero))
    return errors


def _order(counts: FloatArray, values: FloatArray) -> FloatArray:
    unknown = np.full(values.shape[1:], np.nan)
    if counts.size < 3 or not math.isclose(counts[-2] ** 2, counts[-1] * counts[-3]):
        return unknown
    coarse, fine = np.abs(np.diff(values[-3:], axis=0))
    shown = (coarse > 0) & (fine > 0)
    return np.log(np.divide(coarse, fine, where=shown, out=unknown)) / math.log(counts[-1] / counts[-2])


def unresolved_amplitude(
    residual: float, amplification: float, steps: int, transmittance_db: float, round_off: float = ROUND_OFF
) -> float:
    """How far, over the displacement scale, an amplitude may be from that of the steady state of its own scheme.

    A motion that repeats to its residual is up to `amplification` times that from its steady state. Round-off grows
    with the motion, at least as large as the base's, and with the root of the number of steps that were simulated.
    """
    motion = max(1.0, 10 ** (transmittance_db / 20))
    return residual * amplification + round_off * math.sqrt(steps / ROUND_OFF_STEPS) * motion


def amplitude_in_db(amplitude: float, transmittance_db: float) -> float:
    """What a change of amplitude, over the displacement scale, makes of a transmittance [dB]; −inf if none is left."""
    change = amplitude * 10 ** (-transmittance_db / 20)
    return -math.inf if change <= -1 else 20 * math.log10(1 + change)
