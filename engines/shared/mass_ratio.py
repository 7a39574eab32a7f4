"""Engines of single precision whose inner masses hang in the outer ones."""

from collections.abc import Sequence

import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.refusal import ParameterError


def check_mass_ratio(lanes: Sequence[Lane], largest: float, title: str) -> None:
    """Refuse chains whose outer masses single precision loses beside the inner ones.

    Raises
    ------
    ParameterError
        If an inner mass is more than `largest` times its outer one.
    """
    ratio = max(float(np.max(lane.chain.inner_mass / lane.chain.outer_mass)) for lane in lanes)
    if ratio > largest:
        raise ParameterError(
            f"inner mass over outer mass = {ratio:g}; allowed: at most {largest:g} in {title}, of single precision"
        )
