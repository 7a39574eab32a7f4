"""The paper's claims about its figure 3, and what one would conclude of them with every configuration.

A claim is decided by the bands at the paper's friction ratios: both edges, and the stuck fraction at the resonator's
frequency. With friction the band has no upper edge up to η_r = 3. Its width is therefore the share of a stated range
that it covers, which is always finite.
"""

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from multibody_xval.scenarios.edges import DEPTH_DB, refined
from multibody_xval.scenarios.model import REFERENCE, Case, Config
from multibody_xval.scenarios.report_plan import FRICTION_RATIOS, claim_frequency_ratios
from multibody_xval.scenarios.result_tables import CONFIG, CURVE, coarsest, is_exact, rows_of

UP_TO, BEYOND, WIDEST = (0.1, 0.3, 0.6), (1.0, 5.0), 0.3
"""Friction ratios at which the paper's band is wider than without friction, those beyond, and that of its widest."""

RANGE = (0.3, 1.6)
"""Frequency ratios of which the band covers a share: those over which errors are stated too."""

WIDTH = RANGE[1] - RANGE[0]

RESONATOR = 1.0
"""Frequency ratio at which locking is read: there, an inner mass that is free moves most."""

LOCKED = 0.9
"""Stuck fraction from which a cell counts as one mass: the reference's is 0.52 at a friction ratio of 0.6, and 0.99 at
1."""

MOVED = 1e-3
"""Change of an edge in η_r that counts: twenty times what a step of 400 per period moves edges."""

STATED = {
    "a": "the band is wider than without friction for friction ratios up to 0.6",
    "b": "beyond, each cell behaves like one mass, and the first cut-off moves up",
    "c": "the band is widest at a friction ratio of 0.3",
}
"""What the paper claims, by the name of the claim."""

HOLDS, READING, FAILS, OPEN = "confirmed", "partly confirmed", "not confirmed", "not decided"
"""What numbers say of a claim."""

Answer = tuple[str, str, str]
"""One of these; what decides it, or is missing; what one would conclude."""

TITLES = {"default": "default options", "recommended": "recipe", "tuned": "tuned to the chain"}
"""Presets in words."""

KEY = ["configuration", *CONFIG, "version"]


def claim_cases() -> list[Case]:
    """Give the cases by which the claims are answered."""
    return [
        Case(friction_ratio=own, frequency_ratio=eta) for own in FRICTION_RATIOS for eta in claim_frequency_ratios()
    ]


def bands(points: pd.DataFrame, edges: pd.DataFrame) -> pd.DataFrame:
    """Give the attenuation bands that are known: a row a configuration and friction ratio of the paper's chain.

    A band is known where every frequency of `claim_frequency_ratios` is there, no run has failed, and its edges are
    refined.

    Columns: those of `KEY`, ``friction_ratio``, ``lower`` (-inf below the grid, inf without any deep attenuation) and
    ``upper`` (inf where the grid has none) edge, ``last`` frequency of the grid, all in η_r, ``share`` of `RANGE`, and
    ``stuck`` (fraction at `RESONATOR`, mean of the cells; NaN where it is not known).
    """
    absent = (edges.before < 0) & ((edges.edge == "upper") | (edges.lost == 0))
    places = edges.assign(place=edges.frequency_ratio.where(refined(edges)))[~absent]
    known = {own[:-1]: own[-1] for own in rows_of(places, *CURVE, "edge", "place")}
    needed, rows = set(claim_frequency_ratios()), []
    for key, curve in coarsest(of_paper(points[~is_exact(points)])).groupby(CURVE, sort=False):
        ends = [known.get((*key, edge), side) for edge, side in (("lower", -math.inf), ("upper", math.inf))]
        steady = curve[curve.status == "periodic"]
        deep = bool((steady.transmittance_db < DEPTH_DB).any())
        ran = needed <= set(curve.frequency_ratio) and not curve.status.isin(["failed", "unsupported"]).any()
        if not ran or np.isnan(ends).any() or (not deep and len(steady) < len(curve)):
            continue
        at = next(iter(steady.stuck[steady.frequency_ratio == RESONATOR]), ())
        ends = ends if deep else [math.inf, math.inf]
        stuck = float(np.mean(at)) if at else math.nan
        rows.append((*curve.iloc[0][[*KEY, "friction_ratio"]], *ends, float(curve.frequency_ratio.max()), stuck))
    names = [*KEY, "friction_ratio", "lower", "upper", "last", "stuck"]
    table = pd.DataFrame(rows, columns=names).astype(dict.fromkeys(names[-5:], float))
    table = table.drop_duplicates([*KEY, "friction_ratio"])
    covered = table.upper.clip(upper=RANGE[1]) - table.lower.clip(lower=RANGE[0])
    return table.assign(share=covered.clip(lower=0.0) / WIDTH)


