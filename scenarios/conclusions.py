"""What one would conclude about the paper's claims with each configuration, in a sentence."""

import math
from typing import Any

import pandas as pd

from multibody_xval.scenarios.claims import KEY, MOVED, OPEN, STATED, bands, claims, edge_text
from multibody_xval.scenarios.model import REFERENCE, Config
from multibody_xval.scenarios.report_plan import FRICTION_RATIOS

TITLES = {"default": "default options", "recommended": "recipe", "tuned": "tuned to the chain"}
"""Presets in words."""


def conclusions(points: pd.DataFrame, edges: pd.DataFrame) -> pd.DataFrame:
    """Give a row a configuration, the reference first: answers, lower edges [η_r] by friction ratio, and a sentence.

    Columns: those of `claims.KEY`, a column a claim, a column a friction ratio (NaN where the band is not known),
    ``farthest`` (how far a lower edge is off from the reference's at most; 0 where none is known) and ``sentence``.
    """
    answered = claims(points, edges)
    lower = bands(points, edges).set_index([*KEY, "friction_ratio"]).lower
    groups = list(answered.groupby(KEY, sort=False))
    if not groups:
        return pd.DataFrame(columns=[*KEY, *STATED, *FRICTION_RATIOS, "farthest", "sentence"])
    reference = next((own for key, own in groups if key[1] == REFERENCE.engine), groups[0][1])
    right = _edges(lower, reference)
    rows = []
    for key, own in groups:
        mine = _edges(lower, own)
        off = (mine - right)[mine.abs() < math.inf].dropna()
        text = _sentence(own, reference, _farthest(off, mine, right))
        rows.append((*key, *own.answer, *mine, off.abs().max() if len(off) else 0.0, text))
    return pd.DataFrame(rows, columns=[*KEY, *STATED, *FRICTION_RATIOS, "farthest", "sentence"])


def shown(table: pd.DataFrame) -> pd.DataFrame:
    """Give the answers and edges of `conclusions` as people read them: a dash where a band is not known."""
    texts = {f"{f:g}": ["–" if math.isnan(own) else edge_text(own) for own in table[f]] for f in FRICTION_RATIOS}
    return table[["configuration", *STATED]].assign(**texts)


def _edges(lower: "pd.Series[float]", own: pd.DataFrame) -> "pd.Series[float]":
    """Give the lower edges of the configuration of some rows by friction ratio."""
    key = tuple(own[KEY].iloc[0])
    return pd.Series({f: lower.get((*key, f), math.nan) for f in FRICTION_RATIOS}, dtype=float)


def _sentence(own: pd.DataFrame, reference: pd.DataFrame, farthest: str) -> str:
    """Say what one would conclude with a configuration, and how far that is from what the reference says."""
    name = _called(own)
    decided = ((own.answer != OPEN).to_numpy()) & ((reference.answer != OPEN).to_numpy())
    if not decided.any():
        return f"With {name} nothing can be concluded: {own.numbers.iloc[0]}."
    apart = decided & (own.answer.to_numpy() != reference.answer.to_numpy())
    if own is reference:
        text = f"that {_joined(own.concluded[decided].tolist())}"
    elif apart.any():
        text = f"that {_joined(own.concluded[apart].tolist())}, otherwise than with the reference{farthest}"
    else:
        text = f"the same as with the reference{farthest}"
    still_open = own[own.answer == OPEN]
    rest = [f"Claim {row.claim} is not decided; {row.numbers}" for row in still_open.itertuples()]
    return ". ".join([f"With {name} one would conclude {text}", *rest]) + "."


def _called(own: pd.DataFrame) -> str:
    """Name a configuration in a sentence."""
    row = own.iloc[0]
    if row.engine == REFERENCE.engine:
        return "the reference"
    preset, *settings = row.preset.split(":")
    title = Config(row.engine, row.formulation, ":".join(["tuned", *settings])).title
    return f"{title} ({TITLES.get(preset, preset)})"


def _joined(parts: list[str]) -> str:
    *first, last = parts
    return f"{', that '.join(first)}, and that {last}" if first else last


def _farthest(off: "pd.Series[float]", mine: "pd.Series[float]", right: "pd.Series[float]") -> str:
    """Say how far the lower edge is off at most; nothing where it is by less than `MOVED`."""
    if not off.abs().max() >= MOVED:
        return ""
    worst: Any = off.abs().idxmax()
    size = f"{mine[worst]:.4f} instead of {edge_text(right[worst])}"
    return f"; its lower edge is off by up to {abs(off[worst]):.2g} (friction ratio {worst:g}: {size})"
