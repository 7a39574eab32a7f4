"""``multibody-xval sweep`` and ``example``: every combination of a file's parameters."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.engines.interface.texts import visible
from multibody_xval.reports.cli.compiling import announce_compilation
from multibody_xval.reports.cli.options import Computing, check_outs, grouped, keeping
from multibody_xval.scenarios.terminal_table import print_table

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from multibody_xval.scenarios.running.evaluate import Means
    from multibody_xval.scenarios.sweeps.plan import Sweep

app = typer.Typer(name="multibody-xval", add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def example() -> None:
    """Print a commented file of parameters for `sweep`.

    Exit code 0: printed.

    Example: multibody-xval example > sweep.toml
    """
    from multibody_xval.scenarios.sweeps.file import EXAMPLE

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
        list[Path] | None,
        typer.Option(metavar="FILE", help="Write all results as .nc (arrays with units) or .csv; may be repeated."),
    ] = None,
    run: Annotated[
        bool, typer.Option("--run/--no-run", help="Run missing points; --no-run shows only stored results.")
    ] = True,
    yes: Annotated[
        bool, typer.Option("--yes", help="Run a sweep of many points, which is refused without this.")
    ] = False,
    computing: Computing,
) -> None:
    """Run every combination of the parameters and engines that a file names.

    Exit code 0: every point has a result, or a reason why it has none.

    Example: multibody-xval sweep sweep.toml --out sweep.nc
    """
    computing.check(store, run=run)
    from multibody_xval.scenarios.ruler.judge import conclusion
    from multibody_xval.scenarios.store import checked_store, existing_store
    from multibody_xval.scenarios.sweeps.dataset import judged_table, write_dataset
    from multibody_xval.scenarios.sweeps.file import read_sweep
    from multibody_xval.scenarios.sweeps.plan import check_size

    means = computing.means(checked_store(store) if run else existing_store(store))
    planned = read_sweep(file)
    check_size(planned, yes=yes or not run, how="--yes")
    outs = check_outs(out, (".nc", ".csv"), store, file)
    data = _dataset(planned, means, run=run)
    table = judged_table(data)
    print_counts(planned, table)
    print_reasons(table)
    for each in outs:
        write_dataset(data, each)
    print(visible(conclusion(table)))


def _dataset(planned: Sweep, means: Means, *, run: bool) -> xr.Dataset:
    """Give the results of a sweep: what the store lacks is run, or not."""
    from multibody_xval.scenarios.sweeps.swept import stored_sweep, swept

    if not run:
        assert means.store is not None
        return stored_sweep(planned, means.store)
    announce_compilation()
    with keeping(means.store):
        return swept(planned, means)


def print_counts(planned: Sweep, table: pd.DataFrame) -> None:
    """Print what has become of the points of every configuration, with the largest error and where it is."""
    from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, VERDICTS

    places = 0 if planned.adaptive is not None else planned.points // len(planned.configs)
    rows = []
    for config in planned.configs:
        own = table[table.config == config]
        counts = own.verdict.value_counts()
        size = own.error_db.abs().dropna().sort_values()
        rows.append({
            "configuration": str(config),
            **{verdict: str(counts.get(verdict, 0)) for verdict in VERDICTS},
            "not run": str(max(places - len(own), 0)),
            "largest error [dB]": f"{size.iloc[-1]:.3g}" if len(size) else "–",
            "at": _place(planned, own.loc[size.index[-1]]) if len(size) else "–",
            "periods: median, most": _periods(own.periods[own.status == "periodic"]),
        })  # fmt: skip
    shown = [name for name in rows[0] if name in (AGREES, DEVIATES) or any(row[name] != "0" for row in rows)]
    print_table(shown, [[row[name] for name in shown] for row in rows])


def _place(planned: Sweep, row: pd.Series) -> str:
    """Say where on the axes a point is."""
    return ", ".join(f"{name.removesuffix('_ratio').replace('_', ' ')} {row[name]:.4g}" for name in planned.axes)


def _periods(periods: pd.Series) -> str:
    return f"{periods.median():.0f}, {periods.max():.0f}" if len(periods) else "–"


def print_reasons(table: pd.DataFrame) -> None:
    """Print every reason why a configuration has no steady state once."""
    rest = table[table.status != "periodic"]
    reasons = rest.reason.where(rest.reason != "", rest.status)
    for (config, reason), count in Counter(zip(rest.config, reasons, strict=True)).items():
        print(visible(f"{config}: {count} point{'s' if count > 1 else ''}: {reason}"))
