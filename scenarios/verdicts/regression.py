"""Changes from one store to another, closer to the truth or farther from it: two versions of an engine, two options."""

import math
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

import numpy as np

from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.verdicts.finding import TRANSMITTANCE, phase_reader
from multibody_xval.scenarios.verdicts.judge import metric_difference
from multibody_xval.scenarios.verdicts.stored import Compute, StoredResult, StoredTruth, read_all, truths_of
from multibody_xval.scenarios.verdicts.thresholds import Thresholds
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

NUMBERS = (
    "transmittance_db", "phase", "residual", "period", "stuck_fraction", "creep", "open_fraction", "largest_gap",
)  # fmt: skip
"""Numbers of a result, one or one a contact, that may not be lost."""

TRANSITION_TIME = "time of a transition"
"""Beside them; a transition that is gone is one without a partner."""

MOTIONS = ("response", "slip", "swing", "offsets", "outer", "inner")
"""Series of displacements over the displacement scale, see `scenarios.runs.transient` and `RecordedPeriod`."""

LENGTHS = ("largest_gap", "highest", "distance", "reference", "travels")
"""Other numbers over the displacement scale: gaps, distances from a law after a period, ways between transitions."""

PARTS = ("creep", "open_fraction", "open", "stuck", "energy")
"""Parts of a whole: of the drive's velocity, of the time, of the initial energy. All further series are compared over
the largest number of either."""

NOT_COMPARED = {
    "amplification": "how the steady state was found",
    "periods": "how the steady state was found",
    "steps_per_period": "how the steady state was found",
    "seconds": "not a number of the motion",
    "friction": "jumps at transitions, whose times are compared",
    "modes": "change at transitions, whose times are compared",
}
"""Numbers and series that may change, with the reason."""

BEST_FIRST = (
    (ResultStatus.CONVERGED, ResultStatus.FINISHED),
    (ResultStatus.PERIOD_LIMIT,),
    (ResultStatus.DIVERGED,),
    (ResultStatus.BLOCKED,),
    (ResultStatus.MISSING,),
)
"""How much a result says by its status."""


class TruthDirection(StrEnum):
    """Where a change leads."""

    IMPROVED = "improved"
    """The error is smaller than before, by more than the threshold."""
    UNCHANGED = "unchanged"
    """The errors before and now differ by less than the threshold: to the other side of the truth, say."""
    UNKNOWN = "unknown"
    """The truth is not known."""
    REGRESSED = "regressed"
    """The error is larger than before, by more than the threshold."""
    MISSING = "missing"
    """The result, or a number of it, is no longer there."""

    @property
    def fails(self) -> bool:
        """Whether a point that has changed so is a failure."""
        return self in (TruthDirection.UNKNOWN, TruthDirection.REGRESSED, TruthDirection.MISSING)


@dataclass(frozen=True)
class Measure:
    """A number by which two steady states, or two motions, of one task differ."""

    name: str
    distance: Callable[[Result, Result], float]
    """Gives the difference of two results; NaN where one of them lacks the number."""
    threshold: float
    pattern: str
    """How people read a change of it, by `str.format`."""


def measures(thresholds: Thresholds, old: Result, new: Result) -> list[Measure]:
    """Give what is compared of two motions (`FINISHED`), or of two steady states."""
    either = {*old.series, *new.series, "creep", "open_fraction", "largest_gap"}
    further = [_further(thresholds, name) for name in sorted(either - {*MOTIONS, *NOT_COMPARED})]
    motion = Measure("motion", _motion_difference, thresholds.motion, "motion {:.3g} of its scale")
    if new.status is ResultStatus.FINISHED:
        return [motion, *further]
    part = 10 ** (thresholds.transmittance_db / 20) - 1
    return [
        Measure("transmittance", transmittance_difference, thresholds.transmittance_db, "transmittance {:+.4g} dB"),
        Measure("phase", _phase_difference, math.degrees(part), "phase {:+.3g}°"),
        Measure("residual", lambda result, other: result.residual - other.residual, part, "residual {:+.2g}"),
        Measure("multiple", lambda result, other: result.multiple - other.multiple, 0.0, "{:+.0f} periods to repeat"),
        Measure("stuck fraction", Result.stuck_difference, thresholds.stuck_fraction, "stuck fraction {:.3g}"),
        Measure("transition", _lateness, thresholds.transition, "a transition {:.2g} periods away"),
        Measure("unmatched", _unmatched, 0.0, "{:.0f} transitions without a partner"),
        Measure(
            "period", lambda result, other: result.period / other.period - 1, thresholds.transition, "period {:+.2g}"
        ),
        motion,
        *further,
    ]


