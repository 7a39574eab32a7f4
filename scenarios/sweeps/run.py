"""Sweeps as they are: run with what their verdicts need, summed up, and saved in the store of their results."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.evaluator import Evaluator, StoredResults
from multibody_xval.scenarios.runs.executor import Executor
from multibody_xval.scenarios.runs.parameters import first_error
from multibody_xval.scenarios.runs.progress import ProgressBars
from multibody_xval.scenarios.runs.result import Result, ResultStatus, repetition
from multibody_xval.scenarios.runs.store import ResultStore, existing_store
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.sweeps.checks import check_models
from multibody_xval.scenarios.sweeps.dataset import SWEEP
from multibody_xval.scenarios.sweeps.point import Point, judged, tasks_of
from multibody_xval.scenarios.sweeps.predictions import predicted
from multibody_xval.scenarios.sweeps.refinement import ForTheAccuracy, refined
from multibody_xval.scenarios.sweeps.sweep import GridPoint, Sweep, baseline_of
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED
from reference_lcp.errors import ParameterError


@dataclass
class SweepSummary:
    """Counts over all points; the points themselves are in the store."""

    statuses: Counter[tuple[Variant, ResultStatus]] = field(default_factory=Counter)
    reasons: Counter[tuple[Variant, str]] = field(default_factory=Counter)
    """Points without a steady state by variant and reason."""
    periods: Counter[tuple[Variant, int]] = field(default_factory=Counter)
    """Points with a steady state by variant and number of periods."""
    unresolved: Counter[Variant] = field(default_factory=Counter)
    """Curves of an adaptive grid, by variant, that ended at its least spacing or at its most points."""

    def add(self, variant: Variant, ended: Result) -> None:
        """Count a point."""
        self.statuses[variant, ended.status] += 1
        if ended.status == ResultStatus.CONVERGED:
            self.periods[variant, ended.periods] += 1
        else:
            self.reasons[variant, reason_of(ended)] += 1

    def quantile_of_periods(self, variant: Variant, part: float) -> int | None:
        """Give the fewest periods that suffice for this part of the points with a steady state; ``None`` without."""
        counts = sorted((periods, count) for (owner, periods), count in self.periods.items() if owner == variant)
        if not counts:
            return None
        reached = np.cumsum([count for _, count in counts])
        return counts[int(np.searchsorted(reached, part * reached[-1]))][0]


def reason_of(ended: Result) -> str:
    """Give the reason why a point has no steady state, in words."""
    if ended.status == ResultStatus.PERIOD_LIMIT:
        return f"period limit{repetition(ended.multiple)}"
    return ended.reason or ended.status


def compared_points(sweep: Sweep, points: Iterable[Point]) -> dict[Variant, list[Point]]:
    """Give the judged points of every variant but the baseline, where both are evaluated."""
    baseline = baseline_of(sweep.variants)
    if baseline is None:
        return {}
    known = {point.place: point for point in points if point.result.status is not ResultStatus.MISSING}
    compared: dict[Variant, list[Point]] = {variant: [] for variant in sweep.variants if variant != baseline}
    for place, point in known.items():
        if point.variant in compared and (baseline, *place[1:]) in known:
            compared[point.variant].append(point)
    return compared


def evaluate_sweep(
    sweep: Sweep, store: ResultStore, executor: Executor, *, verdicts: bool, retry_blocked: bool = False
) -> SweepSummary:
    """Run what the store lacks of a sweep, with progress bars; for its `verdicts`, what they need beside the points.

    That is other numbers of steps, where the converged reference takes part, and the laws of variants that disagree.
    Without verdicts, neither points nor results are in memory together.
    """
    compared = verdicts and CONVERGED in sweep.variants
    start: list[SteadyStateTask] = []
    if sweep.frequencies is not None:
        start = [sweep.task(*point) for point in ForTheAccuracy(sweep).due()]
    elif verdicts:
        start = tasks_of(sweep, list(sweep.grid_points())) if compared else list(sweep.tasks())
    with (
        ProgressBars(sweep.variants, start) as bars,
        Evaluator(store, executor, bars, retry_blocked=retry_blocked) as evaluator,
    ):
        if not start:
            for variant in sweep.variants:
                bars.expect_points(variant, sweep.points // len(sweep.variants))
        evaluator.stage("points")
        summary = run_sweep(sweep, evaluator)
        if compared:
            evaluator.stage("other numbers of steps")
            check_models(*_chosen(sweep, StoredResults(store)), evaluator)
        if verdicts:
            evaluator.stage("laws of variants that disagree")
            predicted(*stored_points(sweep, store), evaluator)
        return summary


def run_sweep(sweep: Sweep, evaluator: Evaluator) -> SweepSummary:
    """Evaluate what the store does not hold yet; every result is on disk the moment it is there.

    On an adaptive axis, every curve chooses its own points, a curve being one variant in one case.
    """
    summary = SweepSummary()
    if sweep.frequencies is None:
        evaluator.complete(sweep.tasks(), lambda task, ended: summary.add(task.variant, ended))
        return summary
    accuracy = ForTheAccuracy(sweep)
    for (variant, _, _), result in refined(sweep, accuracy.due(), accuracy, evaluator).items():
        summary.add(variant, result)
    for (variant, _), curve in accuracy.curves.items():
        summary.unresolved[variant] += not curve.resolved
    return summary


def stored_points(sweep: Sweep, store: ResultStore) -> tuple[Sweep, list[Point]]:
    """Give the results of a sweep in a store as judged points, and the sweep with all their frequency ratios."""
    evaluator = StoredResults(store)
    whole, places = _chosen(sweep, evaluator)
    points, _ = check_models(whole, places, evaluator)
    return whole, predicted(whole, judged(points), evaluator)


def _chosen(sweep: Sweep, evaluator: StoredResults) -> tuple[Sweep, list[GridPoint]]:
    """Give the points of a sweep, and the sweep with all their frequency ratios.

    On an adaptive axis, they are the points of every curve, as far as the results that are known choose them.
    """
    if sweep.frequencies is None:
        return sweep, list(sweep.grid_points())
    accuracy = ForTheAccuracy(sweep)
    places = list(refined(sweep, accuracy.due(), accuracy, evaluator))
    etas = tuple(sorted({eta for _, _, eta in places}))
    return replace(sweep, axes={**sweep.axes, "frequency_ratio": etas}), places


def save_sweep(store: ResultStore, sweep: Sweep) -> None:
    """Write a sweep into the store of its results, as the latest one."""
    store.note(SWEEP.dump_json(sweep).decode())


@dataclass(frozen=True)
class SavedSweeps:
    """What a store knows of the sweeps whose results it holds."""

    sweep: Sweep
    """The latest one, with the variants of all others of the same points."""
    others: tuple[Sweep, ...] = ()


def saved_sweeps(file: Path) -> SavedSweeps:
    """Give the sweeps that were saved in a store."""
    with ResultStore(existing_store(file)) as store:
        store.check_pages()
        texts = store.saved()
    if not texts:
        raise ParameterError(f"store {file} holds no sweep; allowed: a store of a sweep or of a report")
    merged: list[Sweep] = []
    for text in texts:
        read = _read(file, text)
        same = next((n for n, each in enumerate(merged) if _points(each) == _points(read)), None)
        if same is None:
            merged.append(read)
        else:
            variants = dict.fromkeys((*merged[same].variants, *read.variants))
            merged[same] = replace(merged[same], variants=tuple(variants))
    return SavedSweeps(merged[0], tuple(merged[1:]))


def _read(file: Path, text: str) -> Sweep:
    try:
        return SWEEP.validate_json(text)
    except ValidationError as problem:
        error = first_error(problem, "what a sweep that was saved has")
        raise ParameterError(f"store {file}: its sweep cannot be read: {error}") from None


def _points(sweep: Sweep) -> dict[str, Any]:
    """Give everything of a sweep but its variants, whatever the order of its values."""
    content = vars(sweep.ascending())
    return {each.name: content[each.name] for each in fields(Sweep) if each.name != "variants"}
