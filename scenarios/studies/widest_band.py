"""The friction ratio at which the attenuation band begins lowest, with its error.

The lower edge is no smooth function of friction: peaks of the curve fall below the threshold one after the other, and
it may have several minima that are nearly as low. So it is searched on grids, a coarse and a fine one.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.validation import FloatArray
from scenarios.runs.parameters import ChainRatios
from scenarios.studies.figure3 import figure3
from scenarios.studies.friction_map import friction_map, map_sweep
from scenarios.sweeps.point import GivesResults
from scenarios.tables import Column

COARSE_STEP, FINE_STEP = 0.01, 0.001
"""Between friction ratios."""

COARSE_FRICTION_RATIOS = np.round(np.arange(0.1, 0.6 + COARSE_STEP / 2, COARSE_STEP), 2)

MARGIN = 1e-3
"""Of the edge in η_r, by which a coarse friction ratio may be higher than the lowest and is still searched beside: the
edge changes by less than that between two of the fine grid, where it does not jump."""

FREQUENCY_RATIOS = tuple(
    float(eta)
    for eta in np.round(np.concatenate([np.arange(0.5, 0.6575, 0.005), np.arange(0.66, 0.9, 0.02), [1.0, 1.1, 1.3]]), 4)
)
"""Fine where the lowest edges are, so that no peak above the threshold is missed, and on to deep attenuation."""


@dataclass(frozen=True)
class WidestBand:
    """Where the band of one chain begins lowest."""

    damping_ratio: float
    friction_ratio: float
    """At which the lower edge is lowest."""
    lowest: float
    highest: float
    """Ends of the friction ratios whose edges are as low, to the error of an edge; a step of the grid is added."""
    flat_from: float
    flat_to: float
    """Ends of the friction ratios whose edges are higher by no more than `MARGIN`."""
    edge: float
    """The lower edge there [η_r], for a time step of zero."""
    edge_error: float
    """What halving the time step changes of it."""


class _Edges(NamedTuple):
    friction: FloatArray
    edge: FloatArray
    error: FloatArray


def widest_band(damping_ratio: float, evaluator: GivesResults) -> WidestBand:
    """Search it for the paper's chain with a damping ratio ζ, by the reference."""
    coarse = _lower_edges(COARSE_FRICTION_RATIOS, damping_ratio, MINIMUM_STEPS_PER_PERIOD, evaluator)
    near = COARSE_FRICTION_RATIOS[coarse <= np.nanmin(coarse) + MARGIN]
    offsets = np.linspace(-COARSE_STEP, COARSE_STEP, 1 + round(2 * COARSE_STEP / FINE_STEP))
    fine = _extrapolated(np.unique(np.round(np.add.outer(near, offsets), 4)), damping_ratio, evaluator)
    best = int(np.nanargmin(fine.edge))
    as_low = fine.friction[fine.edge <= fine.edge[best] + fine.error[best]]
    flat = fine.friction[fine.edge <= fine.edge[best] + MARGIN]
    return WidestBand(
        damping_ratio,
        float(fine.friction[best]),
        float(as_low.min() - FINE_STEP),
        float(as_low.max() + FINE_STEP),
        float(flat.min()),
        float(flat.max()),
        float(fine.edge[best]),
        float(fine.error[best]),
    )


def _extrapolated(friction: FloatArray, damping_ratio: float, evaluator: GivesResults) -> _Edges:
    """Extrapolate edges to a time step of zero: the scheme is of first order."""
    coarse, fine = (
        _lower_edges(friction, damping_ratio, factor * MINIMUM_STEPS_PER_PERIOD, evaluator) for factor in (1, 2)
    )
    return _Edges(friction, 2 * fine - coarse, np.abs(fine - coarse))


def _lower_edges(friction: FloatArray, damping_ratio: float, steps: int, evaluator: GivesResults) -> FloatArray:
    """Give the lower edges of the reference [η_r] at these friction ratios."""
    sweep = figure3(ratios=ChainRatios(damping_ratio=damping_ratio), steps_per_period=steps)
    return friction_map(map_sweep(sweep, friction.tolist(), FREQUENCY_RATIOS), evaluator).lower


WIDEST_COLUMNS: tuple[Column[WidestBand], ...] = (
    Column("ζ", lambda row: row.damping_ratio, pattern="{:g}"),
    Column("friction ratio", lambda row: row.friction_ratio, pattern="{:.3f}"),
    Column("as low from", lambda row: row.lowest, pattern="{:.3f}"),
    Column("as low to", lambda row: row.highest, pattern="{:.3f}"),
    Column("within 0.001 from", lambda row: row.flat_from, pattern="{:.3f}"),
    Column("within 0.001 to", lambda row: row.flat_to, pattern="{:.3f}"),
    Column("lower edge", lambda row: row.edge, pattern="{:.4f}"),
    Column("its error", lambda row: row.edge_error, pattern="{:.0e}"),
)
