"""The one exact value of every case, with its error bar: proven, exact from event to event, or extrapolated."""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator

import numpy as np
import pandas as pd

from multibody_xval.scenarios.model import EXACT, REFERENCE, Case, Run
from multibody_xval.scenarios.result_tables import is_exact, is_reference, rows_of
from multibody_xval.scenarios.ruler.proven import in_table, proven
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.steady.richardson import ROUND_OFF, richardson

PROVEN_BAR = 1e-13
"""Error bar of a proven amplitude over U0: what a double leaves of 20 decimals."""

MOST_EXACT_CELLS = 20
"""Cells of the longest chain that is solved from event to event: half a second there, a tenth of one with seven."""

LADDER = (1, 2, 4, 8)
"""Steps of the reference over those of engines: they show the error of the scheme, and what it tends to."""

MARGIN = 2.0
"""On the amplification of residuals that the reference gives: contacts of an engine may stick for another part of the
period."""


Numbers = tuple[complex, float, float]
"""T, amplification and residual of the reference."""


def ruler(places: Iterable[tuple[Case, int]]) -> list[Run]:
    """Give the runs by which others at cases and numbers of steps are judged.

    These are the reference at ever finer steps, and the exact motion of cases that are not proven and that have one.
    """
    places = dict.fromkeys(places)
    ladder = [Run(REFERENCE, case, steps * factor) for case, steps in places for factor in LADDER]
    cases = dict.fromkeys(case for case, _ in places)
    exact = [Run(EXACT, case, case.steps(MINIMUM_STEPS_PER_PERIOD)) for case in cases if needs_exact_motion(case)]
    return [*ladder, *exact]


def has_ruler(table: pd.DataFrame) -> pd.Series:
    """Tell which rows are at a case and a number of steps at which the ruler was run; those that edges add are not."""
    run = set(rows_of(table[is_reference(table)], "case", "steps"))
    rows = rows_of(table, "case", "steps")
    found = [all((case, steps * factor) in run for factor in LADDER) for case, steps in rows]
    return pd.Series(found, table.index, dtype=bool)


def needs_exact_motion(case: Case) -> bool:
    """Whether the exact value of a case is that of its exact motion: it has one, and is not proven."""
    return in_table(case) not in proven() and has_exact_motion(case)


def has_exact_motion(case: Case) -> bool:
    """Whether the motion from event to event is computed: of short chains, under constant normal forces."""
    return case.cells <= MOST_EXACT_CELLS and not case.modulation


def exact_values(table: pd.DataFrame) -> pd.DataFrame:
    """Give the exact value of every case of a table of points that has one.

    Columns: ``case``, ``exact`` (complex), ``exact_bar`` over U0, ``exact_kind``: proven, exact or extrapolated.
    """
    growth = table[is_reference(table)].groupby("case", sort=False).amplification.max()
    exact = table[is_exact(table) & (table.status == "periodic")].drop_duplicates("case")
    motions = {case: (ratio, residual) for case, ratio, residual in rows_of(exact, "case", "ratio", "residual")}
    finest = {case: (counts, own) for case, counts, own in _ladders(table)}
    rows = []
    for case in dict.fromkeys(table.case):
        if in_table(case) in proven():
            rows.append((case, proven()[in_table(case)], PROVEN_BAR, "proven"))
        elif case in motions:
            ratio, residual = motions[case]
            rows.append((case, ratio, residual * MARGIN * growth.get(case, math.nan) + ROUND_OFF, "exact"))
        elif case in finest:
            rows.append((case, *_extrapolated(*finest[case], at=-1), "extrapolated"))
    known = pd.DataFrame(rows, columns=["case", "exact", "exact_bar", "exact_kind"])
    return known.astype({"exact": complex, "exact_bar": float})


def scheme_errors(table: pd.DataFrame) -> pd.DataFrame:
    """Give the error of Euler's scheme at the coarsest number of steps of every ladder of the reference.

    Columns: ``case``, ``steps``, ``scheme_error`` over U0, ``growth`` of residuals, ``reference`` (complex) and
    ``reference_residual`` of the scheme itself.
    """
    rows = []
    for case, counts, own in _ladders(table):
        ratio, growth, residual = own[0]
        rows.append((case, counts[0], _extrapolated(counts, own, at=0)[1], growth, ratio, residual))
    numbers = {"steps": int, "scheme_error": float, "growth": float, "reference": complex, "reference_residual": float}
    return pd.DataFrame(rows, columns=["case", *numbers]).astype(numbers)


def _extrapolated(counts: list[int], own: list[Numbers], at: int) -> tuple[complex, float]:
    """Give what a ladder tends to for ever finer steps, and the error of one of its numbers of steps, over U0."""
    parts = np.array([(ratio.real, ratio.imag) for ratio, *_ in own])
    estimate = richardson(counts, parts, at=counts[at])
    return complex(*estimate.extrapolated), float(np.hypot(*estimate.error))


def _ladders(table: pd.DataFrame) -> Iterator[tuple[Case, list[int], list[Numbers]]]:
    """Give what the reference gives at one case with N, 2N, 4N and 8N steps, by case and ascending N."""
    steady = table[is_reference(table) & (table.status == "periodic")]
    by_case: dict[Case, dict[int, Numbers]] = defaultdict(dict)
    for case, steps, *numbers in rows_of(steady, "case", "steps", "ratio", "amplification", "residual"):
        by_case[case][steps] = tuple(numbers)
    for case, by_steps in by_case.items():
        for n in sorted(by_steps):
            counts = [n * factor for factor in LADDER]
            if all(count in by_steps for count in counts):
                yield case, counts, [by_steps[count] for count in counts]
