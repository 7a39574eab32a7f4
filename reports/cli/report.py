"""``multibody-xval report``: run or read a sweep, and write the page about it."""

from __future__ import annotations

import gc
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from engines.completion import complete_variant
from reference_lcp.errors import ExitCode, ParameterError
from reference_lcp.process import announce_interrupt
from reference_lcp.terminal import visible
from reports.cli.options import (
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
from scenarios.runs import TIME_LIMIT

if TYPE_CHECKING:
    from reports.write import Written

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
    Path | None, typer.Option(help="Sweep file with engines, chain and grid; multibody-xval example prints one.")
]
Dataset = Annotated[
    Path | None, typer.Option(help="Dataset of a sweep (NetCDF); its results are shown, and nothing is run.")
]
Store = Annotated[Path | None, typer.Option(help="File that stores every result; without it, results.sqlite in --out.")]
Run = Annotated[
    bool,
    typer.Option(
        "--run/--no-run", help="Run missing points; --no-run shows only stored results, and names missing ones."
    ),
]

app = typer.Typer(name="multibody-xval report", add_completion=False, pretty_exceptions_enable=False)


@app.command()
def report(
    out: Folder = Path("report"),
    quick: Quick = False,
    chosen: Chosen = None,
    settings: Settings = None,
    sweep: SweepFile = None,
    data: Dataset = None,
    store: Store = None,
    run: Run = True,
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

    Example: multibody-xval report --quick --engine mujoco --engine mujoco:contact --engine mujoco:joint:default
    """
    check_retry(run, retry_blocked)
    names = with_settings(chosen, settings)
    from reference_lcp.terminal import announce_compilation
    from reports.plan import planned_report
    from reports.write import STORE, check_folder, write_sweep_report
    from scenarios.runs.dask_cluster import executor_for
    from scenarios.runs.store import existing_store

    if data is not None:
        _report_of_dataset(data, out, alone=not (sweep or names or quick))
        return
    gc.set_threshold(*RARE_COLLECTIONS)
    kept = store or out / STORE
    planned = planned_report(names, sweep, quick=quick, stored_in=None if run else kept)
    executor = executor_for(workers, time_limit, scheduler)
    announce_compilation()
    if not run:
        existing_store(kept)
    check_folder("--out", out, [kept, sweep])
    try:
        written = write_sweep_report(
            planned.sweep, out, planned.command,
            store=kept, run=run, scope=planned.scope, executor=executor, retry_blocked=retry_blocked,
        )  # fmt: skip
    except KeyboardInterrupt:
        announce_interrupt(f"interrupted: results are kept in {kept}; the same command goes on from there")
        raise typer.Exit(ExitCode.INTERRUPTED) from None
    _end(written)


def _report_of_dataset(data: Path, out: Path, *, alone: bool) -> None:
    """Write the report of a dataset, which has to be `alone`; nothing is run."""
    from reports.plan import PROGRAM
    from reports.write import write_dataset_report
    from scenarios.sweeps.dataset_reader import read_dataset

    if not alone:
        raise ParameterError("--data holds its sweep; allowed beside it: neither --sweep, --engine nor --quick")
    _end(write_dataset_report(read_dataset(data), out, shlex.join([*PROGRAM, "--data", str(data)]), data))


def _end(written: Written) -> None:
    """Print the page, the verdicts, and why the comparison fails, which is the exit code then."""
    from scenarios.catalogue.verdict_table import verdict_table
    from scenarios.tables import print_table

    print(written.page)
    if written.findings:
        print_table(verdict_table(written.findings))
    for line in written.failures:
        print(visible(line))
    if written.failures:
        raise typer.Exit(ExitCode.FAILED)
