"""Figure 3 of the paper: transmittance of the 7-cell chain for several friction ratios, by every engine.

It is the sweep over friction and frequency ratio in which every variant is compared with the reference; see
`multibody_xval.scenarios.sweeps.compared`. Here are its grids.
"""

from collections.abc import Sequence

import numpy as np

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.parameters import ChainRatios, Excitation
from multibody_xval.scenarios.sweeps.refinement import free_resonances, resonances
from multibody_xval.scenarios.sweeps.sweep import Sweep
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray, checked_array

FRICTION_RATIOS = (0.0, 0.1, 0.3, 0.6, 1.0, 5.0)
QUICK_FRICTION_RATIOS = (0.0, 0.3, 1.0)


def figure3(
    variants: Sequence[Variant] = (),
    friction_ratios: Sequence[float] = FRICTION_RATIOS,
    frequency_ratios: Sequence[float] | None = None,
    *,
    ratios: ChainRatios | None = None,
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD,
    excitation: Excitation | None = None,
) -> Sweep:
    """Give the sweep of Figure 3 with the reference and its converged preset; grids are ascending."""
    chain = ratios or ChainRatios()
    etas = default_frequency_ratios(chain) if frequency_ratios is None else frequency_ratios
    _check_grid("friction_ratios", friction_ratios, ">= 0")
    _check_grid("frequency_ratios", etas, "> 0")
    return Sweep(
        variants=(REFERENCE, *variants),
        axes={"friction_ratio": tuple(friction_ratios), "frequency_ratio": tuple(etas)},
        ratios=chain,
        steps_per_period=steps_per_period,
        excitation=excitation or Excitation(),
    ).with_reference()


def default_frequency_ratios(ratios: ChainRatios) -> tuple[float, ...]:
    """0.1 to 3: every twentieth where bands begin and end, every tenth elsewhere, and all resonances."""
    uniform = np.concatenate([np.arange(0.1, 0.5, 0.1), np.arange(0.5, 1.6, 0.05), np.arange(1.6, 3.05, 0.1)])
    return _grid(uniform, resonances(ratios))


def quick_frequency_ratios(ratios: ChainRatios) -> tuple[float, ...]:
    """A few points around the band, and the resonances next to the frictionless one.

    They are the two highest of the lower branch, in which both masses of a cell move alike (the
    last one may be too weak to reach the threshold), and the lowest of the upper branch.
    """
    cells = ratios.cells
    uniform = np.array([0.3, 0.62, 0.7, 0.8, 0.9, 1.0, 1.1, 1.3, 1.6])
    return _grid(uniform, free_resonances(ratios)[max(cells - 2, 0) : cells + 1])


def claim_frequency_ratios(ratios: ChainRatios) -> tuple[float, ...]:
    """The fewest points of the default grid on which the edges of all friction ratios are found: all resonances."""
    return _grid(np.array([0.3, 0.65, 0.8, 0.9, 1.0, 1.1, 1.2, 1.6, 2.1, 2.5, 3.0]), resonances(ratios))


def _grid(uniform: FloatArray, peaks: FloatArray) -> tuple[float, ...]:
    inside = peaks[(peaks > uniform.min()) & (peaks < uniform.max())]
    return tuple(float(eta) for eta in np.unique(np.round(np.concatenate([uniform, inside]), 4)))


def _check_grid(name: str, values: Sequence[float], requirement: str) -> None:
    """Refuse a grid that is empty, not ascending or outside its range."""
    array = checked_array(name, values, requirement)
    if array.size == 0 or np.any(np.diff(array) <= 0):
        raise ParameterError(f"{name} = {list(values)}; allowed: at least one value, ascending, {requirement}")