def _further(thresholds: Thresholds, name: str) -> Measure:
    """Give how a series, or a number a contact, is compared that has no measure of its own."""
    relative = name not in (*LENGTHS, *PARTS)

    def distance(result: Result, other: Result) -> float:
        one, two = _numbers(result).get(name, np.empty(0)), _numbers(other).get(name, np.empty(0))
        largest = _largest_difference(one, two)
        return largest / float(np.nanmax(np.abs([*one, *two]))) if relative and largest > 0 else largest

    unit = " of its scale" if name in LENGTHS else " of its largest" if relative else ""
    limit = thresholds.stuck_fraction if name in PARTS else thresholds.motion
    return Measure(name.replace("_", " "), distance, limit, f"{name.replace('_', ' ')} {{:.3g}}{unit}")


def _largest_difference(one: FloatArray, two: FloatArray) -> float:
    """Give the largest difference of numbers that both have; NaN where their lengths differ."""
    if len(one) != len(two):
        return math.nan
    both = np.isfinite(one) & np.isfinite(two)
    return float(np.max(np.abs(one[both] - two[both]), initial=0.0))


def transmittance_difference(result: Result, other: Result) -> float:
    """Give the first transmittance less the second, on the scale of `TRANSMITTANCE` [dB]."""
    return metric_difference(TRANSMITTANCE, result.transmittance_db, other.transmittance_db)


def _phase_difference(result: Result, other: Result) -> float:
    """Give the difference [°], which counts less below the floor of `TRANSMITTANCE`."""
    read = phase_reader(other.phase, other.transmittance_db)
    return read(result) - read(other)


def _lateness(result: Result, other: Result) -> float:
    """Give the largest difference of the times of matched transitions, over the period; zero without any."""
    return max(map(abs, result.matched(other.transitions).time_errors), default=0.0)


def _unmatched(result: Result, other: Result) -> float:
    """Give the number of transitions of either that the other one does not have."""
    return result.matched(other.transitions).unmatched


def _motion_difference(result: Result, other: Result) -> float:
    """Give the largest difference of `MOTIONS` at any time; NaN where one of them has none of the other's."""
    names = [name for name in MOTIONS if name in {*result.series} & {*other.series}]
    both = [_largest_difference(np.array(result.series[name]), np.array(other.series[name])) for name in names]
    return float(np.max(both)) if both else math.nan


@dataclass(frozen=True)
class Shift:
    """A number that has changed by more than its threshold."""

    measure: Measure
    change: float
    before: float = math.nan
    now: float = math.nan
    """Its difference from the truth; NaN where that is not known."""

    @property
    def direction(self) -> TruthDirection:
        """Where it leads."""
        worse = self.now - self.before
        if math.isnan(worse):
            return TruthDirection.UNKNOWN
        if abs(worse) <= self.measure.threshold:
            return TruthDirection.UNCHANGED
        return TruthDirection.REGRESSED if worse > 0 else TruthDirection.IMPROVED

    def __str__(self) -> str:
        return self.measure.pattern.format(self.change)


