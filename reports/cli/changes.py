"""What ``python -m reports compare`` does: compare two stores, print what changed, and write every point."""

from collections.abc import Sequence
from pathlib import Path

import typer
from rich.console import Console

from reference_lcp.exit_code import ExitCode
from reference_lcp.output import write_whole
from reports.export.changes import (
    CHANGE_FORMATS,
    PRINTED_COLUMNS,
    Regression,
    counted_by_variant,
    identities,
)
from scenarios.cli.evaluation import evaluator_of_run
from scenarios.execution.limits import TIME_LIMIT
from scenarios.execution.workers.dask_cluster import executor_for
from scenarios.tables import plain, print_table, text_table
from scenarios.tasks.result import Result
from scenarios.tasks.task import Task
from scenarios.verdicts.regression import compare_stores
from scenarios.verdicts.steady_case import EXACT
from scenarios.verdicts.thresholds import Thresholds

MOST_ROWS = 20
"""Changed points that are printed; a file holds all of them."""


def print_changes(
    first: Path, second: Path, thresholds: Thresholds, outs: Sequence[Path], *, strict: bool, exact: bool
) -> None:
    """Compare two stores point by point; ends with the exit code of the command.

    Parameters
    ----------
    first, second, thresholds
        As for `compare_stores`.
    outs
        Files that are written, in the format of their ending.
    strict
        Whether every change is a failure.
    exact
        Whether exact motions that neither store has are computed.

    Raises
    ------
    ParameterError
        If they have no task in common, or cannot be compared.
    """
    comparison = compare_stores(first, second, thresholds, _computed if exact else None)
    regression = Regression(comparison, str(first), str(second), thresholds, strict)
    _print(regression)
    for out in outs:
        write_whole(out, CHANGE_FORMATS[out.suffix](regression))
    raise typer.Exit(ExitCode.FAILED if regression.failing else ExitCode.DONE)


def _computed(tasks: Sequence[Task]) -> list[Result]:
    """Compute exact motions, which are not kept."""
    with evaluator_of_run(None, executor_for(None, TIME_LIMIT, None), [EXACT]) as evaluator:
        return evaluator.evaluate(tasks)


def _print(regression: Regression) -> None:
    console = Console()
    for line in (*counted_by_variant(regression.comparison), *identities(regression.comparison)):
        console.print(plain(line), soft_wrap=True)
    shown = regression.comparison.beyond[:MOST_ROWS]
    for variant in dict.fromkeys(change.variant for change in shown):
        own = [change for change in shown if change.variant == variant]
        print_table(text_table(PRINTED_COLUMNS, own), title=variant)
    left = len(regression.comparison.beyond) - len(shown)
    if left:
        console.print(f"{left} more changed points; --out writes all of them")
    console.print(plain(regression.summary), soft_wrap=True)
