"""``python -m reports``: one page on every engine, with its figures and tables; comparisons and animations."""

if __name__ == "__main__":
    from reference_lcp.interrupt import heed_interrupts

    heed_interrupts()

# isort: split
import gc
import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from engines.interface.registry import default_engine_names, engine_names
from engines.interface.variant import Variant
from reference_lcp.console import run_command
from reference_lcp.exit_code import ExitCode
from reference_lcp.interrupt import announce_interrupt
from reference_lcp.validation import ParameterError
from reference_lcp.visible import visible
from reports.cli.animate import animate
from reports.cli.compare import compare
from reports.data.collect import QUICK, Scope
from reports.write import STORE, Written, check_folder, write_dataset_report, write_sweep_report
from scenarios.cli.options import Limit, Retry, Scheduler, Workers, check_retry
from scenarios.execution.dask_cluster import executor_for
from scenarios.execution.executor import TIME_LIMIT
from scenarios.execution.store_file import existing_store
from scenarios.studies.figure3 import (
    FRICTION_RATIOS,
    QUICK_FRICTION_RATIOS,
    default_frequency_ratios,
    figure3,
    quick_frequency_ratios,
)
from scenarios.sweeps.dataset_file import read_dataset
from scenarios.sweeps.size import check_size
from scenarios.sweeps.spec_file import read_sweep
from scenarios.sweeps.sweep import Sweep
from scenarios.tasks.parameters import ChainRatios

RARE_COLLECTIONS = (200_000, 20, 100)
"""Thresholds of Python's collector of cycles: searching millions of live results and curves takes an eighth of
the time of a report of 20,000 points with the default threshold of 700 objects."""

PROGRAM = ("python", "-m", "reports")

app = typer.Typer(name="python -m reports", add_completion=False, pretty_exceptions_enable=False)
app.command()(compare)
app.command()(animate)


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
            "may be repeated. Without it: the engines that come with the suite; all: every one that is registered.",
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

    Results are kept: a second run takes seconds, and an interrupted one goes on where it was.
    Exit code 0: the page is written, and every disagreement, if there is any, is as its law predicts; 1: it is
    written, and not so, or too little of a variant is certified; 2: wrong input; 3: results or the page could not be
    kept; 130: interrupted.

    Example: python -m reports --quick --engine mujoco --engine mujoco:contact --engine mujoco:joint:default
    """
    if context.invoked_subcommand is not None:
        return
    check_retry(ask, retry_blocked)
    if data is not None:
        if sweep is not None or chosen or quick:
            raise ParameterError("--data holds its sweep; allowed beside it: neither --sweep, --engine nor --quick")
        _end(write_dataset_report(read_dataset(data), out, shlex.join([*PROGRAM, "--data", str(data)]), data))
        return
    planned = _figure3(_names(chosen), quick) if sweep is None else _sweep(sweep, chosen, quick)
    executor = executor_for(workers, time_limit, scheduler)
    store = store if store is not None else out / STORE
    if not ask:
        existing_store(store)
    check_folder("--out", out, [store, sweep])
    try:
        written = write_sweep_report(
            planned, out, _command(chosen, quick, sweep), store=store, ask=ask, scope=QUICK if quick else Scope(),
            executor=executor, retry_blocked=retry_blocked,
        )  # fmt: skip
    except KeyboardInterrupt:
        announce_interrupt(f"interrupted: results are kept in {store}; the same command goes on from there")
        raise typer.Exit(ExitCode.INTERRUPTED) from None
    _end(written)


def _end(written: Written) -> None:
    """Print the page and why its comparison fails, which is the exit code then."""
    print(written.page)
    for line in written.failures:
        print(visible(line))
    if written.failures:
        raise typer.Exit(ExitCode.FAILED)


def _names(chosen: list[str] | None) -> list[str]:
    """Give the names of the compared engines."""
    if not chosen:
        return default_engine_names()
    return [full for name in chosen for full in (engine_names() if name == "all" else [name])]


def _figure3(names: list[str], quick: bool) -> Sweep:
    """Give the sweep of Figure 3."""
    ratios = ChainRatios()
    return figure3(
        variants=tuple(Variant.parse(name) for name in names),
        friction_ratios=QUICK_FRICTION_RATIOS if quick else FRICTION_RATIOS,
        frequency_ratios=quick_frequency_ratios(ratios) if quick else default_frequency_ratios(ratios),
        ratios=ratios,
    )


def _sweep(file: Path, chosen: list[str] | None, quick: bool) -> Sweep:
    """Read a sweep from its file."""
    if chosen or quick:
        raise ParameterError("--sweep names engines and grid; allowed beside it: neither --engine nor --quick")
    planned = read_sweep(file).with_reference()
    check_size(planned)
    return planned


def _command(chosen: list[str] | None, quick: bool, sweep: Path | None) -> str:
    """Give the command that gives the same numbers; the folder of the report is left out."""
    options = ["--quick"] if quick else []
    for name in chosen or []:
        options += ["--engine", name]
    if sweep is not None:
        options += ["--sweep", str(sweep)]
    return shlex.join([*PROGRAM, *options])


if __name__ == "__main__":
    gc.set_threshold(*RARE_COLLECTIONS)
    sys.exit(run_command(app))
