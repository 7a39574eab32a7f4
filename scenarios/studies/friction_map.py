"""Transmittance over friction and frequency: where the attenuation band is, and how it moves with friction."""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from multibody_xval.scenarios.sweeps.attenuation_band import Edge
from multibody_xval.scenarios.sweeps.edges import refined_edges
from multibody_xval.scenarios.sweeps.point import GivesResults
from multibody_xval.scenarios.sweeps.refinement import for_the_band, refined
from multibody_xval.scenarios.sweeps.sweep import Sweep
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from reference_lcp.validation import FloatArray

MAP_FRICTION_RATIOS = tuple(float(ratio) for ratio in np.round(np.arange(0, 1.501, 0.05), 2))
MAP_FREQUENCY_RATIOS = tuple(float(ratio) for ratio in np.round(np.arange(0.3, 1.801, 0.02), 2))
QUICK_MAP_FRICTION_RATIOS = tuple(float(ratio) for ratio in np.round(np.arange(0, 1.501, 0.1), 2))
QUICK_MAP_FREQUENCY_RATIOS = tuple(float(ratio) for ratio in np.round(np.arange(0.3, 1.601, 0.025), 3))


@dataclass(frozen=True)
class FrictionMap:
    """Transmittance of the reference over a grid."""

    friction_ratios: FloatArray
    frequency_ratios: FloatArray
    transmittance_db: FloatArray
    """Transmittance [dB], shape (friction ratios, frequency ratios); NaN where there is no steady state."""
    lower: FloatArray
    upper: FloatArray
    """Edges of the attenuation band at each friction ratio, see `refined_edges`; NaN where the grid does not hold
    them."""

    @property
    def known(self) -> int:
        """Number of points with a steady state."""
        return int(np.count_nonzero(np.isfinite(self.transmittance_db)))


def map_sweep(sweep: Sweep, friction_ratios: Sequence[float], frequency_ratios: Sequence[float]) -> Sweep:
    """Give the sweep of the reference, at the common time step, for the chain, the drive and the band of another."""
    axes = {"friction_ratio": tuple(friction_ratios), "frequency_ratio": tuple(frequency_ratios)}
    return dataclasses.replace(sweep, variants=(REFERENCE,), axes=axes, frequencies=None, tolerance=None)


def friction_map(sweep: Sweep, evaluator: GivesResults) -> FrictionMap:
    """Evaluate a `map_sweep`; where a curve runs close to the threshold, it gets more points for its edges' sake."""
    results = refined(sweep, list(sweep.grid_points()), for_the_band(sweep), evaluator)
    grid = [results[place] for place in sweep.grid_points()]
    levels = [result.transmittance_db if result.converged else math.nan for result in grid]
    crossings = refined_edges(sweep, results, evaluator).crossings
    lower, upper = (
        np.array([getattr(crossings.get((REFERENCE, case, edge)), "frequency_ratio", math.nan) for case in sweep.cases])
        for edge in Edge
    )
    return FrictionMap(
        friction_ratios=np.array(sweep.axes["friction_ratio"]),
        frequency_ratios=np.array(sweep.frequency_ratios),
        transmittance_db=np.reshape(levels, (len(sweep.cases), len(sweep.frequency_ratios))),
        lower=lower,
        upper=upper,
    )
