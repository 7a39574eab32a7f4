"""Proofs of steady states, of the standard grids and the catalogue: of the table of levels that is shipped."""

import io
import json
import math
import random
from collections.abc import Iterable, Sequence
from csv import writer
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cache
from itertools import pairwise
from statistics import median_high

from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.steady.base import SteadyScenario
from multibody_xval.scenarios.catalogue.steady.modulated_normal_force import CASE_STEPS, CASES
from multibody_xval.scenarios.report_plan import grid
from multibody_xval.scenarios.runs.parameters import OperatingPoint
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.studies.accuracy_map import MAP, SIX
from multibody_xval.scenarios.tables import Column
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB
from multibody_xval.scenarios.verdicts.proven import (
    DIGITS,
    RADIUS,
    ProvenLevel,
    chain_text,
    exact_chain,
    proven_levels,
    steady_state_of,
)
from multibody_xval.scenarios.verdicts.steady_case import EXACT, MOST_EXACT_CELLS
from reference_lcp.deadline import NotProven
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.exact.proof.prove import ProvenSteadyState, Uniqueness, prove
from reference_lcp.one_call import steady_state
from reference_lcp.validation import checked_count

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
"""Frequency ratios that both reports add near the threshold, by friction ratio: see `edges.hidden`."""

LONGEST_PROOF = 3600.0
"""Seconds after which a proof is given up: fifty cells take minutes."""

EDGE_WIDTH = 1e-4
"""In η_r, within which an edge is proven: the last digit that is printed."""


@dataclass(frozen=True)
class Proof:
    """What came of the proof of one point, beside the event-driven motion in floating point."""

    task: SteadyStateTask
    proven: ProvenSteadyState | None
    reason: str
    """Why it is not proven; empty where it is."""
    float_db: float
    """Transmittance of the event-driven motion [dB]; NaN of modulated normal forces, and of long chains."""
    scheme_db: float
    bar_db: float
    """That of the scheme, with its error bar [dB]; likewise."""

    @property
    def chain(self) -> str:
        """What its chain has beside the canonical one, as JSON."""
        return chain_text(self.task)

    @property
    def label(self) -> str:
        """Its ratios, for people."""
        return f"{self.chain} friction {self.task.friction_ratio}, η_r {self.task.frequency_ratio}".strip()

    @property
    def level(self) -> ProvenLevel | None:
        """The row of the table; ``None`` without a proof."""
        return None if self.proven is None else ProvenLevel.of(self.proven)

    @property
    def in_table(self) -> bool:
        """Whether the shipped table has just this: the same digits, or none where there is no proof."""
        known, own = proven_levels().get(self.task), self.level
        if known is None or own is None:
            return known is own
        close = abs(known.transmittance_db - own.transmittance_db) <= RADIUS and abs(known.phase - own.phase) <= RADIUS
        return close and known.events == own.events

    @property
    def float_error_db(self) -> float:
        """How far floating point is from what is proven [dB]; NaN below `FLOOR_DB`, where dB say nothing."""
        return self._error_of(self.float_db)

    @property
    def float_error(self) -> float:
        """The same in amplitude, over that of the drive, at every level: round-off is that of the drive."""
        if self.proven is None:
            return math.nan
        return float(abs(Decimal(10 ** (self.float_db / 20)) - self.proven.transmittance.value))

    @property
    def part_of_bar(self) -> float:
        """Error of the scheme over its error bar; NaN likewise."""
        return self._error_of(self.scheme_db) / self.bar_db

    def _error_of(self, level_db: float) -> float:
        if self.proven is None or self.proven.transmittance_db.value < FLOOR_DB:
            return math.nan
        return float(abs(Decimal(level_db) - self.proven.transmittance_db.value))


def standard_points() -> list[OperatingPoint]:
    """Give the points of the default and the quick report, and those of the accuracy map."""
    cases = (*grid(quick=False), *grid(quick=True), *MAP, *SIX)
    known = {OperatingPoint(**case.as_data()) for case in cases}
    return sorted(known | {OperatingPoint(friction, eta) for friction, etas in RESOLVED.items() for eta in etas})


def catalogue_tasks() -> list[SteadyStateTask]:
    """Give the steady states of the catalogue whose normal forces are given, and contacts stay closed."""
    steady = [each for each in CATALOGUE.values() if isinstance(each, SteadyScenario)]
    tasks = [case.task(EXACT) for scenario in steady for case in scenario.cases]
    tasks = [task for task in tasks if task.modulation is None]
    return tasks + [case.task(EXACT, CASE_STEPS[0]) for case in CASES if case.modulation <= 1]


def standard_tasks() -> list[SteadyStateTask]:
    """Give all steady states of the table, those of the canonical chain first."""
    gridded = [
        SteadyStateTask(
            variant=EXACT,
            friction_ratio=point.friction_ratio,
            frequency_ratio=point.frequency_ratio,
            steps_per_period=MINIMUM_STEPS_PER_PERIOD,
        )
        for point in standard_points()
    ]
    tasks = dict.fromkeys(steady_state_of(task) for task in (*gridded, *catalogue_tasks()))
    points = {task: (task.friction_ratio, task.frequency_ratio) for task in tasks if not chain_text(task)}
    return [*sorted(points, key=points.__getitem__), *(task for task in tasks if task not in points)]


def chosen_tasks(sample: int | None, seed: int) -> list[SteadyStateTask]:
    """Give all standard tasks, or a random sample of so many."""
    tasks = standard_tasks()
    if sample is None:
        return tasks
    return random.Random(seed).sample(tasks, checked_count("sample", sample, 1, len(tasks)))


