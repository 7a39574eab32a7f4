"""What the command ``sweep`` does: answer what is missing, print how it ended, write what the store knows."""

import pandas as pd
import xarray as xr

from engines.interface.variant import Variant
from scenarios.execution.evaluator import Evaluator
from scenarios.execution.executor import Executor
from scenarios.execution.progress import Bars, CountingEvaluator
from scenarios.execution.store import ResultStore
from scenarios.sweeps.adaptive import AdaptiveSweep, run_adaptive_sweep
from scenarios.sweeps.spec_file import SweepFile
from scenarios.sweeps.summary import SweepSummary
from scenarios.sweeps.sweep import STATUSES, Sweep, dataset, run_sweep
from scenarios.sweeps.verdicts import Verdicts, verdicts
from scenarios.tables import print_table
from scenarios.verdicts.verdict import Verdict

PARTS = (0.5, 0.99, 1.0)
"""Parts of the points whose number of periods is printed: median, 99 % and all."""


def answer_sweep(asked: SweepFile, kept: ResultStore, executor: Executor) -> SweepSummary:
    """Answer what the store does not know, with bars on the way."""
    variants = asked.sweep.variants
    if asked.frequencies is not None:
        adaptive = AdaptiveSweep(asked.sweep, asked.frequencies)
        start = list(adaptive.start())
        with Bars(variants) as bars, CountingEvaluator(kept, executor, start, bars) as counting:
            return run_adaptive_sweep(adaptive, counting)
    with Bars(variants) as bars, Evaluator(kept, executor) as evaluator:
        for variant in variants:
            bars.expect(variant, asked.sweep.points // len(variants))
        evaluator.progress, evaluator.recalled = bars.advance, bars.recall
        return run_sweep(asked.sweep, evaluator)


def grid_of(asked: SweepFile, kept: ResultStore) -> Sweep:
    """Give the sweep with all its frequencies: of an adaptive one those that the store knows."""
    if asked.frequencies is None:
        return asked.sweep
    return AdaptiveSweep(asked.sweep, asked.frequencies).grid_of(kept)


def dataset_of(asked: SweepFile, kept: ResultStore) -> xr.Dataset:
    """Give what the store knows, labelled; of an adaptive sweep over the frequencies of all curves together.

    Where a curve had no need of a frequency its points are ``missing``; to draw it, leave out what is NaN.
    """
    return dataset(grid_of(asked, kept), kept)


def print_summary(asked: SweepFile, summary: SweepSummary) -> None:
    """Print how the points of every variant ended, the periods that they took, and every reason once."""
    rows = []
    for variant in asked.sweep.variants:
        row = {str(status): str(summary.statuses[variant, status]) for status in STATUSES[:-1]}
        periods = [summary.quantile_of_periods(variant, part) for part in PARTS]
        row["periods: median, 99 %, most"] = ", ".join("–" if number is None else str(number) for number in periods)
        if asked.frequencies is not None:
            row["curves unresolved"] = str(summary.unresolved[variant])
        rows.append({"engine:formulation:preset": str(variant), **row})
    print_table(pd.DataFrame(rows))
    for (variant, reason), count in sorted(summary.reasons.items(), key=_by_variant):
        print(f"{variant}: {count} point{'s' if count > 1 else ''}: {reason}")


def print_verdicts(asked: SweepFile, kept: ResultStore) -> None:
    """Print how every variant compares with the reference, if the file has a tolerance for it."""
    if asked.tolerance_db is None:
        return
    print_table(
        pd.DataFrame(
            [
                [str(variant), *(str(found.counts[verdict]) for verdict in Verdict), *_worst(found)]
                for variant, found in verdicts(grid_of(asked, kept), kept, asked.tolerance_db).items()
            ],
            columns=["engine:formulation:preset", *map(str, Verdict), "largest [dB]", "at friction, frequency"],
        )
    )


def _worst(found: Verdicts) -> list[str]:
    """Largest difference and its place, as text."""
    if found.largest is None:
        return ["–", "–"]
    difference, question = found.largest
    return [f"{difference:.3g}", f"{question.friction_ratio:g}, {question.frequency_ratio:.4g}"]


def _by_variant(item: tuple[tuple[Variant, str], int]) -> tuple[Variant, int]:
    """Sort by variant, the commonest reason first."""
    (variant, _), count = item
    return variant, -count
