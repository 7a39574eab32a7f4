"""Transmittance over friction and frequency: where the attenuation band is, and how it moves with friction."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reference_lcp.validation import FloatArray
from scenarios.execution.evaluator import Evaluator
from scenarios.studies.attenuation_band import Edge, edge_brackets, interpolated_crossing, unresolved
from scenarios.studies.figure3 import REFERENCE, Figure3
from scenarios.tasks.result import Result

MAP_FRICTION_RATIOS = tuple(float(ratio) for ratio in np.round(np.arange(0, 1.501, 0.05), 2))
MAP_FREQUENCY_RATIOS = tuple(float(ratio) for ratio in np.round(np.arange(0.3, 1.801, 0.02), 2))
QUICK_MAP_FRICTION_RATIOS = tuple(float(ratio) for ratio in np.round(np.arange(0, 1.501, 0.1), 2))
QUICK_MAP_FREQUENCY_RATIOS = tuple(float(ratio) for ratio in np.round(np.arange(0.3, 1.601, 0.025), 3))


@dataclass(frozen=True)
class FrictionMap:
    """Transmittance of the reference over a grid.

    Parameters
    ----------
    friction_ratios, frequency_ratios
        The grid, ascending.
    transmittance_db
        Transmittance [dB], shape (friction ratios, frequency ratios); NaN where there is no steady state.
    lower, upper
        Edges of the attenuation band at each friction ratio, between grid points by interpolation of the
        transmittance in dB; NaN where the grid does not hold them.
    """

    friction_ratios: FloatArray
    frequency_ratios: FloatArray
    transmittance_db: FloatArray
    lower: FloatArray
    upper: FloatArray

    @property
    def known(self) -> int:
        """Number of points with a steady state."""
        return int(np.count_nonzero(np.isfinite(self.transmittance_db)))


def friction_map(
    asked: Figure3, friction_ratios: Sequence[float], frequency_ratios: Sequence[float], evaluator: Evaluator
) -> FrictionMap:
    """Ask the reference, at the common time step, about a grid for the chain and the band of `asked`.

    Where a curve runs close to the threshold, more points are asked for its edges' sake, as for Figure 3.
    """
    questions = [asked.question(REFERENCE, friction, eta) for friction in friction_ratios for eta in frequency_ratios]
    values = [_decibel(answer) for answer in evaluator.evaluate(questions)]
    curves = np.reshape(values, (len(friction_ratios), len(frequency_ratios)))
    eta = np.array(frequency_ratios)
    known = {friction: (eta, curve) for friction, curve in zip(friction_ratios, curves, strict=True)}
    _resolve(asked, known, evaluator)
    edges = {edge: np.array([_edge(asked, *one, edge) for one in known.values()]) for edge in Edge}
    return FrictionMap(np.array(friction_ratios), eta, curves, edges[Edge.LOWER], edges[Edge.UPPER])


def _resolve(asked: Figure3, known: dict[float, tuple[FloatArray, FloatArray]], evaluator: Evaluator) -> None:
    """Add points to the curves, in place, until none of them could hide a crossing; all curves together."""
    refused: set[tuple[float, float]] = set()
    while True:
        wanted = [
            (friction, float(eta))
            for friction, curve in known.items()
            for eta in unresolved(*curve, asked.band)
            if (friction, float(eta)) not in refused
        ]
        if not wanted:
            return
        answers = evaluator.evaluate([asked.question(REFERENCE, *place) for place in wanted])
        for (friction, eta), answer in zip(wanted, answers, strict=True):
            if not answer.converged:
                refused.add((friction, eta))
                continue
            etas, curve = known[friction]
            at = int(np.searchsorted(etas, eta))
            known[friction] = np.insert(etas, at, eta), np.insert(curve, at, answer.transmittance_db)


def _decibel(answer: Result) -> float:
    return answer.transmittance_db if answer.converged else math.nan


def _edge(asked: Figure3, eta: FloatArray, curve: FloatArray, edge: Edge) -> float:
    """Place one edge of one curve."""
    bracket = edge_brackets(eta, curve, asked.band).get(edge)
    if bracket is None:
        return math.nan
    left, right = (float(curve[np.searchsorted(eta, one)]) - asked.band.threshold_db for one in bracket)
    return float(interpolated_crossing(*np.array([*bracket, left, right])))
