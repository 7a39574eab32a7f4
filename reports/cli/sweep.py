"""``multibody-xval sweep`` and ``example``: every combination of a file's parameters."""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.reports.cli.options import Work, check_outs, grouped, opened
from multibody_xval.scenarios.sweeps import UNCONFIRMED_POINTS
from reference_lcp.terminal import print_table, visible

if TYPE_CHECKING:
    from multibody_xval.scenarios.sweeps.point import Point
    from multibody_xval.scenarios.sweeps.run import SweepSummary
    from multibody_xval.scenarios.sweeps.sweep import Sweep

app = typer.Typer(name="multibody-xval", add_completion=False, pretty_exceptions_enable=False)

PARTS = (0.5, 0.99, 1.0)
"""Parts of the points whose number of periods is printed: median, 99 % and all."""


@app.command()
def example() -> None:
    """Print a commented file of parameters for `sweep`.

    Exit code 0: printed; 2: wrong input; 3: standard output could not be written; 130: interrupted.

    Example: multibody-xval example > sweep.toml
    """
    from multibody_xval.scenarios.sweeps.spec_file import EXAMPLE

    print(EXAMPLE, end="")


@app.command()
@grouped
def sweep(
    file: Annotated[Path, typer.Argument(help="The sweep: a TOML file; `example` prints one.")],
    *,
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
    work: Work,
) -> None:
    """Run every combination of the parameters and engines that a file names.

    Exit code 0: every point has a result, or a reason why it has none; 2: wrong input; 3: results or --out could not be
    written; 130: interrupted.

    Example: multibody-xval sweep sweep.toml --out sweep.nc
    """
    work.check(run=run)
    from multibody_xval.scenarios.runs.store import existing_store
    from multibody_xval.scenarios.sweeps.dataset import sweep_dataset, write_dataset
    from multibody_xval.scenarios.sweeps.run import evaluate_sweep, save_sweep, stored_points
    from multibody_xval.scenarios.sweeps.spec_file import read_sweep
    from multibody_xval.scenarios.sweeps.sweep import check_size, size_text

    planned = read_sweep(file)
    whole = out is not None or planned.tolerance is not None  # all results are in memory together
    if whole:
        planned = planned.for_verdicts()
    if run or whole:
        check_size(planned, yes=yes and not whole, how="--yes, without --out and [tolerances]")
    check_outs([out], (".nc", ".csv"), store, file)
    executor = work.executor()
    with opened(store if run else existing_store(store), keep_old=work.keep_old) as stored:
        if run:
            print(size_text(planned), file=sys.stderr)
            save_sweep(stored, planned)
            retry = work.retry_blocked
            print_summary(planned, evaluate_sweep(planned, stored, executor, verdicts=whole, retry_blocked=retry))
        if not whole:
            return
        judged, points = stored_points(planned, stored)
        print_verdicts(judged, points)
        if out is not None:
            write_dataset(sweep_dataset(judged, points, store), out)


def print_summary(sweep: Sweep, summary: SweepSummary) -> None:
    """Print how the points of every variant ended, the periods that they took, and every reason once."""
    from multibody_xval.scenarios.sweeps.dataset import STATUSES

    rows = []
    for variant in sweep.variants:
        row = {"engine:formulation:preset": str(variant)}
        row |= {str(status): str(summary.statuses[variant, status]) for status in STATUSES[:-1]}
        periods = [summary.quantile_of_periods(variant, part) for part in PARTS]
        row["periods: median, 99 %, most"] = ", ".join("–" if number is None else str(number) for number in periods)
        if sweep.frequencies is not None:
            row["curves unresolved"] = str(summary.unresolved[variant])
        rows.append(row)
    print_table(list(rows[0]), [list(row.values()) for row in rows])
    for (variant, reason), count in sorted(summary.reasons.most_common(), key=lambda item: item[0][0]):
        print(visible(f"{variant}: {count} point{'s' if count > 1 else ''}: {reason}"))


def print_verdicts(sweep: Sweep, points: Sequence[Point]) -> None:
    """Print how every variant compares with the reference, if the file has a tolerance for it."""
    from multibody_xval.scenarios.sweeps.run import compared_points
    from multibody_xval.scenarios.verdicts.finding import TRANSMITTANCE, Verdict

    if sweep.tolerance is None:
        return
    axes = ", ".join([*(name.removesuffix("_ratio").replace("_", " ") for name in sweep.case_axes), "frequency"])
    rows = []
    for variant, own in compared_points(sweep, points).items():
        counts = Counter(point.comparison.verdict for point in own)
        known = [point for point in own if not math.isnan(point.difference(TRANSMITTANCE))]
        worst = max(known, key=lambda point: abs(point.difference(TRANSMITTANCE)), default=None)
        largest = ["–", "–"]
        if worst is not None:
            size = abs(worst.difference(TRANSMITTANCE))
            largest = [f"{size:.3g}", f"{worst.case.numbers}, {worst.frequency_ratio:.4g}"]
        rows.append([str(variant), *(str(counts[verdict]) for verdict in Verdict), *largest])
    print_table(["engine:formulation:preset", *map(str, Verdict), "largest [dB]", f"at {axes}"], rows)
