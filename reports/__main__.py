"""``python -m reports``: a page that compares engines, with figures and tables; cards, scripts, animations."""

if __name__ == "__main__":
    from reference_lcp.interrupt import heed_interrupts
    from reference_lcp.shadow import refuse_shadows

    heed_interrupts()
    refuse_shadows()

# isort: split
import gc
import sys
from pathlib import Path
from typing import Annotated

import typer

from engines.completion import complete_variant
from reference_lcp.console import run_command
from reports.cli.animate import animate
from reports.cli.card import card
from reports.cli.compare import compare
from reports.cli.reproduce import reproduce
from scenarios.cli.options import (
    ENGINE_HELP,
    NAME_METAVAR,
    Limit,
    Retry,
    Scheduler,
    Settings,
    Workers,
    check_retry,
    with_settings,
)
from scenarios.execution.limits import TIME_LIMIT

RARE_COLLECTIONS = (200_000, 20, 100)
"""Thresholds of Python's collector of cycles: searching millions of live results and curves takes an eighth of
the time of a report of 20,000 points with the default threshold of 700 objects."""

Folder = Annotated[Path, typer.Option(help="Folder of the page and its files; made if it is missing.")]
Quick = Annotated[bool, typer.Option("--quick", help="Take a small grid: the whole report takes about a minute.")]
Chosen = Annotated[
    list[str] | None,
    typer.Option(
        "--engine",
        metavar=NAME_METAVAR,
        help=f"{ENGINE_HELP}Without it: the engines that come with the suite, tuned and default.",
        autocompletion=complete_variant,
    ),
]
SweepFile = Annotated[
    Path | None, typer.Option(help="Sweep file with engines, chain and grid; python -m scenarios example prints one.")
]
Dataset = Annotated[
    Path | None, typer.Option(help="Dataset of a sweep (NetCDF); its results are shown, and nothing is run.")
]
Store = Annotated[Path | None, typer.Option(help="File that stores every result; without it, results.sqlite in --out.")]
Ask = Annotated[
    bool, typer.Option(help="Run missing points; --no-ask shows only stored results, and names missing ones.")
]

app = typer.Typer(name="python -m reports", add_completion=False, pretty_exceptions_enable=False)
app.command()(compare)
app.command()(animate)
app.command()(reproduce)
app.command()(card)


@app.callback(invoke_without_command=True)
def report(
    context: typer.Context,
    out: Folder = Path("report"),
    quick: Quick = False,
    chosen: Chosen = None,
    settings: Settings = None,
    sweep: SweepFile = None,
    data: Dataset = None,
    store: Store = None,
    ask: Ask = True,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
    scheduler: Scheduler = None,
    retry_blocked: Retry = False,
) -> None:
    """Compare every engine with the reference on the frictional chain, and write a page about it.

    Without --engine and --sweep, joints are compared on the whole grid: tuned ones, and default ones that a law
    predicts everywhere. Contacts and other defaults are shown at a few points, without a verdict, and never change the
    exit code.

    Results are stored: a second run takes seconds, and an interrupted run continues.
    Exit code 0: the page is written, and every disagreement is as its law predicts; 1: the page is written, and a
    disagreement is unexplained or too few points of a variant are certified; 2: wrong input; 3: results or the page
    could not be written; 130: interrupted.

    Example: python -m reports --quick --engine mujoco --engine mujoco:contact --engine mujoco:joint:default
    """
    if context.invoked_subcommand is not None:
        return
    check_retry(ask, retry_blocked)
    names = with_settings(chosen, settings)
    from reports.cli import report as command
    from reports.write import STORE

    if data is not None:
        command.report_of_dataset(data, out, alone=not (sweep or names or quick))
        return
    planned = command.planned_report(names, sweep, quick=quick, stored_in=None if ask else store or out / STORE)
    from scenarios.execution.workers.dask_cluster import executor_for

    executor = executor_for(workers, time_limit, scheduler)
    command.report_of_sweep(planned, out, store, executor, file=sweep, ask=ask, retry_blocked=retry_blocked)


if __name__ == "__main__":
    gc.set_threshold(*RARE_COLLECTIONS)
    sys.exit(run_command(app))
