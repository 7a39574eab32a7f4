"""Proofs of steady states, of the standard grids and the catalogue: of the table of levels that is shipped."""

import json
import math
import random
from collections.abc import Sequence
from decimal import ROUND_HALF_EVEN, Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pandas as pd

from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.model import CASE, Case
from multibody_xval.scenarios.report_plan import grid
from multibody_xval.scenarios.result_tables import CLOSED
from multibody_xval.scenarios.ruler.exact_values import MOST_EXACT_CELLS
from multibody_xval.scenarios.ruler.judge import FLOOR_DB
from multibody_xval.scenarios.ruler.proven import DIGITS, RATIOS, ProvenLevel, in_table, proven_levels
from multibody_xval.scenarios.studies.accuracy_map import MAP, SIX
from multibody_xval.scenarios.table_text import number_texts
from reference_lcp.chain.preload import Preload
from reference_lcp.errors import NotProven
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.exact.proof.prove import ProvenSteadyState, Uniqueness, prove
from reference_lcp.one_call import exact_steady_state, steady_state
from reference_lcp.validation import checked_count

RESOLVED = {
    0.0: (0.85955,),
    0.1: (0.7625, 0.775),
    0.3: (0.63, 0.634, 0.64, 0.642, 0.66, 0.6625, 0.67, 0.675, 0.68, 0.6875, 0.69),
    0.6: (0.7625, 0.775, 0.7875, 0.80675, 0.822625, 0.83175, 0.840875, 0.85955, 0.87645, 0.8843),
    1.0: (0.92315, 0.925, 0.975, 0.9875, 1.0125, 1.025, 1.0375),
    5.0: (1.1625, 1.175, 1.1875, 1.27095, 1.281425, 1.3125, 1.325),
}
"""Frequency ratios that both reports add near the threshold, by friction ratio: see `edges.hidden`."""

LONGEST_PROOF = 3600.0
"""Seconds after which a proof is given up: fifty cells take minutes."""

RADIUS = Decimal(1).scaleb(-DIGITS)
"""Largest distance of a number of the table from one that is proven again."""

SUMMARY = {
    "points": ("case", "size", "{}"),
    "proven": ("level", "count", "{}"),
    "unique": ("unique", "sum", "{}"),
    "as in the table": ("as_known", "sum", "{}"),
    "events": ("events", "max", "{:.0f}"),
    "radius [dB]": ("radius_db", "max", "{:.0e}"),
    "floats [dB]": ("float_error_db", "max", "{:.1e}"),
    "in U0": ("float_error", "max", "{:.0e}"),
    "over bar": ("part_of_bar", "max", "{:.2f}"),
    "median [s]": ("seconds", "median", "{:.2f}"),
    "largest [s]": ("seconds", "max", "{:.2f}"),
}
"""Headings of what is printed: a column of `proofs`, what is made of it, and how it is written."""


def standard_cases() -> list[Case]:
    """Give all steady states of the table, those of the paper's chain first.

    These are points of the default and the quick report, those of the accuracy map, and all of the catalogue whose
    normal forces are given and whose contacts stay closed.
    """
    near = [Case(friction_ratio=friction, frequency_ratio=eta) for friction, own in RESOLVED.items() for eta in own]
    catalogue = [case for own in SCENARIOS.values() for case in own.cases.values() if isinstance(case, Case)]
    cases = dict.fromkeys(map(in_table, [*grid(quick=False), *grid(quick=True), *MAP, *SIX, *near, *catalogue]))
    known = [case for case in cases if case.modulation <= CLOSED]
    return sorted(
        known, key=lambda case: (1,) if beside_paper(case) else (0, case.friction_ratio, case.frequency_ratio)
    )


def chosen_cases(sample: int | None, seed: int) -> list[Case]:
    """Give all standard cases, or a random sample of so many."""
    cases = standard_cases()
    if sample is None:
        return cases
    return random.Random(seed).sample(cases, checked_count("sample", sample, 1, len(cases)))


def beside_paper(case: Case) -> dict[str, Any]:
    """Give what a chain has beside the paper's."""
    return {name: value for name, value in case.as_data().items() if name not in RATIOS}


def exact_chain(case: Case) -> ExactChain:
    """Give the chain of a case in exact numbers: its ratios as decimals; under a force, the doubles of its units."""
    if case.drive == "force":
        chain, drive = case.setting
        swing = case.modulation, case.modulation_multiple, case.modulation_phase
        return ExactChain.of(chain, drive, Preload.at_multiple(drive, *swing) if case.modulation else None)
    ratios = {name: getattr(case, name) for name in CASE}
    for name in ("friction_coefficient", "displacement", "drive"):  # the motion in these units does not depend on them
        ratios.pop(name)
    bounds = (np.broadcast_to(ratios.pop(name), case.cells) for name in ("friction_ratio", "friction_profile"))
    friction = tuple(Fraction(str(one)) * Fraction(str(other)) for one, other in zip(*bounds, strict=True))
    return ExactChain.from_ratios(friction_ratio=friction, **ratios)


