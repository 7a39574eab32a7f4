"""``multibody-xval sweep``, ``example`` and ``store``: every combination of a file's parameters, and what is stored."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reference_lcp.errors import ExitCode
from reference_lcp.output import checked_output_file
from reference_lcp.terminal import visible
from reports.cli.options import Limit, Retry, Scheduler, Workers, check_out, check_retry
from scenarios.runs import TIME_LIMIT
from scenarios.sweeps import UNCONFIRMED_POINTS

if TYPE_CHECKING:
    from engines.interface.variant import Variant
    from scenarios.runs.executor import Executor
    from scenarios.sweeps.point import Point
    from scenarios.sweeps.run import SweepSummary, VerdictSummary
    from scenarios.sweeps.sweep import Sweep

app = typer.Typer(name="multibody-xval", add_completion=False, pretty_exceptions_enable=False)

PARTS = (0.5, 0.99, 1.0)
"""Parts of the points whose number of periods is printed: median, 99 % and all."""


@app.command()
def example() -> None:
    """Print a commented file of parameters for `sweep`.

    Exit code 0: printed; 2: wrong input; 3: standard output could not be written; 130: interrupted.

    Example: multibody-xval example > sweep.toml
    """
    from scenarios.sweeps.spec_file import EXAMPLE

    print(EXAMPLE, end="")


@app.command()
def sweep(
    file: Annotated[Path, typer.Argument(help="The sweep: a TOML file; `example` prints one.")],
    store: Annotated[
        Path, typer.Option(help="File that stores every result; a stopped sweep continues from it.")
    ] = Path("sweep.sqlite"),
    out: Annotated[
        Path | None,
        typer.Option(help="Write all results of the sweep that are stored: NetCDF as .nc, a table as .csv."),
    ] = None,
    run: Annotated[
        bool, typer.Option("--run/--no-run", help="Run missing points; --no-run writes only stored results.")
    ] = True,
    yes: Annotated[bool, typer.Option("--yes", help=f"Agree to run more than {UNCONFIRMED_POINTS:,} points.")] = False,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
    scheduler: Scheduler = None,
    retry_blocked: Retry = False,
) -> None:
    """Run every combination of the parameters and engines that a file names.

    Exit code 0: every point has a result, or a reason why it has none; 2: wrong input; 3: results or --out could not be
    written; 130: interrupted.

    Example: multibody-xval sweep sweep.toml --out sweep.nc
    """
    check_retry(run, retry_blocked)
    from scenarios.runs.dask_cluster import executor_for
    from scenarios.sweeps.spec_file import read_sweep
    from scenarios.sweeps.sweep import check_size

    planned = read_sweep(file)
    whole = _whole(planned, out)
    if whole:
        planned = planned.for_verdicts()
    if run or whole:
        check_size(planned, yes=yes and not whole, how="--yes, without --out and [tolerances]")
    check_out(out, (".nc", ".csv"), [store, file])
    executor = executor_for(workers, time_limit, scheduler)
    _perform(planned, store, out, executor if run else None, retry_blocked=retry_blocked)


def _perform(planned: Sweep, store: Path, out: Path | None, executor: Executor | None, *, retry_blocked: bool) -> None:
    """Run what the store lacks, or nothing without an executor; print summaries, and write the results."""
    from reference_lcp.process import announce_interrupt
    from reference_lcp.terminal import announce_compilation
    from scenarios.runs.store import ResultStore, existing_store
    from scenarios.sweeps.dataset import sweep_dataset, write_dataset
    from scenarios.sweeps.run import evaluate_sweep, note_sweep, stored_points
    from scenarios.sweeps.sweep import size_text

    with ResultStore(existing_store(store) if executor is None else store) as stored:
        if executor is not None:
            announce_compilation()
            print(size_text(planned), file=sys.stderr)
            note_sweep(stored, planned)
            try:
                summary = evaluate_sweep(
                    planned, stored, executor, verdicts=_whole(planned, out), retry_blocked=retry_blocked
                )
                print_summary(planned, summary)
            except KeyboardInterrupt:
                announce_interrupt(f"interrupted: results are kept in {store}; the same command goes on from there")
                raise typer.Exit(ExitCode.INTERRUPTED) from None
        if not _whole(planned, out):
            return
        judged, points = stored_points(planned, stored)
        print_verdicts(judged, points)
        if out is not None:
            write_dataset(sweep_dataset(judged, points, store), out)


def _whole(planned: Sweep, out: Path | None) -> bool:
    """Say whether all results are in memory together."""
    return out is not None or planned.tolerance is not None


def print_summary(sweep: Sweep, summary: SweepSummary) -> None:
    """Print how the points of every variant ended, the periods that they took, and every reason once."""
    import pandas as pd

    from scenarios.sweeps.dataset import STATUSES
    from scenarios.tables import print_table

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
    import pandas as pd

    from scenarios.sweeps.run import verdict_summaries
    from scenarios.tables import print_table
    from scenarios.verdicts.finding import Verdict

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
    from scenarios.verdicts.finding import TRANSMITTANCE

    if summary.largest is None:
        return ["–", "–"]
    point = summary.largest
    return [f"{abs(point.difference(TRANSMITTANCE)):.3g}", f"{point.case.numbers}, {point.frequency_ratio:.4g}"]


def _by_variant(item: tuple[tuple[Variant, str], int]) -> tuple[Variant, int]:
    """Sort by variant, the commonest reason first."""
    (variant, _), count = item
    return variant, -count


store_app = typer.Typer(
    help="Check a store of results, and save the intact rows of a damaged one.", no_args_is_help=True
)


@store_app.callback()
def store_group() -> None:
    """Check a store of results, and save the intact rows of a damaged one."""


@store_app.command()
def check(
    file: Annotated[Path, typer.Argument(help="The store. It is not changed.")],
    new: Annotated[
        Path | None, typer.Option("--salvage", metavar="NEW", help="Write the intact rows into this new store.")
    ] = None,
) -> None:
    """Read every row of a store, and say what is damaged.

    Exit code 0: everything is intact, or the intact rows are in NEW; 2: damaged, or no store; 3: NEW could not be
    written; 130: interrupted.

    Example: multibody-xval store check results.sqlite --salvage good.sqlite
    """
    from scenarios.runs.store_check import check_store, salvage

    if new is not None:
        checked_output_file("--salvage", new, [file])
    found = check_store(file)
    for text in found.damage:
        print(visible(f"{file}: {text}"))
    results, sweeps = len(found.good["answers"]), len(found.good["sweeps"])
    damages = len(found.damage) or "no"
    print(visible(f"{file}: {results} intact results, {sweeps} intact sweeps, {damages} damages"))
    if new is not None:
        salvage(found, new)
        print(visible(f"{new}: {results} results; what is missing is computed again"))
    elif found.damage:
        raise typer.Exit(ExitCode.WRONG_INPUT)


app.add_typer(store_app, name="store")
