"""Points where a curve needs them: propose points from the table, evaluate, add, until nothing is proposed."""

import math
from collections import defaultdict
from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from scenarios.sweeps.adaptive_grid import AdaptiveCurve
from scenarios.sweeps.attenuation_band import unresolved
from scenarios.sweeps.resonances import resonances
from scenarios.sweeps.sweep import Case, Sweep
from scenarios.sweeps.table import GivesResults, Place, places_of, table_of, with_columns
from scenarios.tasks.result import Result

Propose = Callable[[pd.DataFrame], Sequence[Place]]
"""Gives the points that a table still needs; none when it is done."""

CurveKey = tuple[Variant, Case]

EDGE_RESIDUAL = 1e-3
"""Periodicity residual up to which a motion decides on which side of an edge its frequency is.

An engine whose period map jumps (a bristle that sticks at the end of a step only) may come no closer
than some 1e-4 of the base's motion. At the edge the response is as large as that motion, and curves
fall by more than 10 dB in 0.1: what such a residual leaves open is below the resolution of the edge.
"""


def refined(sweep: Sweep, places: Sequence[Place], propose: Propose, evaluator: GivesResults) -> pd.DataFrame:
    """Give the results at `places`, and at what is proposed from them, and from those, until nothing is.

    What is added depends on nothing but the results: the same ones lead to the same points.
    """
    table = table_of(())
    while places:
        results = evaluator.evaluate([sweep.task(*place) for place in places])
        added = with_columns(table_of(places), result=results)
        table = added if table.empty else pd.concat([table, added], ignore_index=True)
        places = propose(table)
    return table


def curves_of(table: pd.DataFrame) -> dict[CurveKey, tuple[FloatArray, FloatArray]]:
    """Give η_r, ascending, and the transmittance [dB] of every curve, by variant and case; NaN where undecided."""
    pairs: dict[CurveKey, list[tuple[float, float]]] = defaultdict(list)
    for (variant, case, eta), result in zip(places_of(table), table["result"], strict=True):
        pairs[variant, case].append((eta, decided_db(result)))
    return {key: tuple(np.array(sorted(found)).T) for key, found in pairs.items()}


def decided_db(result: Result) -> float:
    """Transmittance of a steady state, or of one so close that it decides an edge [dB]; NaN where there is none."""
    return result.transmittance_db if result.converged or result.residual <= EDGE_RESIDUAL else math.nan


def for_the_band(sweep: Sweep) -> Propose:
    """Propose points until no curve runs so close to the threshold that a crossing could hide between them."""

    def propose(table: pd.DataFrame) -> list[Place]:
        return [
            (*key, eta)
            for key, curve in curves_of(table).items()
            for eta in np.setdiff1d(unresolved(*curve, sweep.band), curve[0]).tolist()
        ]

    return propose


class ForTheAccuracy:
    """Proposes points until every curve can be interpolated as accurately as an adaptive axis asks.

    Parameters
    ----------
    sweep
        Whose curves, one a variant and case, are to be interpolated.
    """

    def __init__(self, sweep: Sweep):
        assert sweep.frequencies is not None
        axis = sweep.frequencies
        peaks = {case: resonances(sweep.ratios_of(case)).tolist() for case in sweep.cases}
        self.curves = {(v, case): AdaptiveCurve(axis, peaks[case]) for v in sweep.variants for case in sweep.cases}

    def due(self) -> list[Place]:
        """Give the points that the curves need now."""
        return [(*key, eta) for key, curve in self.curves.items() for eta in curve.due]

    def __call__(self, table: pd.DataFrame) -> list[Place]:
        """Take the results of what was due, and give what is due next."""
        found: dict[CurveKey, dict[float, float]] = defaultdict(dict)
        for (variant, case, eta), result in zip(places_of(table), table["result"], strict=True):
            found[variant, case][eta] = result.transmittance_db if result.converged else math.nan
        for key, curve in self.curves.items():
            if curve.due:
                curve.add({eta: found[key][eta] for eta in curve.due})
        return self.due()


def chosen_frequencies(sweep: Sweep, evaluator: GivesResults) -> dict[Case, list[float]]:
    """Give the frequency ratios of every case: those asked for, or those of all curves on an adaptive axis."""
    if sweep.frequencies is None:
        return {case: sorted(sweep.frequency_ratios) for case in sweep.cases}
    accuracy = ForTheAccuracy(sweep)
    return frequencies_of(refined(sweep, accuracy.due(), accuracy, evaluator))


def frequencies_of(table: pd.DataFrame) -> dict[Case, list[float]]:
    """Give the frequency ratios of every case of a table, ascending."""
    etas: dict[Case, set[float]] = {}
    for _, case, eta in places_of(table):
        etas.setdefault(case, set()).add(eta)
    return {case: sorted(found) for case, found in etas.items()}
