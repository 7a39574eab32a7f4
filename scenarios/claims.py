"""The paper's claims about its figure 3, answered for every configuration by its points and band edges.

A claim is decided by the bands at the paper's friction ratios: both edges, and the stuck fraction at the resonator's
frequency. With friction the band has no upper edge up to η_r = 3. Its width is therefore the share of a stated range
that it covers, which is always finite.
"""

import itertools
import math
from collections.abc import Iterable, Sequence

import numpy as np
import pandas as pd

from multibody_xval.scenarios.edges import DEPTH_DB, refined
from multibody_xval.scenarios.model import REFERENCE, Case
from multibody_xval.scenarios.report_plan import FRICTION_RATIOS, claim_frequency_ratios, resonances
from multibody_xval.scenarios.result_tables import CONFIG, CURVE, coarsest, is_exact, rows_of

UP_TO, BEYOND, WIDEST = (0.1, 0.3, 0.6), (1.0, 5.0), 0.3
"""Friction ratios at which the paper's band is wider than without friction, those beyond, and that of its widest."""

RANGE = (0.3, 1.6)
"""Frequency ratios of which the band covers a share: those over which errors are stated too."""

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

HOLDS, READING, FAILS, OPEN = "holds", "holds as read here", "does not hold", "not decided"
"""What numbers say of a claim."""

Answer = tuple[str, str, str]
"""One of these; what decides it, or is missing; what one would conclude."""

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
    rows = []
    own = coarsest(of_paper(points[~is_exact(points)]))
    for key, curve in own.groupby(CURVE, sort=False):
        ends = [known.get((*key, edge), side) for edge, side in (("lower", -math.inf), ("upper", math.inf))]
        if (band := _band(curve, *ends)) is not None:
            rows.append((*curve.iloc[0][KEY], curve.friction_ratio.iloc[0], *band))
    names = [*KEY, "friction_ratio", "lower", "upper", "last", "stuck"]
    table = pd.DataFrame(rows, columns=names).drop_duplicates([*KEY, "friction_ratio"])
    covered = table.upper.clip(upper=RANGE[1]) - table.lower.clip(lower=RANGE[0])
    return table.assign(share=covered.clip(lower=0.0) / (RANGE[1] - RANGE[0]))


def curve_cases() -> list[Case]:
    """Give the cases between which a curve of the figure may be drawn straight."""
    etas = sorted({*np.round(np.arange(RANGE[0], RANGE[1] + 1e-9, 0.01), 2).tolist(), *resonances()})
    places = itertools.product(FRICTION_RATIOS, (eta for eta in etas if RANGE[0] <= eta <= RANGE[1]))
    return [Case(friction_ratio=friction, frequency_ratio=eta) for friction, eta in places]


def of_paper(points: pd.DataFrame) -> pd.DataFrame:
    """Give the points of the paper's chain, at the friction ratios of its figure."""
    curves = [Case(friction_ratio=own, frequency_ratio=1.0) for own in FRICTION_RATIOS]
    return points[points.curve.isin(curves)]


def _band(curve: pd.DataFrame, lower: float, upper: float) -> tuple[float, float, float, float] | None:
    """Give lower and upper edge, last frequency and stuck fraction of a curve; ``None`` where points are missing."""
    complete = set(claim_frequency_ratios()) <= set(curve.frequency_ratio)
    if not complete or curve.status.isin(["failed", "unsupported"]).any() or math.isnan(lower) or math.isnan(upper):
        return None
    steady = curve[curve.status == "periodic"]
    deep = bool((steady.transmittance_db < DEPTH_DB).any())
    if not deep and len(steady) < len(curve):
        return None
    at = steady.stuck[steady.frequency_ratio == RESONATOR]
    stuck = float(np.mean(at.iloc[0])) if len(at) and at.iloc[0] else math.nan
    return (lower if deep else math.inf), (upper if deep else math.inf), float(curve.frequency_ratio.max()), stuck


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


def _by_configuration(points: pd.DataFrame, edges: pd.DataFrame) -> dict[tuple[object, ...], pd.DataFrame]:
    """Give the known bands of every configuration by friction ratio, the reference's first."""
    asked = of_paper(points[(points.frequency_ratio == RESONATOR) & ~is_exact(points)])
    keys = list(asked[KEY].drop_duplicates().itertuples(index=False, name=None))
    keys.sort(key=lambda key: key[1:4] != (REFERENCE.engine, str(REFERENCE.formulation), REFERENCE.preset_name))
    known = bands(points, edges)
    groups = dict(iter(known.groupby(KEY, sort=False)))
    return {key: groups.get(key, known.iloc[:0]).set_index("friction_ratio") for key in keys}


def answers(own: pd.DataFrame) -> tuple[Answer, Answer, Answer]:
    """Answer the claims by the bands of one configuration, by friction ratio."""
    return _wider(own), _locked(own), _widest(own)


def _wider(own: pd.DataFrame) -> Answer:
    needed = (0.0, *UP_TO)
    if lacking := _lacking(own, needed):
        return OPEN, lacking, ""
    low = [f for f in UP_TO if own.lower[f] < own.lower[0.0] - MOVED]
    wide = [f for f in UP_TO if own.share[f] > own.share[0.0] + _share(MOVED)]
    numbers = f"lower edge {_listed(own, needed)}; {_uppers(own, needed)}; {_shares(own, needed)}"
    holds = "the band is wider than without friction up to a friction ratio of 0.6"
    narrow = _numbers(f for f in UP_TO if f not in wide)
    fails = f"the band is not wider than without friction at {narrow}"
    return _by_both(low == [*UP_TO], wide == [*UP_TO], numbers, holds, fails)


def _locked(own: pd.DataFrame) -> Answer:
    needed = (UP_TO[-1], *BEYOND)
    if lacking := _lacking(own, needed, stuck=BEYOND):
        return OPEN, lacking, ""
    rises = all(after > before + MOVED for before, after in itertools.pairwise(own.lower[f] for f in needed))
    slides = [f for f in BEYOND if own.stuck[f] < LOCKED]
    stuck = ", ".join(f"{own.stuck[f]:.2f} at {f:g}" for f in BEYOND)
    numbers = f"stuck fraction at η_r = {RESONATOR:g}: {stuck}; lower edge {_listed(own, needed)}"
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
    largest = bool((own.share[WIDEST] > others.share + _share(MOVED)).all())
    numbers = f"lower edge {_listed(own, FRICTION_RATIOS)}; {_shares(own, FRICTION_RATIOS)}"
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


def _share(width: float) -> float:
    return width / (RANGE[1] - RANGE[0])


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


def _listed(own: pd.DataFrame, needed: Sequence[float]) -> str:
    return ", ".join(f"{edge_text(own.lower[f])} at {f:g}" for f in needed)


def _uppers(own: pd.DataFrame, needed: Sequence[float]) -> str:
    """Give the upper edges, and up to where the other bands have none."""
    edges = [f"{edge_text(own.upper[f])} at {f:g}" for f in needed if math.isfinite(own.upper[f])]
    without = [f for f in needed if math.isinf(own.upper[f])]
    if without:
        edges.append(f"none up to {min(own['last'][f] for f in without):g} at {_numbers(without)}")
    return f"upper edge {', '.join(edges)}"


def _shares(own: pd.DataFrame, needed: Sequence[float]) -> str:
    shares = ", ".join(f"{own.share[f]:.0%} at {f:g}" for f in needed).replace("%", " %")
    return f"share of η_r {RANGE[0]:g} to {RANGE[1]:g}: {shares}"
