"""``multibody-xval report``: run or read a sweep, and write the page about it."""

from __future__ import annotations

import gc
import shlex
from dataclasses import dataclass, replace
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.engines.completion import complete_variant
from multibody_xval.reports.cli.options import ENGINE_HELP, NAME_METAVAR, Engines, Settings, Work, grouped, keeping
from reference_lcp.errors import ExitCode, ParameterError
from reference_lcp.terminal import announce_compilation, print_table, visible

if TYPE_CHECKING:
    from multibody_xval.reports.write import Written

RARE_COLLECTIONS = (200_000, 20, 100)
"""Thresholds of Python's collector of cycles: searching millions of live results and curves takes an eighth of
the time of a report of 20,000 points with the default threshold of 700 objects."""

FOLDER = typer.Option(help="Folder of the page and its files; made if it is missing.")

app = typer.Typer(name="multibody-xval report", add_completion=False, pretty_exceptions_enable=False)


@dataclass(frozen=True)
class Shown:
    """What a page shows."""

    quick: Annotated[
        bool, typer.Option("--quick", help="Take a small grid: the whole report takes a minute and a half.")
    ] = False
    chosen: Annotated[
        list[str] | None,
        typer.Option(
            "--engine",
            metavar=NAME_METAVAR,
            help=f"{ENGINE_HELP}Without it: the engines that come with the suite, tuned and default.",
            autocompletion=complete_variant,
        ),
    ] = None
    settings: Settings = None
    sweep: Annotated[
        Path | None, typer.Option(help="Sweep file with engines, chain and grid; multibody-xval example prints one.")
    ] = None
    data: Annotated[
        Path | None, typer.Option(help="Dataset of a sweep (NetCDF); its results are shown, and nothing is run.")
    ] = None
    proof: Annotated[
        bool,
        typer.Option(
            "--proof",
            help="Prove the truth of points that the suite's table of proven levels does not have, some seconds each.",
        ),
    ] = False


@app.command()
@grouped
def report(
    *,
    out: Annotated[Path, FOLDER] = Path("report"),
    shown: Shown,
    store: Annotated[
        Path | None, typer.Option(help="File that stores every result; without it, results.sqlite in --out.")
    ] = None,
    run: Annotated[
        bool,
        typer.Option(
            "--run/--no-run", help="Run missing points; --no-run shows only stored results, and names missing ones."
        ),
    ] = True,
    verbose: Annotated[bool, typer.Option("--verbose", help="Print all engines, and verdicts by variant.")] = False,
    work: Work,
) -> None:
    """Compare every engine with the reference on the frictional chain, and write a page about it.

    Without --engine and --sweep, joints are compared on the whole grid: tuned ones, and default ones that a law
    predicts everywhere. Contacts and other defaults are shown at a few points, without a verdict, and never change the
    exit code.

    Results are stored: a second run takes seconds, and an interrupted run continues.
    Exit code 0: the page is written, and every disagreement is as its law predicts; 1: the page is written, and a
    disagreement is unmodelled, too few points of a variant are certified, or its engine fails; 2: wrong input;
    3: results or the page could not be written; 130: interrupted.

    Example: multibody-xval report --quick --engine mujoco --engine mujoco:contact --engine mujoco:joint:default
    """
    work.check(run=run)
    names = Engines(shown.chosen, shown.settings).names
    started = monotonic()
    written = _written(shown, names, out, store, work, run=run)
    _print_end(written, monotonic() - started, verbose=verbose)
    if written.report.failures:
        raise typer.Exit(ExitCode.FAILED)


MOST_ROWS = 9
"""Engines in the table at the end, the farthest from the truth first; one line more names how many are left out."""


def _print_end(written: Written, seconds: float, *, verbose: bool) -> None:
    """Print what each engine comes to, why the comparison fails, and the line that says whether it does."""
    from multibody_xval.reports.data.options import TITLES
    from multibody_xval.scenarios import tables
    from multibody_xval.scenarios.catalogue.verdict_table import verdict_table
    from multibody_xval.scenarios.verdicts.finding import engine_failures

    report = written.report
    if verbose and report.result.findings:
        tables.print_table(verdict_table(report.result.findings))
    rows = [(row.variant.title, " → ".join(row.texts)) for row in report.headlines]
    shown = rows if verbose else rows[:MOST_ROWS]
    if rows:
        print_table(("largest error [dB]", " → ".join(TITLES.values())), shown)
    if len(shown) < len(rows):
        print(f"and {len(rows) - len(shown)} more, with --verbose")
    for line in (*engine_failures(report.result.findings), *report.failures):
        print(visible(line))
    print(visible(f"{report.status}; {seconds:.0f} s; {written.page}"))


def _written(shown: Shown, names: list[str], out: Path, store: Path | None, work: Work, *, run: bool) -> Written:
    """Write the report of a dataset, of which nothing is run, or of a sweep."""
    gc.set_threshold(*RARE_COLLECTIONS)
    _check_proof(shown, run=run)
    if shown.data is not None:
        return _dataset_written(shown, names, out, shown.data)
    executor = work.executor()
    if run and not (store or out).exists():
        executor.warm_up()  # while this process imports and plans
    from multibody_xval.reports.plan import planned_report
    from multibody_xval.reports.write import STORE, check_folder, write_sweep_report
    from multibody_xval.scenarios.runs.store import existing_store

    kept = store or out / STORE
    planned = planned_report(names, shown.sweep, quick=shown.quick, stored_in=None if run else kept)
    announce_compilation()
    if not run:
        existing_store(kept)
    check_folder("--out", out, [kept, shown.sweep])
    with keeping(kept):
        return write_sweep_report(
            planned.sweep, out, planned.command + " --proof" * shown.proof,
            store=kept, run=run, scope=replace(planned.scope, proof=shown.proof), executor=executor,
            retry_blocked=work.retry_blocked, keep_old=work.keep_old,
        )  # fmt: skip


def _dataset_written(shown: Shown, names: list[str], out: Path, file: Path) -> Written:
    from multibody_xval.reports.plan import PROGRAM
    from multibody_xval.reports.write import write_dataset_report
    from multibody_xval.scenarios.sweeps.dataset_reader import read_dataset

    if shown.sweep or names or shown.quick:
        raise ParameterError("--data holds its sweep; allowed beside it: neither --sweep, --engine nor --quick")
    return write_dataset_report(read_dataset(file), out, shlex.join([*PROGRAM, "--data", str(file)]), file)


def _check_proof(shown: Shown, *, run: bool) -> None:
    """Refuse proofs where nothing is computed, or without the package that they need."""
    from reference_lcp.defaults import PROOF_TIME_LIMIT, PROVEN_DIGITS
    from reference_lcp.exact.proof.prove import check_request

    if not shown.proof:
        return
    if shown.data is not None or not run:
        raise ParameterError("--proof computes; allowed with it: neither --data nor --no-run")
    check_request(PROVEN_DIGITS, PROOF_TIME_LIMIT)