@dataclass(frozen=True)
class Change:
    """One task of the first store."""

    first: StoredResult
    second: StoredResult
    """The results; a lost one is ``missing``."""
    differences: Mapping[str, float]
    """Second less first by the name of a `Measure`; empty unless both have numbers."""
    shifts: tuple[Shift, ...] = ()
    lost: tuple[str, ...] = ()
    gained: str = ""
    """How the result says more than before, in words; empty where it does not."""
    truth: StoredTruth | None = None
    """What the numbers are held to; ``None`` where it is not known, or nothing has shifted."""

    @property
    def variant(self) -> str:
        """Engine, formulation and preset."""
        return self.first.variant

    @property
    def beyond(self) -> tuple[str, ...]:
        """Changes that pass a threshold, in words; empty where nothing does."""
        shifts = (f"{shift}, {shift.direction}" for shift in self.shifts)
        return (*self.lost, *([self.gained] if self.gained else []), *shifts)

    @property
    def direction(self) -> TruthDirection | None:
        """Where the worst of the changes leads; ``None`` without any."""
        directions = {shift.direction for shift in self.shifts}
        directions |= {TruthDirection.MISSING} if self.lost else set()
        directions |= {TruthDirection.IMPROVED} if self.gained else set()
        return max(directions, key=list(TruthDirection).index, default=None)

    def fails(self, *, strict: bool = False) -> bool:
        """Whether the point is a failure; a strict comparison takes every change for one."""
        return self.direction is not None and (strict or self.direction.fails)

    @property
    def uncertified(self) -> bool:
        """Whether the search for a steady state gave up before and now, so that no number is compared."""
        statuses = {self.first.result.status, self.second.result.status}
        return not self.differences and statuses <= {ResultStatus.PERIOD_LIMIT, ResultStatus.DIVERGED}

    @property
    def transmittance_db(self) -> float:
        """Second less first [dB]; NaN where there is none."""
        return self.differences.get("transmittance", math.nan)

    def error_db(self, stored: StoredResult) -> float:
        """Give the error of one of the results [dB]; NaN where it, or the truth, is not known."""
        return math.nan if self.truth is None else abs(transmittance_difference(stored.result, self.truth.result))

    def judged(self, truth: StoredTruth | None) -> "Change":
        """Hold what has shifted to the truth."""
        if truth is None:
            return self
        old, new, right = self.first.result, self.second.result, truth.result
        shifts = tuple(
            replace(
                shift,
                before=abs(shift.measure.distance(old, right)),
                now=abs(shift.measure.distance(new, right)),
            )
            for shift in self.shifts
        )
        return replace(self, shifts=shifts, truth=truth)


@dataclass(frozen=True)
class StoreComparison:
    """The differences of two stores."""

    changes: tuple[Change, ...]
    """Tasks whose results both hold, and those that the second store has lost, in the order of the first."""
    only_second: Mapping[str, int]
    """Number of tasks whose results only the second store holds, by variant."""

    @property
    def beyond(self) -> list[Change]:
        """Changes that pass a threshold: what fails first, and of that the largest difference of transmittance."""
        beyond = [change for change in self.changes if change.direction is not None]
        return sorted(beyond, key=_by_severity)

    def failing(self, *, strict: bool = False) -> list[Change]:
        """Give those of `beyond` that are failures."""
        return [change for change in self.beyond if change.fails(strict=strict)]


def _by_severity(change: Change) -> tuple[int, float]:
    severity = -1 if change.direction is None else list(TruthDirection).index(change.direction)
    size = abs(change.transmittance_db)
    return -severity, -math.inf if math.isnan(size) else -size


def compare_stores(
    first: Path, second: Path, thresholds: Thresholds | None = None, compute: Compute | None = None
) -> StoreComparison:
    """Compare two stores, task by task; `compute` gives exact motions where neither has them.

    Stores without a common task, or of different formats, are refused.
    """
    a, b = read_all(first), read_all(second)
    _refuse(first, second, a, b)
    limits = thresholds or Thresholds()
    missing = Result.missing()
    changes = [change(a[task], b.get(task) or replace(a[task], result=missing), limits) for task in a]
    truths = truths_of([own.first.task for own in changes if own.shifts], [*a.values(), *b.values()], compute)
    return StoreComparison(
        changes=tuple(own.judged(truths.get(own.first.key())) for own in changes),
        only_second=Counter(stored.variant for task, stored in b.items() if task not in a),
    )


