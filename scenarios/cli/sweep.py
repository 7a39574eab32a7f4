"""What the command ``sweep`` does: run what is missing, and print summaries."""

import sys
from collections.abc import Sequence
from pathlib import Path

import pandas as pd
import typer

from engines.interface.variant import Variant
from reference_lcp.compilation import announce_compilation
from reference_lcp.exit_code import ExitCode
from reference_lcp.interrupt import announce_interrupt
from reference_lcp.visible import visible
from scenarios.execution.evaluator import Evaluator
from scenarios.execution.executor import Executor
from scenarios.execution.progress import CountingEvaluator, ProgressBars
from scenarios.execution.storage.store import ResultStore
from scenarios.execution.storage.store_file import existing_store
from scenarios.sweeps.dataset import STATUSES, sweep_dataset, write_dataset
from scenarios.sweeps.noted import note_sweep
from scenarios.sweeps.refinement import ForTheAccuracy
from scenarios.sweeps.run import refined_tasks, run_sweep, stored_table
from scenarios.sweeps.size import check_size, size_text
from scenarios.sweeps.spec_file import read_sweep
from scenarios.sweeps.summary import SweepSummary, VerdictSummary, verdict_summaries
from scenarios.sweeps.sweep import Sweep
from scenarios.sweeps.table import Point, points_of
from scenarios.tables import print_table
from scenarios.verdicts.finding import TRANSMITTANCE
from scenarios.verdicts.pointwise import refinements
from scenarios.verdicts.verdict import Verdict

PARTS = (0.5, 0.99, 1.0)
"""Parts of the points whose number of periods is printed: median, 99 % and all."""


def planned_sweep(file: Path, *, ask: bool, yes: bool, out: Path | None) -> Sweep:
    """Read a sweep, before any work.

    Raises
    ------
    ParameterError
        If the file is wrong, or the sweep has more points than are run without `yes`, or than fit into memory.
    """
    planned = read_sweep(file)
    whole = _whole(planned, out)
    if ask or whole:
        check_size(planned, yes=yes and not whole, how="--yes, without --out and [tolerances]")
    return planned


def perform(planned: Sweep, store: Path, out: Path | None, executor: Executor | None, *, retry_blocked: bool) -> None:
    """Run what the store lacks, or nothing without an executor; print summaries, and write the results."""
    with ResultStore(existing_store(store) if executor is None else store) as stored:
        if executor is not None:
            announce_compilation()
            print(size_text(planned), file=sys.stderr)
            note_sweep(stored, planned)
            try:
                print_summary(planned, evaluate_sweep(planned, stored, executor, retry_blocked=retry_blocked))
            except KeyboardInterrupt:
                announce_interrupt(f"interrupted: results are kept in {store}; the same command goes on from there")
                raise typer.Exit(ExitCode.INTERRUPTED) from None
        if not _whole(planned, out):
            return
        judged, table = stored_table(planned, stored)
        print_verdicts(judged, points_of(table))
        if out is not None:
            write_dataset(sweep_dataset(judged, table, store), out)


def _whole(planned: Sweep, out: Path | None) -> bool:
    """Say whether all results are in memory together."""
    return out is not None or planned.tolerance is not None


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