def proof_of(case: Case) -> dict[str, Any]:
    """Prove one steady state, in the decimals as which its ratios are printed: gives a row of `proofs`."""
    try:
        state, reason = prove(exact_chain(case), digits=DIGITS + 1, time_limit=LONGEST_PROOF), ""
    except NotProven as problem:
        return {"case": case, "reason": str(problem), "as_known": case not in proven_levels(), "unique": False}
    level = rounded(state)
    return {
        "case": case, "level": level, "reason": reason, "as_known": _same(level, proven_levels().get(case)),
        "unique": state.unique_by is Uniqueness.DAMPING, "events": level.events,
        "radius_db": float(state.transmittance_db.radius), "seconds": state.seconds, **_floats(case, state),
    }  # fmt: skip


def proofs(rows: Sequence[dict[str, Any]]) -> pd.DataFrame:
    """Give one row a point: what came of its proof, beside the motion in floating point.

    Columns: ``case``, ``level`` (`ProvenLevel`, ``None`` without a proof), ``reason`` why there is none, ``as_known``:
    whether the shipped table has just this, ``unique`` by damping, ``events``, ``radius_db`` and ``seconds`` of the
    proof; of the event-driven motion in floating point ``float_error_db``, above `FLOOR_DB` alone, and ``float_error``
    in amplitude over U0; of the scheme ``part_of_bar``, its error over its error bar. Floating point and scheme are
    not compared where normal forces swing, and in long chains.
    """
    columns = ["case", "level", "reason", *(name for name, *_ in SUMMARY.values())]
    table = pd.DataFrame(list(rows), columns=list(dict.fromkeys(columns)))
    numbers = ("events", "radius_db", "seconds", "float_error_db", "float_error", "part_of_bar")
    return table.astype({**dict.fromkeys(numbers, float), "unique": bool, "as_known": bool})


def rounded(state: ProvenSteadyState) -> ProvenLevel:
    """Round what is proven to the decimals of the table."""
    level, phase = (each.value.quantize(RADIUS, ROUND_HALF_EVEN) for each in (state.transmittance_db, state.phase))
    return ProvenLevel(level, phase, len(state.transitions))


def _same(own: ProvenLevel, known: ProvenLevel | None) -> bool:
    if known is None or own.events != known.events:
        return False
    return all(abs(one - other) <= RADIUS for one, other in zip(own[:2], known[:2], strict=True))


def _floats(case: Case, state: ProvenSteadyState) -> dict[str, float]:
    """Give how far floating point and the scheme are from what is proven."""
    if case.modulation or case.cells > MOST_EXACT_CELLS:
        return {}
    found, proven_db = steady_state(*case.setting), state.transmittance_db.value
    in_floats = exact_steady_state(*case.setting).transmittance_db
    off = {"float_error": float(abs(Decimal(10 ** (in_floats / 20)) - state.transmittance.value))}
    if proven_db >= FLOOR_DB:
        bar = math.nan if found.error_bar is None else found.error_bar.transmittance_db
        off["float_error_db"] = float(abs(Decimal(in_floats) - proven_db))
        off["part_of_bar"] = float(abs(Decimal(found.transmittance_db) - proven_db)) / bar
    return off


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Give texts, a row a friction ratio of the paper's chain, one of other chains, and one of all of them."""
    titles = ["other chains" if beside_paper(case) else f"{case.friction_ratio:g}" for case in table.case]
    made: dict[str, Any] = {title: (column, how) for title, (column, how, _) in SUMMARY.items()}
    rows = table.groupby(titles, sort=False).agg(**made)
    if len(rows) > 1:
        rows = pd.concat([rows, table.groupby(["all"] * len(table)).agg(**made)])
    texts = number_texts(rows, {title: pattern for title, (_, _, pattern) in SUMMARY.items()})
    return texts.rename_axis("friction").reset_index()


def table_rows(table: pd.DataFrame) -> pd.DataFrame:
    """Give the rows of the table of levels as its file has them."""
    rows = []
    for case, level in table[table.level.notna()][["case", "level"]].itertuples(index=False):
        other = beside_paper(case)
        rows.append([*(json.dumps(getattr(case, name)) for name in RATIOS), json.dumps(other) if other else "", *level])
    return pd.DataFrame(rows, columns=[*RATIOS, "chain", *ProvenLevel._fields])
