"""The runs that edges still need, by the points so far."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import pandas as pd

from multibody_xval.scenarios.edges.exact_place import exact_levels, exact_place
from multibody_xval.scenarios.edges.finding import CLOSE, curves, edges, hidden, refined
from multibody_xval.scenarios.model import EXACT, Case, Run
from multibody_xval.scenarios.result_tables import is_reference
from multibody_xval.scenarios.ruler.exact_values import ruler

NEAR = 1e-4
"""Distance in η_r from the reference's edge at which curves of other schemes are first tried: most have theirs there.
Curves that share the scheme are tried as close as an edge is wanted."""

LEAST = CLOSE / 4
"""Half the least distance of two points beside an edge."""


def propose(table: pd.DataFrame) -> list[Run]:
    """Give the runs that edges need next; none where they are refined, or where runs have shown no steady state.

    First what hides no crossing; then two points beside each edge, the reference's first, which the others then begin
    at; with those, the ruler where the exact motion's edges are expected.
    """
    table = table.reset_index(drop=True)
    known = set(map(Run, table.config, table.case, table.steps))

    def new(runs: Iterable[Run]) -> list[Run]:
        return [run for run in dict.fromkeys(runs) if run not in known]

    if resolving := new(_resolving(table)):
        return resolving
    found = edges(table)
    found = found[found.before >= 0]
    reference, wide = is_reference(found), ~refined(found)
    if first := new(run for own in _rows(found[reference & wide]) for run in _around(own, table)):
        return first
    starts = found[reference & ~wide].set_index(["curve", "steps", "edge"]).frequency_ratio.to_dict()
    runs = []
    for own in _rows(found[~reference & wide]):
        runs += new(_beside(own, table, starts)) or new(_around(own, table))
    return runs + new(_ruling(found[reference & ~wide], table, known))


def _resolving(table: pd.DataFrame) -> Iterator[Run]:
    """Give the runs without which a crossing may be hidden."""
    for curve in curves(table):
        for eta in hidden(curve):
            yield _run(curve.config, curve.case, eta, curve.steps)


def _around(own: Any, table: pd.DataFrame) -> list[Run]:
    """Give two runs on either side of where a curve's own points expect an edge."""
    aside = min(max((own.high - own.low) / 8, LEAST), own.width / 6)
    return [_run(table.config[own.before], own.curve, own.guess + side, own.steps) for side in (-aside, aside)]


def _beside(own: Any, table: pd.DataFrame, starts: Mapping[Any, float]) -> list[Run]:
    """Give two runs on either side of the reference's edge, if a curve may have its own there."""
    place = starts.get((own.curve, own.steps, own.edge))
    first, last = table.frequency_ratio[own.before], table.frequency_ratio[own.after]
    aside = 2 * LEAST if table.shares_scheme[own.before] else NEAR
    if place is None or not first < place - aside < place + aside < last:
        return []
    return [_run(table.config[own.before], own.curve, place + side, own.steps) for side in (-aside, aside)]


def _run(config: Any, curve: Case, frequency_ratio: float, steps: int) -> Run:
    """Give the run of a curve at a frequency."""
    case = replace(curve, frequency_ratio=round(frequency_ratio, 9))
    return Run(config, case, case.steps(steps))


def _ruling(found: pd.DataFrame, table: pd.DataFrame, known: set[Run]) -> list[Run]:
    """Give the runs of the exact motion that lead to its edges, and of the ruler where they are, or where it fails."""
    levels = exact_levels(table)
    runs: list[Run] = []
    for own in _rows(found):
        place, step, _ = exact_place(own, levels)
        case = replace(own.curve, frequency_ratio=place)
        whole = ruler([(case, case.steps(own.steps))])
        first = [run for run in whole if run.config == EXACT and run not in known]
        runs += first if math.isnan(step) and first else whole
    return runs


def _rows(found: pd.DataFrame) -> Iterable[Any]:
    return found.itertuples()
