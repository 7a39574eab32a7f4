"""Proofs of the canonical chain's steady states on the standard grids: of the table of levels that is shipped."""

import io
import math
import random
from collections.abc import Iterable, Sequence
from csv import writer
from dataclasses import dataclass
from decimal import ROUND_HALF_EVEN, Decimal
from statistics import median_high

from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.deadline import NotProven
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.exact.proof.prove import ProvenSteadyState, Uniqueness, prove
from reference_lcp.one_call import steady_state
from reference_lcp.validation import checked_count
from scenarios.runs.parameters import ChainRatios, OperatingPoint
from scenarios.studies.accuracy import ACCURACY_POINTS
from scenarios.studies.figure3 import (
    FRICTION_RATIOS,
    QUICK_FRICTION_RATIOS,
    default_frequency_ratios,
    quick_frequency_ratios,
)
from scenarios.sweeps.proven import DIGITS, RADIUS, ProvenLevel, proven_levels
from scenarios.tables import Column
from scenarios.verdicts.finding import FLOOR_DB

EDGES = (
    (0.0, 0.8526), (0.0, 1.4142), (0.1, 0.7533), (0.3, 0.6373), (0.6, 0.7559), (1.0, 0.9988), (5.0, 1.1725)
)  # fmt: skip
"""Band edges of figure 3, friction and frequency ratio; all but the second are lower ones."""

RESOLVED = {
    0.0: (0.85955,),
    0.1: (0.7625, 0.775),
    0.3: (0.63, 0.634, 0.64, 0.642, 0.66, 0.6625, 0.67, 0.675, 0.68, 0.6875, 0.69),
    0.6: (0.7625, 0.775, 0.7875, 0.80675, 0.822625, 0.83175, 0.840875, 0.85955, 0.87645, 0.8843),
    1.0: (0.92315, 0.925, 0.975, 0.9875, 1.0125, 1.025, 1.0375),
    5.0: (1.1625, 1.175, 1.1875, 1.27095, 1.281425, 1.3125, 1.325),
}
"""Frequency ratios that both reports add near the threshold, by friction ratio: see `attenuation_band.unresolved`."""

EDGE_WIDTH = 1e-4
"""In η_r, within which an edge is proven: the last digit that is printed."""


@dataclass(frozen=True)
class Proof:
    """What came of the proof of one point, beside the event-driven motion in floating point."""

    point: OperatingPoint
    proven: ProvenSteadyState | None
    reason: str
    """Why it is not proven; empty where it is."""
    float_db: float
    """Transmittance of the event-driven motion [dB]."""
    scheme_db: float
    bar_db: float
    """That of the scheme, with its error bar [dB]."""

    @property
    def level(self) -> ProvenLevel | None:
        """The row of the table; ``None`` without a proof."""
        if self.proven is None:
            return None
        level, phase = (_kept(each.value) for each in (self.proven.transmittance_db, self.proven.phase))
        return ProvenLevel(level, phase, len(self.proven.transitions))

    @property
    def in_table(self) -> bool:
        """Whether the shipped table has just this: the same digits, or none where there is no proof."""
        known, own = proven_levels().get(self.point), self.level
        if known is None or own is None:
            return known is own
        close = abs(known.transmittance_db - own.transmittance_db) <= RADIUS and abs(known.phase - own.phase) <= RADIUS
        return close and known.events == own.events

    @property
    def float_error_db(self) -> float:
        """How far floating point is from what is proven [dB]; NaN below `FLOOR_DB`, where dB say nothing."""
        return self._error_of(self.float_db)

    @property
    def part_of_bar(self) -> float:
        """Error of the scheme over its error bar; NaN likewise."""
        return self._error_of(self.scheme_db) / self.bar_db

    def _error_of(self, level_db: float) -> float:
        if self.proven is None or self.proven.transmittance_db.value < FLOOR_DB:
            return math.nan
        return float(abs(Decimal(level_db) - self.proven.transmittance_db.value))


def _kept(value: Decimal) -> Decimal:
    return value.quantize(RADIUS, ROUND_HALF_EVEN)


def standard_points() -> list[OperatingPoint]:
    """Give the points of the default and the quick report, and those of `studies.accuracy`."""
    ratios = ChainRatios()
    grids = (
        (FRICTION_RATIOS, default_frequency_ratios(ratios)),
        (QUICK_FRICTION_RATIOS, quick_frequency_ratios(ratios)),
    )
    gridded = (OperatingPoint(friction, eta) for frictions, etas in grids for friction in frictions for eta in etas)
    resolved = (OperatingPoint(friction, eta) for friction, etas in RESOLVED.items() for eta in etas)
    return sorted({*gridded, *resolved, *ACCURACY_POINTS})


