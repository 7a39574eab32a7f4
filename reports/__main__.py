"""``python -m reports``: one page on every engine, with its figures and tables; cards, scripts, animations."""

if __name__ == "__main__":
    from reference_lcp.interrupt import heed_interrupts

    heed_interrupts()

# isort: split
import gc
import sys
from pathlib import Path
from typing import Annotated

import typer

from reference_lcp.console import run_command
from reference_lcp.refusal import ParameterError
from reports.cli.animate import animate
from reports.cli.card import card
from reports.cli.compare import compare
from reports.cli.reproduce import reproduce
from scenarios.cli.options import Limit, Retry, Scheduler, Workers, check_retry
from scenarios.execution.limits import TIME_LIMIT

RARE_COLLECTIONS = (200_000, 20, 100)
"""Thresholds of Python's collector of cycles: searching millions of live results and curves takes an eighth of
the time of a report of 20,000 points with the default threshold of 700 objects."""

app = typer.Typer(name="python -m reports", add_completion=False, pretty_exceptions_enable=False)
app.command()(compare)
app.command()(animate)
app.command()(reproduce)
app.command()(card)


@app.callback(invoke_without_command=True)
def report(
    context: typer.Context,
    out: Annotated[Path, typer.Option(help="Folder of the page and its files; made if it is missing.")] = Path(
        "report"
    ),
    quick: Annotated[bool, typer.Option("--quick", help="A small grid: the whole report in under a minute.")] = False,
    chosen: Annotated[
        list[str] | None,
        typer.Option(
            "--engine",
            metavar="NAME[:FORMULATION[:PRESET]]",
            help="An engine to compare, in the formulation joint and the preset tuned unless others are named; "
            "may be repeated. Without it: those that come with the suite, tuned and default; all: every one.",
        ),
    ] = None,
    sweep: Annotated[
        Path | None,
        typer.Option(help="File of a sweep (python -m scenarios example) that names engines, chain and grid."),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(help="Dataset of a sweep as NetCDF: what it holds is shown, nothing is run."),
    ] = None,
    store: Annotated[
        Path | None, typer.Option(help="File that keeps every result; without it, results.sqlite in --out.")
    ] = None,
    ask: Annotated[
        bool, typer.Option(help="Run what the store lacks; --no-ask shows what there is, and lists what is missing.")
    ] = True,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
    scheduler: Scheduler = None,
    retry_blocked: Retry = False,
) -> None:
    """Compare every engine with the reference on the frictional chain, and write a page about it.

    Without --engine and --sweep: joints on the whole grid, tuned and, where a law predicts it everywhere, default;
    contacts and other defaults at a few points, without a verdict: they never change the exit code.

    Results are kept: a second run takes seconds, and an interrupted one goes on where it was.
    Exit code 0: the page is written, and every disagreement, if there is any, is as its law predicts; 1: it is
    written, and not so, or too little of a variant is certified; 2: wrong input; 3: results or the page could not be
    kept; 130: interrupted.

    Example: python -m reports --quick --engine mujoco --engine mujoco:contact --engine mujoco:joint:default
    """
    if context.invoked_subcommand is not None:
        return
    check_retry(ask, retry_blocked)
    from reports.cli.report import command_of, default_scope, planned_sweep, report_of_dataset, report_of_sweep

    if data is not None:
        if sweep is not None or chosen or quick:
            raise ParameterError("--data holds its sweep; allowed beside it: neither --sweep, --engine nor --quick")
        report_of_dataset(data, out)
        return
    from reports.data.collect import QUICK, Scope
    from scenarios.execution.dask_cluster import executor_for

    planned = planned_sweep(chosen, sweep, quick=quick)
    scope = (QUICK if quick else Scope()) if chosen or sweep else default_scope(planned, quick=quick)
    executor = executor_for(workers, time_limit, scheduler)
    report_of_sweep(
        planned, out, store, executor, command_of(chosen, quick, sweep), file=sweep,
        scope=scope, ask=ask, retry_blocked=retry_blocked,
    )  # fmt: skip


if __name__ == "__main__":
    gc.set_threshold(*RARE_COLLECTIONS)
    sys.exit(run_command(app))
