"""Limits of axes, from the data: none so narrow that noise fills it, none so wide that differences are lost."""

import math
from collections.abc import Iterable

import numpy as np

from reference_lcp.validation import FloatArray

STEP_DB = 10.0
"""Ends of axes of levels are multiples of this [dB]: two runs with levels that are all but equal have one axis."""

LEAST_DB = 20.0
"""Of an axis of levels [dB], a factor of ten in amplitude: a flat curve stays flat."""

MOST_DB = 120.0
"""Of an axis of levels [dB], down from the highest: a panel is some 120 points high, and 1 dB, 12 % of an amplitude, is
to be a point of it. Deeper levels lie below the axis."""

LEAST_DECADES = 2
"""Of a logarithmic axis of errors, whose ends are powers of ten: three labels stand on it, and a difference of a tenth
is a fiftieth of it, so that errors that are equal but for noise look equal."""


def level_limits(levels: Iterable[float], line: float | None = None) -> tuple[float, float]:
    """Give the ends of an axis of levels [dB]; a line across it lies inside where no level is lost by that."""
    known = _finite(levels)
    if not known.size:
        return -LEAST_DB, 0.0
    if line is not None and np.ptp([*known, line]) <= MOST_DB:
        known = np.append(known, line)
    low, high = STEP_DB * math.floor(known.min() / STEP_DB), STEP_DB * math.ceil(known.max() / STEP_DB)
    high = max(high, low + LEAST_DB)
    return max(low, high - MOST_DB), high


def decade_limits(sizes: Iterable[float], least: float) -> tuple[float, float]:
    """Give the ends of a logarithmic axis of errors, of which those below `least` lie at its beginning."""
    known = np.maximum(_finite(sizes), least)
    if not known.size:
        known = np.array([least])
    # a power of ten itself is one: its logarithm may be off by round-off
    low, high = math.floor(np.log10(known.min()) + 1e-9), math.ceil(np.log10(known.max()) - 1e-9)
    return 10.0**low, 10.0 ** max(high, low + LEAST_DECADES)


def _finite(values: Iterable[float]) -> FloatArray:
    every = np.asarray(list(values), dtype=float)
    return every[np.isfinite(every)]