def of_paper(points: pd.DataFrame) -> pd.DataFrame:
    """Give the points of the paper's chain, at the friction ratios of its figure."""
    curves = [Case(friction_ratio=own, frequency_ratio=1.0) for own in FRICTION_RATIOS]
    return points[points.curve.isin(curves)]


def claims(points: pd.DataFrame, edges: pd.DataFrame) -> pd.DataFrame:
    """Answer the paper's claims: a row a configuration and claim, the reference first.

    Configurations that are not measured at `RESONATOR` are left out.

    Columns: those of `KEY`, ``claim`` (a, b or c), ``answer``, ``numbers`` (what decides it, or is missing) and
    ``concluded``, after "one would conclude that".
    """
    rows = [
        (*key, name, *answer)
        for key, own in _by_configuration(points, edges).items()
        for name, answer in zip(STATED, answers(own), strict=True)
    ]
    return pd.DataFrame(rows, columns=[*KEY, "claim", "answer", "numbers", "concluded"])


def conclusions(points: pd.DataFrame, edges: pd.DataFrame) -> pd.DataFrame:
    """Give a row a configuration, the reference first: answers, lower edges [η_r] by friction ratio, and a sentence.

    Columns: those of `KEY`, a column a claim, a column a friction ratio (NaN where the band is not known),
    ``farthest`` (how far a lower edge is off from the reference's at most; 0 where none is known) and ``sentence``.
    """
    known = _by_configuration(points, edges)
    reference = next(
        (own for key, own in known.items() if key[1] == REFERENCE.engine), next(iter(known.values()), None)
    )
    rows = []
    for key, own in known.items():
        assert reference is not None
        off = _off(own, reference).max()
        found = answers(own), own.lower.reindex([*FRICTION_RATIOS])
        rows.append(
            (*key, *(answer for answer, *_ in found[0]), *found[1], np.nan_to_num(off), _sentence(key, own, reference))
        )
    return pd.DataFrame(rows, columns=[*KEY, *STATED, *FRICTION_RATIOS, "farthest", "sentence"])


def shown(table: pd.DataFrame) -> pd.DataFrame:
    """Give the answers and edges of `conclusions` as people read them: a dash where a band is not known."""
    texts = {f"{f:g}": ["–" if math.isnan(own) else edge_text(own) for own in table[f]] for f in FRICTION_RATIOS}
    return table[["configuration", *STATED]].assign(**texts)


def _by_configuration(points: pd.DataFrame, edges: pd.DataFrame) -> dict[tuple[str, ...], pd.DataFrame]:
    """Give the known bands of every configuration by friction ratio, the reference's first."""
    asked = of_paper(points[(points.frequency_ratio == RESONATOR) & ~is_exact(points)])
    keys = list(asked[KEY].drop_duplicates().itertuples(index=False, name=None))
    keys.sort(key=lambda key: key[1:4] != (REFERENCE.engine, str(REFERENCE.formulation), REFERENCE.preset_name))
    known = bands(points, edges).set_index("friction_ratio")
    groups = dict(iter(known.groupby(KEY, sort=False)))
    return {key: groups.get(key, known.iloc[:0]) for key in keys}


def answers(own: pd.DataFrame) -> tuple[Answer, Answer, Answer]:
    """Answer the claims by the bands of one configuration, by friction ratio."""
    return _wider(own), _locked(own), _widest(own)


def _wider(own: pd.DataFrame) -> Answer:
    needed = (0.0, *UP_TO)
    if lacking := _lacking(own, needed):
        return OPEN, lacking, ""
    low = all(own.lower[f] < own.lower[0.0] - MOVED for f in UP_TO)
    narrow = [f for f in UP_TO if not own.share[f] > own.share[0.0] + MOVED / WIDTH]
    without = [f for f in needed if math.isinf(own.upper[f])]
    uppers = _listed(own.upper, [f for f in needed if f not in without])
    if without:
        uppers += f"{', ' * bool(uppers)}none up to {own['last'][without].min():g} at {_numbers(without)}"
    numbers = f"lower edge {_listed(own.lower, needed)}; upper edge {uppers}; {_shares(own, needed)}"
    holds = "the band is wider than without friction up to a friction ratio of 0.6"
    fails = f"the band is not wider than without friction at {_numbers(narrow)}"
    return _by_both(low, not narrow, numbers, holds, fails)


def _locked(own: pd.DataFrame) -> Answer:
    needed = (UP_TO[-1], *BEYOND)
    if lacking := _lacking(own, needed, stuck=BEYOND):
        return OPEN, lacking, ""
    rises = all(after > before + MOVED for before, after in itertools.pairwise(own.lower[f] for f in needed))
    slides = [f for f in BEYOND if own.stuck[f] < LOCKED]
    stuck = _listed(own.stuck, BEYOND, "{:.2f}".format)
    numbers = f"stuck fraction at η_r = {RESONATOR:g}: {stuck}; lower edge {_listed(own.lower, needed)}"
    if rises and not slides:
        return READING, numbers, "beyond, each cell behaves like one mass while the first cut-off moves up"
    wrong = [f"cells do not lock at {_numbers(slides)}"] if slides else []
    wrong += [] if rises else ["the first cut-off does not move up beyond 0.6"]
    return FAILS, numbers, " and ".join(wrong)