def _refuse(first: Path, second: Path, a: Mapping[str, StoredResult], b: Mapping[str, StoredResult]) -> None:
    """Refuse stores that cannot be compared."""
    common = a.keys() & b.keys()
    if not common:
        raise ParameterError(f"{first} and {second} have no task in common; allowed: stores of the same points")
    for task in common:
        if a[task].format != b[task].format:
            formats = f"{first} has results of format {a[task].format}, {second} of format {b[task].format}"
            raise ParameterError(f"{formats}: their numbers mean different things; allowed: stores of one format")


def change(first: StoredResult, second: StoredResult, thresholds: Thresholds) -> Change:
    """Compare two results of the same task; a blocked one has nothing to lose."""
    old, new = first.result, second.result
    if old.status is ResultStatus.BLOCKED:
        return Change(first, second, {})
    ranks = _rank(old), _rank(new)
    status = f"{old.status} before, {new.status} now" if old.status != new.status else ""
    if ranks[1] > ranks[0]:
        reason = f": {new.reason}" if new.status is ResultStatus.BLOCKED else ""
        return Change(first, second, {}, lost=(f"{status}{reason}",))
    lost = _lost_numbers(old, new)
    if lost or not _comparable(old, new):
        return Change(first, second, {}, lost=lost, gained=status)
    distances = [(measure, measure.distance(new, old)) for measure in measures(thresholds, old, new)]
    return Change(
        first,
        second,
        {measure.name: distance for measure, distance in distances},
        tuple(Shift(measure, distance) for measure, distance in distances if abs(distance) > measure.threshold),
        gained=status or _gained_numbers(old, new),
    )


def _rank(result: Result) -> int:
    """Give how little a result says."""
    return next(rank for rank, statuses in enumerate(BEST_FIRST) if result.status in statuses)


def _comparable(old: Result, new: Result) -> bool:
    """Whether the numbers of a motion, or a new steady state can be compared with those before, certified or not."""
    if new.status is ResultStatus.FINISHED:
        return old.status is ResultStatus.FINISHED
    return new.converged and old.status in (ResultStatus.CONVERGED, ResultStatus.PERIOD_LIMIT)


def _lost_numbers(old: Result, new: Result) -> tuple[str, ...]:
    """Say which numbers are no longer there, or no longer finite."""
    lost = []
    after = _numbers(new)
    for name, before in _numbers(old).items():
        now = after.get(name, np.empty(0))
        both = min(len(before), len(now))
        if np.any(np.isfinite(before[:both]) & ~np.isfinite(now[:both])):
            lost.append(f"{name.replace('_', ' ')} is no longer finite")
        elif len(now) < len(before) and (len(now) == 0 or name != "travels") and name != TRANSITION_TIME:
            lost.append(f"{name.replace('_', ' ')} is no longer complete")
    return tuple(lost)


def _gained_numbers(old: Result, new: Result) -> str:
    """Say which numbers are there that were not, or not as many."""
    before = _numbers(old)
    longer = [
        name.replace("_", " ")
        for name, now in _numbers(new).items()
        if len(now) > len(before.get(name, ())) and name not in (TRANSITION_TIME, "travels")
    ]
    return f"more of {', '.join(longer)}" if longer else ""


def _numbers(result: Result) -> dict[str, FloatArray]:
    """Give `NUMBERS`, the times of all transitions and the series of a result, as arrays by name."""
    named = {name: np.atleast_1d(getattr(result, name)) for name in NUMBERS}
    times = np.array([time for _, time, _ in result.transitions])
    return {**named, TRANSITION_TIME: times, **{name: np.array(values) for name, values in result.series.items()}}
