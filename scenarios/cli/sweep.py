"""What the command ``sweep`` does: run what is missing, and print summaries."""

from collections.abc import Sequence

import pandas as pd

from engines.interface.variant import Variant
from reference_lcp.visible import visible
from scenarios.execution.evaluator import Evaluator
from scenarios.execution.executor import Executor
from scenarios.execution.progress import CountingEvaluator, ProgressBars
from scenarios.execution.store import ResultStore
from scenarios.sweeps.dataset import STATUSES
from scenarios.sweeps.refinement import ForTheAccuracy
from scenarios.sweeps.run import refined_tasks, run_sweep
from scenarios.sweeps.summary import SweepSummary, VerdictSummary, verdict_summaries
from scenarios.sweeps.sweep import Sweep
from scenarios.sweeps.table import Point
from scenarios.tables import print_table
from scenarios.verdicts.finding import TRANSMITTANCE
from scenarios.verdicts.pointwise import refinements
from scenarios.verdicts.verdict import Verdict

PARTS = (0.5, 0.99, 1.0)
"""Parts of the points whose number of periods is printed: median, 99 % and all."""


def evaluate_sweep(
    sweep: Sweep, store: ResultStore, executor: Executor, *, judged: bool = False, retry_blocked: bool = False
) -> SweepSummary:
    """Run what the store does not hold, with progress bars; for verdicts, with other numbers of steps too.

    For `retry_blocked` see `Evaluator`.
    """
    if sweep.frequencies is not None:
        start = [sweep.task(*point) for point in ForTheAccuracy(sweep).due()]
        with (
            ProgressBars(sweep.variants) as bars,
            CountingEvaluator(store, executor, start, bars, retry_blocked=retry_blocked) as counting,
        ):
            return run_sweep(sweep, counting)
    with ProgressBars(sweep.variants) as bars, Evaluator(store, executor, retry_blocked=retry_blocked) as evaluator:
        for variant in sweep.variants:
            others = len(refinements(variant, sweep.tolerance)) if judged else 0
            bars.expect(variant, sweep.points // len(sweep.variants) * (1 + others))
        evaluator.progress, evaluator.recalled = bars.advance, bars.recall
        summary = run_sweep(sweep, evaluator)
        if judged:
            evaluator.complete(refined_tasks(sweep))
        return summary


def print_summary(sweep: Sweep, summary: SweepSummary) -> None:
    """Print how the points of every variant ended, the periods that they took, and every reason once."""
    rows = []
    for variant in sweep.variants:
        row = {str(status): str(summary.statuses[variant, status]) for status in STATUSES[:-1]}
        periods = [summary.quantile_of_periods(variant, part) for part in PARTS]
        row["periods: median, 99 %, most"] = ", ".join("–" if number is None else str(number) for number in periods)
        if sweep.frequencies is not None:
            row["curves unresolved"] = str(summary.unresolved[variant])
        rows.append({"engine:formulation:preset": str(variant), **row})
    print_table(pd.DataFrame(rows))
    for (variant, reason), count in sorted(summary.reasons.items(), key=_by_variant):
        print(visible(f"{variant}: {count} point{'s' if count > 1 else ''}: {reason}"))


def print_verdicts(sweep: Sweep, points: Sequence[Point]) -> None:
    """Print how every variant compares with the reference, if the file has a tolerance for it."""
    if sweep.tolerance is None:
        return
    axes = ", ".join([*(name.removesuffix("_ratio").replace("_", " ") for name in sweep.case_axes), "frequency"])
    rows = [
        [str(variant), *(str(summary.counts[verdict]) for verdict in Verdict), *_worst(summary)]
        for variant, summary in verdict_summaries(sweep, points).items()
    ]
    headings = ["engine:formulation:preset", *map(str, Verdict), "largest [dB]", f"at {axes}"]
    print_table(pd.DataFrame(rows, columns=headings))


def _worst(summary: VerdictSummary) -> list[str]:
    """Largest difference and its axes, as text."""
    if summary.largest is None:
        return ["–", "–"]
    point = summary.largest
    return [f"{abs(point.difference(TRANSMITTANCE)):.3g}", f"{point.case.numbers}, {point.frequency_ratio:.4g}"]


def _by_variant(item: tuple[tuple[Variant, str], int]) -> tuple[Variant, int]:
    """Sort by variant, the commonest reason first."""
    (variant, _), count = item
    return variant, -count
