"""Points where a curve needs them: propose points from the table, evaluate, add, until nothing is proposed."""

import math
from collections import defaultdict
from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd
import scipy.linalg

from engines.interface.variant import Variant
from reference_lcp.chain.linear_response import stuck_basis
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.validation import FloatArray
from scenarios.runs.parameters import ChainRatios
from scenarios.runs.result import Result
from scenarios.sweeps.adaptive_grid import AdaptiveCurve
from scenarios.sweeps.attenuation_band import unresolved
from scenarios.sweeps.sweep import Case, Sweep
from scenarios.sweeps.table import GivesResults, GridPoint, grid_points_of, table_of, with_columns


def resonances(ratios: ChainRatios) -> FloatArray:
    """Natural frequencies over ω_r of the chain with free and with stuck contacts, ascending.

    Between them, the transmittance of every friction ratio is smooth; narrow peaks are at them.
    """
    chain = ratios.chain(0.0)
    return np.sort(np.concatenate([free_resonances(ratios), _in_subspace(chain, stuck_basis(chain))]))


def free_resonances(ratios: ChainRatios) -> FloatArray:
    """Natural frequencies over ω_r of the chain without friction, ascending; shape (2n,)."""
    chain = ratios.chain(0.0)
    return _in_subspace(chain, np.eye(2 * chain.cells))


def _in_subspace(chain: Chain, basis: FloatArray) -> FloatArray:
    """Natural frequencies over ω_r in the subspace of `basis`, ascending."""
    stiffness, mass = (basis.T @ matrix @ basis for matrix in (chain.stiffness_matrix, chain.mass_matrix))
    return np.sqrt(scipy.linalg.eigh(stiffness, mass, eigvals_only=True)) / chain.resonator_frequency


Propose = Callable[[pd.DataFrame], Sequence[GridPoint]]
"""Gives the points that a table still needs; none when it is done."""

CurveKey = tuple[Variant, Case]

EDGE_RESIDUAL = 1e-3
"""Periodicity residual up to which a motion decides on which side of an edge its frequency is.

An engine whose period map jumps (a bristle that sticks at the end of a step only) may come no closer
than some 1e-4 of the base's motion. At the edge the response is as large as that motion, and curves
fall by more than 10 dB in 0.1: what such a residual leaves open is below the resolution of the edge.
"""


def refined(sweep: Sweep, points: Sequence[GridPoint], propose: Propose, evaluator: GivesResults) -> pd.DataFrame:
    """Give the results at `points`, and at all points that are proposed from the results so far.

    What is added depends on nothing but the results: the same ones lead to the same points.
    """
    table = table_of(())
    while points:
        results = evaluator.evaluate([sweep.task(*point) for point in points])
        added = with_columns(table_of(points), result=results)
        table = added if table.empty else pd.concat([table, added], ignore_index=True)
        points = propose(table)
    return table


def curves_of(table: pd.DataFrame) -> dict[CurveKey, tuple[FloatArray, FloatArray]]:
    """Give η_r, ascending, and the transmittance [dB] of every curve, by variant and case; NaN where undecided."""
    pairs: dict[CurveKey, list[tuple[float, float]]] = defaultdict(list)
    for (variant, case, eta), result in zip(grid_points_of(table), table["result"], strict=True):
        pairs[variant, case].append((eta, decided_db(result)))
    return {key: tuple(np.array(sorted(own)).T) for key, own in pairs.items()}


def decided_db(result: Result) -> float:
    """Transmittance of a steady state, or of one so close that it decides an edge [dB]; NaN where there is none."""
    return result.transmittance_db if result.converged or result.residual <= EDGE_RESIDUAL else math.nan


def for_the_band(sweep: Sweep) -> Propose:
    """Propose points until no curve runs so close to the threshold that a crossing could hide between them."""

    def propose(table: pd.DataFrame) -> list[GridPoint]:
        return [
            (*key, eta)
            for key, curve in curves_of(table).items()
            for eta in np.setdiff1d(unresolved(*curve, sweep.band), curve[0]).tolist()
        ]

    return propose


class ForTheAccuracy:
    """Proposes points until every curve can be interpolated with the accuracy of an adaptive axis."""

    def __init__(self, sweep: Sweep):
        assert sweep.frequencies is not None
        axis = sweep.frequencies
        peaks = {case: resonances(sweep.ratios_of(case)).tolist() for case in sweep.cases}
        self.curves = {(v, case): AdaptiveCurve(axis, peaks[case]) for v in sweep.variants for case in sweep.cases}

    def due(self) -> list[GridPoint]:
        """Give the points that the curves need now."""
        return [(*key, eta) for key, curve in self.curves.items() for eta in curve.due]

    def __call__(self, table: pd.DataFrame) -> list[GridPoint]:
        """Take the results of what was due, and give what is due next."""
        levels: dict[CurveKey, dict[float, float]] = defaultdict(dict)
        for (variant, case, eta), result in zip(grid_points_of(table), table["result"], strict=True):
            levels[variant, case][eta] = result.transmittance_db if result.converged else math.nan
        for key, curve in self.curves.items():
            if curve.due:
                curve.add({eta: levels[key][eta] for eta in curve.due})
        return self.due()


def chosen_frequencies(sweep: Sweep, evaluator: GivesResults) -> dict[Case, list[float]]:
    """Give the frequency ratios of every case: those of the sweep, or those of all curves on an adaptive axis."""
    if sweep.frequencies is None:
        return {case: sorted(sweep.frequency_ratios) for case in sweep.cases}
    accuracy = ForTheAccuracy(sweep)
    return frequencies_of(refined(sweep, accuracy.due(), accuracy, evaluator))


def frequencies_of(table: pd.DataFrame) -> dict[Case, list[float]]:
    """Give the frequency ratios of every case of a table, ascending."""
    etas: dict[Case, set[float]] = {}
    for _, case, eta in grid_points_of(table):
        etas.setdefault(case, set()).add(eta)
    return {case: sorted(own) for case, own in etas.items()}
