"""``python -m reports``: one page on every engine, with its figures and tables; comparisons and animations."""

import gc
import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from engines.interface.registry import default_engine_names, engine_names
from engines.interface.variant import Variant
from reference_lcp.console import INTERRUPTED, checked_output_file, checked_output_folder, run_command
from reference_lcp.validation import ParameterError
from reports.cli.animate import animate
from reports.cli.compare import compare
from reports.data.collect import QUICK, Scope, collect, expected_questions
from reports.data.report import Report
from reports.export.files import FIGURES, FILES, PAGE, files_of, write_all
from scenarios.cli.options import Limit, Scheduler, Workers
from scenarios.execution.dask_cluster import executor_for
from scenarios.execution.evaluator import StoredResults
from scenarios.execution.executor import TIME_LIMIT, Executor
from scenarios.execution.progress import Bars, CountingEvaluator
from scenarios.execution.store import ResultStore
from scenarios.studies.figure3 import (
    FRICTION_RATIOS,
    QUICK_FRICTION_RATIOS,
    Figure3,
    default_frequency_ratios,
    quick_frequency_ratios,
)
from scenarios.sweeps.spec_file import SweepFile, read_sweep
from scenarios.sweeps.verdicts import baseline_of
from scenarios.tasks.parameters import ChainRatios
from scenarios.verdicts.pointwise import GivenTolerance

RARE_COLLECTIONS = (200_000, 20, 100)
"""Thresholds of Python's collector of cycles: looking through millions of live answers and curves takes an eighth of
the time of a report of 20,000 points, at 700 objects a look as usual."""

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
    store: Annotated[
        Path | None, typer.Option(help="File that keeps every answer; without it, results.sqlite in --out.")
    ] = None,
    ask: Annotated[
        bool, typer.Option(help="Answer what the store lacks; --no-ask shows what there is, and says what is missing.")
    ] = True,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
    scheduler: Scheduler = None,
) -> None:
    """Compare every engine with the reference on the frictional chain, and write a page about it.

    Answers are kept: a second run takes seconds, and an interrupted one goes on where it was.
    Exit code 0: the page is written, whatever the verdicts; 2: wrong input.

    Example: python -m reports --quick --engine mujoco --engine mujoco:contact --engine mujoco:joint:default
    """
    if context.invoked_subcommand is not None:
        return
    asked = _asked(_names(chosen), quick) if sweep is None else _asked_by(sweep, chosen, quick)
    executor = executor_for(workers, time_limit, scheduler)
    checked_output_folder("--out", out)
    for file in FILES:
        checked_output_file("output file", out / file)
    checked_output_folder("figures", out / FIGURES)
    store = store if store is not None else out / "results.sqlite"
    if not ask and not store.is_file():
        raise ParameterError(f"--store = {store} does not exist; allowed with --no-ask: a store that is there")
    command = _command(chosen, quick, sweep)
    with ResultStore(store) as kept:
        try:
            found = _collected(asked, kept, executor, command, ask, QUICK if quick else Scope())
        except KeyboardInterrupt:
            print(f"interrupted: answers are kept in {store}; the same command goes on from there", file=sys.stderr)
            raise typer.Exit(INTERRUPTED) from None
    write_all(out, files_of(found))
    print(out / PAGE)


def _names(chosen: list[str] | None) -> list[str]:
    """Say who is compared."""
    if not chosen:
        return default_engine_names()
    return [one for name in chosen for one in (engine_names() if name == "all" else [name])]


def _asked(names: list[str], quick: bool) -> Figure3:
    """Say what is to be run."""
    ratios = ChainRatios()
    return Figure3(
        variants=tuple(Variant.parse(name) for name in names),
        friction_ratios=QUICK_FRICTION_RATIOS if quick else FRICTION_RATIOS,
        frequency_ratios=quick_frequency_ratios(ratios) if quick else default_frequency_ratios(ratios),
        ratios=ratios,
    )


def _asked_by(file: Path, chosen: list[str] | None, quick: bool) -> Figure3:
    """Take what is to be run from the file of a sweep over friction and frequency."""
    if chosen or quick:
        raise ParameterError("--sweep names engines and grid; allowed beside it: neither --engine nor --quick")
    read = read_sweep(file)
    if read.frequencies is not None:
        raise ParameterError(f"{file}: grid.frequency_ratio is adaptive; allowed in a report: values or a range")
    asked = read.sweep
    others = [name for name in asked.axes if name not in ("friction_ratio", "frequency_ratio")]
    if others:
        raise ParameterError(f"{file}: grid.{others[0]} is varied; allowed in a report: friction and frequency ratio")
    return Figure3(
        variants=asked.variants,
        friction_ratios=tuple(sorted(asked.axes["friction_ratio"])),
        frequency_ratios=tuple(sorted(asked.axes["frequency_ratio"])),
        ratios=asked.ratios,
        steps_per_period=asked.steps_per_period,
        excitation=asked.excitation,
        tolerance=_tolerance(read),
    )


def _tolerance(read: SweepFile) -> GivenTolerance | None:
    """Give the tolerance of a file; it compares with whom the command ``sweep`` compares."""
    baseline = baseline_of(read.sweep)
    if read.tolerance_db is None or baseline is None:
        return None
    return GivenTolerance(transmittance_db=read.tolerance_db, baseline=baseline)


def _collected(asked: Figure3, kept: ResultStore, executor: Executor, command: str, ask: bool, scope: Scope) -> Report:
    """Collect everything: with bars on the way, or from the store alone."""
    if not ask:
        return collect(asked, kept, StoredResults(kept), command, scope=scope)
    with (
        Bars(asked.all_variants) as bars,
        CountingEvaluator(kept, executor, expected_questions(asked, scope), bars) as evaluator,
    ):
        return collect(asked, kept, evaluator, command, scope=scope)


def _command(chosen: list[str] | None, quick: bool, sweep: Path | None) -> str:
    """Give the command that asks for the same numbers; where they are written makes no difference."""
    options = ["--quick"] if quick else []
    for name in chosen or []:
        options += ["--engine", name]
    if sweep is not None:
        options += ["--sweep", str(sweep)]
    return shlex.join(["python", "-m", "reports", *options])


if __name__ == "__main__":
    gc.set_threshold(*RARE_COLLECTIONS)
    sys.exit(run_command(app))
