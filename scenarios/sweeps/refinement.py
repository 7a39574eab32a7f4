"""Points where a curve needs them: propose points from the results, evaluate, add, until nothing is proposed."""

import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
import scipy.linalg

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.sweeps.adaptive_grid import AdaptiveCurve
from multibody_xval.scenarios.sweeps.attenuation_band import unresolved
from multibody_xval.scenarios.sweeps.point import GivesResults
from multibody_xval.scenarios.sweeps.sweep import Case, GridPoint, Sweep
from reference_lcp.chain.linear_response import stuck_basis
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.validation import FloatArray


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


Results = Mapping[GridPoint, Result]

Propose = Callable[[Results], Sequence[GridPoint]]
"""Gives the points that results still need; none when they are done."""

CurveKey = tuple[Variant, Case]

EDGE_RESIDUAL = 1e-3
"""Periodicity residual up to which a motion decides on which side of an edge its frequency is.

An engine whose period map jumps (a bristle that sticks at the end of a step only) may come no closer
than some 1e-4 of the base's motion. At the edge the response is as large as that motion, and curves
fall by more than 10 dB in 0.1: what such a residual leaves open is below the resolution of the edge.
"""


def refined(
    sweep: Sweep, points: Sequence[GridPoint], propose: Propose, evaluator: GivesResults
) -> dict[GridPoint, Result]:
    """Give the results at `points`, and at all points that are proposed from the results so far.

    What is added depends on nothing but the results: the same ones lead to the same points.
    """
    results: dict[GridPoint, Result] = {}
    while points:
        results |= zip(points, evaluator.evaluate([sweep.task(*point) for point in points]), strict=True)
        points = propose(results)
    return results


def curves_of(results: Results) -> dict[CurveKey, tuple[FloatArray, FloatArray]]:
    """Give η_r, ascending, and the transmittance [dB] of every curve, by variant and case; NaN where inconclusive."""
    pairs: dict[CurveKey, list[tuple[float, float]]] = defaultdict(list)
    for (variant, case, eta), result in results.items():
        pairs[variant, case].append((eta, decided_db(result)))
    return {key: tuple(np.array(sorted(own)).T) for key, own in pairs.items()}


def decided_db(result: Result) -> float:
    """Transmittance of a steady state, or of one so close that it decides an edge [dB]; NaN where there is none."""
    return result.transmittance_db if result.converged or result.residual <= EDGE_RESIDUAL else math.nan


def for_the_band(sweep: Sweep) -> Propose:
    """Propose points until no curve runs so close to the threshold that a crossing could hide between them."""

    def propose(results: Results) -> list[GridPoint]:
        return [
            (*key, eta)
            for key, curve in curves_of(results).items()
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

    def __call__(self, results: Results) -> list[GridPoint]:
        """Take the results of what was due, and give what is due next."""
        for key, curve in self.curves.items():
            if curve.due:
                due = {eta: results[*key, eta] for eta in curve.due}
                curve.add({eta: own.transmittance_db if own.converged else math.nan for eta, own in due.items()})
        return self.due()


def chosen_frequencies(sweep: Sweep, evaluator: GivesResults) -> dict[Case, list[float]]:
    """Give the frequency ratios of every case: those of the sweep, or those of all curves on an adaptive axis."""
    if sweep.frequencies is None:
        return {case: sorted(sweep.frequency_ratios) for case in sweep.cases}
    accuracy = ForTheAccuracy(sweep)
    return frequencies_of(refined(sweep, accuracy.due(), accuracy, evaluator))


def frequencies_of(points: Iterable[GridPoint]) -> dict[Case, list[float]]:
    """Give the frequency ratios of every case, ascending."""
    etas: dict[Case, set[float]] = {}
    for _, case, eta in points:
        etas.setdefault(case, set()).add(eta)
    return {case: sorted(own) for case, own in etas.items()}
