"""The paper's figure 3: which points draw it, what of it the abstract prints and what is assumed, and its edges."""

import itertools
from typing import Any

import numpy as np
import pandas as pd

from multibody_xval.scenarios.edges import DEPTH_DB, THRESHOLD_DB
from multibody_xval.scenarios.model import DEFAULTS, Case
from multibody_xval.scenarios.report_plan import FRICTION_RATIOS, resonances
from multibody_xval.scenarios.result_tables import is_reference
from multibody_xval.scenarios.studies.claims import RANGE, RESONATOR, STATED, bands, claims
from reference_lcp.defaults import CELLS, MINIMUM_STEPS_PER_PERIOD

PRINTED = (0.0, 0.3, 0.6)
"""Friction ratios that the abstract's text has."""

SPACING = 0.01
"""Of the points of a curve in η_r, with all resonances beside them: straight lines between them show every peak."""


def curve_cases() -> list[Case]:
    """Give the cases between which a curve of the figure may be drawn straight."""
    even = np.round(np.arange(RANGE[0], RANGE[1] + SPACING / 2, SPACING), 2).tolist()
    etas = sorted({*even, *resonances()})
    places = itertools.product(FRICTION_RATIOS, (eta for eta in etas if RANGE[0] <= eta <= RANGE[1]))
    return [Case(friction_ratio=friction, frequency_ratio=eta) for friction, eta in places]


def assumed() -> list[str]:
    """Say what the abstract prints of its figure, and what is assumed since it does not."""
    others = ", ".join(f"{own:g}" for own in FRICTION_RATIOS if own not in PRINTED)
    ratios = [
        f"{name.replace('_', ' ')} {DEFAULTS[name]:g}"
        for name in ("mass_ratio", "stiffness_ratio", "damping_ratio", "inner_damping_ratio")
    ]
    return [
        f"The abstract prints {CELLS} cells and the friction ratios {', '.join(f'{own:g}' for own in PRINTED)}; "
        "all else is assumed.",
        f"Assumed: {', '.join(ratios)}, equal in all cells; friction ratios {others}; a base that moves as U0 sin ωt; "
        "a constant normal force.",
        "Assumed too: transmittance is the fundamental of the last outer mass over U0; the band has the first "
        f"transmittance below {DEPTH_DB:g} dB, and ends where it crosses {THRESHOLD_DB:g} dB. "
        f"Curves have {MINIMUM_STEPS_PER_PERIOD} steps per period.",
    ]


def answers_of_reference(points: pd.DataFrame, edges: pd.DataFrame) -> pd.DataFrame:
    """Give the reference's answers: a row a claim, as `claims` gives them."""
    return claims(points, edges).iloc[: len(STATED)]


def bands_of_reference(points: pd.DataFrame, edges: pd.DataFrame) -> pd.DataFrame:
    """Give the reference's bands: a row a friction ratio, as `bands` gives them."""
    own = bands(points, edges)
    return own[is_reference(own)]


def edges_and_shares(edges: pd.DataFrame, own: pd.DataFrame) -> pd.DataFrame:
    """Give `exact_edges` beside how much of `RANGE` each band covers, and the stuck fraction at the resonator."""
    table = exact_edges(edges)
    shares = {"band covers": own.share, f"stuck at {RESONATOR:g}": own.stuck}
    known = {name: {f"{f:g}": f"{100 * x:.0f} %" for f, x in zip(own.friction_ratio, values, strict=True)
                    if not np.isnan(x)} for name, values in shares.items()}  # fmt: skip
    return table.assign(**{
        name: [texts.get(f, "–") for f in table["friction ratio"]] for name, texts in known.items()
    })  # fmt: skip


def answered(answers: pd.DataFrame, *, numbers: bool) -> list[str]:
    """Say each claim with its answer, and with the numbers that decide it if they are wanted."""
    rows: Any = answers.itertuples()
    return [
        f"{own.claim}: {STATED[own.claim]}: {own.answer}" + (f"; {own.numbers}" if numbers else ".") for own in rows
    ]


def finding(answers: pd.DataFrame, own: pd.DataFrame) -> str:
    """Say in one sentence what the reference's answers and bands show."""
    rows: Any = answers.itertuples()
    text = f"Claims of the paper: {', '.join(f'{each.claim} {each.answer}' for each in rows)}"
    known = own[np.isfinite(own.lower)]
    if known.empty:
        return f"{text}."
    lowest: Any = known.loc[known.lower.idxmin()]
    place = f"η_r = {lowest.lower:.4f}, at a friction ratio of {lowest.friction_ratio:g}"
    return f"{text}. The lower edge is lowest, {place}."


def exact_edges(edges: pd.DataFrame) -> pd.DataFrame:
    """Give the lower edge of every curve of the reference, a row a friction ratio, as people read it.

    `edges` are those of `judged_edges`: the exact motion's edge lies within its error bar.
    """
    own = edges[is_reference(edges) & (edges.edge == "lower")]
    frictions = [f"{case.friction_ratio:g}" for case in own.curve]
    names = ("exact motion", "error bar", "reference", "its error")
    columns = (own.exact, own.exact_bar, own.frequency_ratio, own.error)
    texts = ("{:.7f}", "{:.0e}", "{:.7f}", "{:.0e}")
    shown = {
        name: ["–" if np.isnan(value) else text.format(value) for value in column]
        for name, column, text in zip(names, columns, texts, strict=True)
    }
    table = pd.DataFrame({"friction ratio": frictions, **shown})
    return table.sort_values("friction ratio", key=lambda column: column.astype(float), ignore_index=True)
