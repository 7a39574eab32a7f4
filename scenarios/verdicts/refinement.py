"""How far a number is from its limit for ever finer steps, from three step sizes."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from reference_lcp.accuracy.error_bar import REFINEMENTS
from reference_lcp.validation import FloatArray, ParameterError
from scenarios.verdicts.verdict import SAFETY

__all__ = ["REFINEMENTS", "error_of_finest"]


def error_of_finest(values: Sequence[FloatArray | float]) -> float:
    """Estimate the error of the last of three values, with steps Δt, Δt/2 and Δt/4, of a first-order scheme.

    Its errors are 4e, 2e and e, so that the neighbours' differences are 2e and e. Where contacts stick and slip,
    e depends on where the events fall between the steps, and one difference may be small by chance: both
    estimates of e are added, times `SAFETY`.

    Parameters
    ----------
    values
        Three numbers, or three arrays of one shape, whose largest difference counts.

    Raises
    ------
    ParameterError
        If there are not three.
    """
    if len(values) != len(REFINEMENTS):
        raise ParameterError(f"{len(values)} step sizes; allowed: {len(REFINEMENTS)}")
    coarse, fine = (float(np.max(np.abs(np.subtract(b, a)))) for a, b in pairwise(values))
    return SAFETY * (coarse / 2 + fine)