def chosen_points(sample: int | None, seed: int) -> list[OperatingPoint]:
    """Give all standard points, or a random sample of so many."""
    points = standard_points()
    if sample is None:
        return points
    return sorted(random.Random(seed).sample(points, checked_count("sample", sample, 1, len(points))))


def proof_of(point: OperatingPoint) -> Proof:
    """Prove one point, in the decimals as which its ratios are printed."""
    chain = Chain.from_ratios(friction_ratio=point.friction_ratio)
    drive = HarmonicBase.from_ratio(chain, point.frequency_ratio)
    scheme = steady_state(chain, drive, with_exact_value=True)
    bar = math.nan if scheme.error_bar is None else scheme.error_bar.transmittance_db
    in_floats = math.nan if scheme.exact_db is None else scheme.exact_db
    exact = ExactChain.from_ratios(friction_ratio=point.friction_ratio, frequency_ratio=point.frequency_ratio)
    try:
        proven, reason = prove(exact, digits=DIGITS + 1), ""
    except NotProven as problem:
        proven, reason = None, str(problem)
    return Proof(point, proven, reason, in_floats, scheme.transmittance_db, bar)


@dataclass(frozen=True)
class EdgeProof:
    """What is proven of a band edge: the levels on both sides of it."""

    friction_ratio: float
    sides: tuple[float, float]
    """In η_r."""
    levels_db: tuple[Decimal, Decimal]

    @property
    def crosses(self) -> bool:
        """Whether the level crosses 0 dB in between: it is continuous, since the steady state is unique."""
        return self.levels_db[0] * self.levels_db[1] < 0


def edge_proofs() -> list[EdgeProof]:
    """Prove the levels at both sides of every edge in `EDGES`."""
    return [
        EdgeProof(friction, sides, (_level(friction, sides[0]), _level(friction, sides[1])))
        for friction, edge in EDGES
        for sides in [(round(edge - EDGE_WIDTH / 2, 6), round(edge + EDGE_WIDTH / 2, 6))]
    ]


def _level(friction_ratio: float, frequency_ratio: float) -> Decimal:
    exact = ExactChain.from_ratios(friction_ratio=friction_ratio, frequency_ratio=frequency_ratio)
    return prove(exact).transmittance_db.value


def table_text(proofs: Sequence[Proof]) -> str:
    """Give the table as CSV."""
    file = io.StringIO()
    table = writer(file, lineterminator="\n")
    table.writerow([*OperatingPoint._fields, *ProvenLevel._fields])
    table.writerows([*proof.point, *proof.level] for proof in proofs if proof.level is not None)
    return file.getvalue()


def by_friction(proofs: Sequence[Proof]) -> list[list[Proof]]:
    """Give the proofs of each friction ratio, and of all of them."""
    ratios = sorted({proof.point.friction_ratio for proof in proofs})
    parts = [[proof for proof in proofs if proof.point.friction_ratio == ratio] for ratio in ratios]
    return [*parts, list(proofs)] if len(parts) > 1 else parts


def _proven(proofs: Sequence[Proof]) -> list[ProvenSteadyState]:
    return [proof.proven for proof in proofs if proof.proven is not None]


def _title(proofs: Sequence[Proof]) -> str:
    ratios = {proof.point.friction_ratio for proof in proofs}
    return "all" if len(ratios) > 1 else f"{ratios.pop():g}"


def _seconds(proofs: Sequence[Proof]) -> list[float]:
    return [state.seconds for state in _proven(proofs)] or [math.nan]


def _largest(values: Iterable[float]) -> float:
    return max((value for value in values if not math.isnan(value)), default=math.nan)


PROOF_COLUMNS: list[Column[list[Proof]]] = [
    Column("friction_ratio", _title, "friction"),
    Column("points", len),
    Column("proven", lambda proofs: len(_proven(proofs))),
    Column("unique", lambda proofs: sum(state.unique_by is Uniqueness.DAMPING for state in _proven(proofs))),
    Column("in_table", lambda proofs: sum(proof.in_table for proof in proofs), "as in the table"),
    Column("events", lambda proofs: max((len(state.transitions) for state in _proven(proofs)), default=0)),
    Column(
        "largest_radius_db",
        lambda proofs: _largest(float(state.transmittance_db.radius) for state in _proven(proofs)),
        "radius [dB]",
        "{:.0e}",
    ),
    Column(
        "largest_float_error_db",
        lambda proofs: _largest(proof.float_error_db for proof in proofs),
        "floats [dB]",
        "{:.1e}",
    ),
    Column(
        "largest_part_of_bar",
        lambda proofs: _largest(proof.part_of_bar for proof in proofs),
        "over bar",
        "{:.2f}",
    ),
    Column("median_s", lambda proofs: median_high(_seconds(proofs)), "median [s]", "{:.2f}"),
    Column("largest_s", lambda proofs: _largest(_seconds(proofs)), "largest [s]", "{:.2f}"),
]