def proof_of(task: SteadyStateTask) -> Proof:
    """Prove one steady state, in the decimals as which its ratios are printed."""
    try:
        proven, reason = prove(exact_chain(task), digits=DIGITS + 1, time_limit=LONGEST_PROOF), ""
    except NotProven as problem:
        proven, reason = None, str(problem)
    if task.modulation is not None or task.cells > MOST_EXACT_CELLS:
        return Proof(task, proven, reason, math.nan, math.nan, math.nan)
    scheme = steady_state(*task.setting(), with_exact_value=True)
    bar = math.nan if scheme.error_bar is None else scheme.error_bar.transmittance_db
    in_floats = math.nan if scheme.exact_db is None else scheme.exact_db
    return Proof(task, proven, reason, in_floats, scheme.transmittance_db, bar)


@dataclass(frozen=True)
class EdgeProof:
    """What is proven of a band edge: the levels on both sides of it."""

    friction_ratio: float
    sides: tuple[float, float]
    """In η_r."""
    levels_db: tuple[Decimal, Decimal]
    alone: tuple[float, float] | None
    """Between which frequency ratios the level is nowhere else 0 dB; ``None`` where contacts slip: it is not shown."""

    @property
    def crosses(self) -> bool:
        """Whether the level crosses 0 dB in between: it is continuous, since the steady state is unique."""
        return self.levels_db[0] * self.levels_db[1] < 0

    def __str__(self) -> str:
        where = f"between {self.sides[0]:g} and {self.sides[1]:g}" if self.crosses else f"not at {self.sides}"
        other = (
            f"no other between {self.alone[0]:.5f} and {self.alone[1]:.5f}" if self.alone else "another is not excluded"
        )
        return f"friction {self.friction_ratio:g}: an edge of the band is {where}, proven; {other}"


def edge_proofs() -> list[EdgeProof]:
    """Prove the levels at both sides of every edge in `EDGES`."""
    return [
        EdgeProof(friction, sides, (_level(friction, sides[0]), _level(friction, sides[1])), _alone(friction, sides))
        for friction, edge in EDGES
        for sides in [(round(edge - EDGE_WIDTH / 2, 6), round(edge + EDGE_WIDTH / 2, 6))]
    ]


def _alone(friction_ratio: float, sides: tuple[float, float]) -> tuple[float, float] | None:
    """Give the ratios around both sides between which the linear motion crosses 0 dB once, and no contact slips."""
    for low, high, crossings in _linear(friction_ratio):
        within = [place for place in crossings if sides[0] < place < sides[1]]
        if low < sides[0] and sides[1] < high and len(within) == 1:
            before, after = ([p for p in crossings if p < sides[0]], [p for p in crossings if p > sides[1]])
            return max([low, *before]), min([high, *after])
    return None


def _frequency_ratios() -> list[float]:
    """Give the frequency ratios of the default grid."""
    return sorted({case.frequency_ratio for case in grid(quick=False)})


def known_steps(friction_ratio: float) -> tuple[int, int]:
    """Give in how many steps of the default grid no contact slips, so that all crossings are known; of how many."""
    steps = list(pairwise(_frequency_ratios()))
    ranges = _linear(friction_ratio)
    return sum(any(low <= a and b <= high for low, high, _ in ranges) for a, b in steps), len(steps)


@cache
def _linear(friction_ratio: float) -> list[tuple[float, float, list[float]]]:
    """Give the ranges of the default grid without slip, and the crossings in them, as doubles."""
    from reference_lcp.exact.proof.linear import linear_ranges

    ends = _frequency_ratios()
    exact = ExactChain.from_ratios(friction_ratio=friction_ratio, frequency_ratio=1)
    ranges = linear_ranges(exact, Fraction(str(ends[0])), Fraction(str(ends[-1])))
    return [(float(each.low), float(each.high), [float(place) for place in each.crossings]) for each in ranges]


def _level(friction_ratio: float, frequency_ratio: float) -> Decimal:
    exact = ExactChain.from_ratios(friction_ratio=friction_ratio, frequency_ratio=frequency_ratio)
    return prove(exact).transmittance_db.value


def table_text(proofs: Sequence[Proof]) -> str:
    """Give the table as CSV."""
    file = io.StringIO()
    table = writer(file, lineterminator="\n")
    table.writerow([*OperatingPoint._fields, "chain", *ProvenLevel._fields])
    for proof in proofs:
        if proof.level is not None:
            ratios = (json.dumps(ratio) for ratio in (proof.task.friction_ratio, proof.task.frequency_ratio))
            table.writerow([*ratios, proof.chain, *proof.level])
    return file.getvalue()


def by_chain(proofs: Sequence[Proof]) -> list[list[Proof]]:
    """Give the proofs of each friction ratio of the canonical chain, of other chains, and of all of them."""
    titles = dict.fromkeys(_title([proof]) for proof in proofs)
    parts = [[proof for proof in proofs if _title([proof]) == title] for title in titles]
    return [*parts, list(proofs)] if len(parts) > 1 else parts


def _proven(proofs: Sequence[Proof]) -> list[ProvenSteadyState]:
    return [proof.proven for proof in proofs if proof.proven is not None]


def _title(proofs: Sequence[Proof]) -> str:
    titles = {"other chains" if proof.chain else f"{proof.task.friction_ratio:g}" for proof in proofs}
    return "all" if len(titles) > 1 else titles.pop()


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
    Column("largest_float_error", lambda proofs: _largest(proof.float_error for proof in proofs), "in U0", "{:.0e}"),
    Column(
        "largest_part_of_bar",
        lambda proofs: _largest(proof.part_of_bar for proof in proofs),
        "over bar",
        "{:.2f}",
    ),
    Column("median_s", lambda proofs: median_high(_seconds(proofs)), "median [s]", "{:.2f}"),
    Column("largest_s", lambda proofs: _largest(_seconds(proofs)), "largest [s]", "{:.2f}"),
]