def _widest(own: pd.DataFrame) -> Answer:
    if lacking := _lacking(own, FRICTION_RATIOS):
        return OPEN, lacking, ""
    others = own.drop(index=WIDEST)
    lowest = bool((own.lower[WIDEST] < others.lower - MOVED).all())
    largest = bool((own.share[WIDEST] > others.share + MOVED / WIDTH).all())
    numbers = f"lower edge {_listed(own.lower, FRICTION_RATIOS)}; {_shares(own, FRICTION_RATIOS)}"
    best = max(FRICTION_RATIOS, key=lambda f: own.share[f])
    where = f"widest at {best:g}" if best != WIDEST else f"no wider at {WIDEST:g} than elsewhere"
    return _by_both(lowest, largest, numbers, "the band is widest at 0.3", f"the band is {where}")


def _by_both(by_edge: bool, by_share: bool, numbers: str, holds: str, fails: str) -> Answer:
    """Answer a claim that may be read by the lower edge or by the share."""
    if by_edge and by_share:
        return HOLDS, numbers, holds
    if by_edge or by_share:
        reading = "by the lower edge alone" if by_edge else "by the covered share alone"
        return READING, f"{reading}: {numbers}", f"{holds} ({reading})"
    return FAILS, numbers, fails


def _lacking(own: pd.DataFrame, needed: Sequence[float], stuck: Sequence[float] = ()) -> str:
    """Say which points are missing; empty where none is."""
    curves = [f for f in needed if f not in own.index]
    points = [f for f in stuck if f in own.index and math.isnan(own.stuck[f])]
    parts = [f"the band at friction ratio {_numbers(curves)}"] if curves else []
    parts += [f"the steady state at η_r = {RESONATOR:g} at friction ratio {_numbers(points)}"] if points else []
    return f"missing: {'; '.join(parts)}" if parts else ""


def _numbers(values: Iterable[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)


def edge_text(eta: float) -> str:
    """Give an edge as people read it."""
    if math.isinf(eta):
        return "none" if eta > 0 else "below the grid"
    return f"{eta:.4f}"


def _listed(values: pd.Series, needed: Sequence[float], text: Callable[[float], str] = edge_text) -> str:
    return ", ".join(f"{text(values[f])} at {f:g}" for f in needed)


def _shares(own: pd.DataFrame, needed: Sequence[float]) -> str:
    shares = _listed(own.share, needed, "{:.0%}".format).replace("%", " %")
    return f"share of η_r {RANGE[0]:g} to {RANGE[1]:g}: {shares}"


def _sentence(key: tuple[str, ...], own: pd.DataFrame, reference: pd.DataFrame) -> str:
    """Say what one would conclude with a configuration, and how far that is from what the reference says."""
    _, engine, formulation, whole, _ = key
    preset, *settings = whole.split(":")
    title = Config(engine, formulation, ":".join(["tuned", *settings])).title
    name = "the reference" if engine == REFERENCE.engine else f"{title} ({TITLES.get(preset, preset)})"
    found = [*zip(STATED, answers(own), answers(reference), strict=True)]
    decided = [(mine, right) for _, mine, right in found if OPEN not in (mine[0], right[0])]
    if not decided:
        return f"With {name} nothing can be concluded: {found[0][1][1]}."
    apart = [mine for mine, right in decided if mine[0] != right[0]]
    if own is reference:
        text = f"that {_joined([mine[2] for mine, _ in decided])}"
    elif apart:
        text = (
            f"that {_joined([mine[2] for mine in apart])}, otherwise than with the reference{_farthest(own, reference)}"
        )
    else:
        text = f"the same as with the reference{_farthest(own, reference)}"
    rest = [f"Claim {claim} is not decided; {mine[1]}" for claim, mine, _ in found if mine[0] == OPEN]
    return ". ".join([f"With {name} one would conclude {text}", *rest]) + "."


def _joined(parts: list[str]) -> str:
    *first, last = parts
    return f"{', that '.join(first)}, and that {last}" if first else last


def _off(own: pd.DataFrame, reference: pd.DataFrame) -> "pd.Series[float]":
    """Give how far the lower edges are off from those of the reference, by friction ratio."""
    return (own.lower[np.isfinite(own.lower)] - reference.lower).abs()


def _farthest(own: pd.DataFrame, reference: pd.DataFrame) -> str:
    """Say how far the lower edge is off at most; nothing where it is by less than `MOVED`."""
    off = _off(own, reference)
    if not off.max() >= MOVED:
        return ""
    worst: Any = off.idxmax()
    size = f"{own.lower[worst]:.4f} instead of {edge_text(reference.lower[worst])}"
    return f"; its lower edge is off by up to {off[worst]:.2g} (friction ratio {worst:g}: {size})"
