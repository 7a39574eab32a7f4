"""``multibody-xval report``: run or read results, and write the page about them."""

from __future__ import annotations

import gc
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.engines.interface.texts import visible
from multibody_xval.reports.cli.compiling import announce_compilation
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.reports.cli.options import Computing, Engines, Settings, engine_option, grouped, keeping
from reference_lcp.errors import ParameterError

if TYPE_CHECKING:
    from multibody_xval.reports.page.write import Written

RARE_COLLECTIONS = (200_000, 20, 100)
"""Thresholds of Python's collector of cycles: with the usual 700 objects it takes an eighth of a report's time."""

PROGRAM = ("multibody-xval", "report")

app = typer.Typer(
    name="multibody-xval report", add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False
)


@dataclass(frozen=True)
class Asked:
    """What a page shows."""

    quick: Annotated[bool, typer.Option("--quick", help="Take few operating points: about a minute.")] = False
    chosen: Annotated[
        list[str] | None,
        engine_option(
            "An engine or one preset of it; `all`: every engine that is installed. May be repeated. Without it: the "
            "engines that come with the suite."
        ),
    ] = None
    settings: Settings = None
    sweep: Annotated[Path | None, typer.Option(metavar="FILE", help="Sweep file, see `multibody-xval example`.")] = None
    data: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Show the dataset of a sweep (.nc); nothing is run.")
    ] = None

    @property
    def names(self) -> list[str]:
        """The chosen engines, with changed options."""
        return Engines(self.chosen, self.settings).names

    @property
    def words(self) -> list[str]:
        """Give the options as they are written."""
        files = [
            word for name in ("sweep", "data") if (file := getattr(self, name)) for word in (f"--{name}", str(file))
        ]
        return [*["--quick"] * self.quick, *(f"--engine={name}" for name in self.names), *files]

    def check(self, stores: Sequence[Path], *, run: bool) -> None:
        """Refuse options that do not go together."""
        if self.data is not None and (self.sweep or self.names or self.quick or stores or not run):
            raise ParameterError("--data holds its sweep; allowed next to it: --out alone")
        if self.sweep is not None and (self.names or self.quick):
            raise ParameterError("--sweep names engines and grid; allowed next to it: neither --engine nor --quick")
        if not run and self.quick:
            raise ParameterError("--no-run shows all that stores hold; allowed without it: --quick")
        if run and len(stores) > 1:
            raise ParameterError(f"--store is given {len(stores)} times; allowed: once, or several times with --no-run")


@app.command()
@grouped
def report(
    *,
    out: Annotated[Path, typer.Option(metavar="FOLDER", help="Folder of the page and its files.")] = Path("report"),
    asked: Asked,
    store: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="Results file; without it, results.sqlite in --out. With --no-run it may be repeated.",
        ),
    ] = None,
    run: Annotated[
        bool, typer.Option("--run/--no-run", help="Run what is missing, or only show what --store holds.")
    ] = True,
    computing: Computing,
) -> None:
    """Compare engines with the exact motion of a chain with dry friction, and write a page about it.

    Without --engine and --sweep: the engines that come with the suite, with default options, recipe, and tuned to the
    chain. Results are stored: a second report takes seconds, and an interrupted one continues.

    Exit code 0: no judged number deviates; 1: a judged number or band edge deviates, or more than a quarter of a
    judged preset's numbers or of a named preset's runs are missing.

    Example: multibody-xval report --quick --engine mujoco --engine pybullet:joint:default
    """
    stores = store or []
    computing.check(out, run=run)
    asked.check(stores, run=run)
    gc.set_threshold(*RARE_COLLECTIONS)
    started = monotonic()
    written = _written(asked, out, stores, computing, run=run)
    for line in written.failures:
        print(visible(line))
    print(visible(f"{written.finding} ({monotonic() - started:.0f} s; {written.page})"))
    if written.failures:
        raise typer.Exit(ExitCode.FAILED)


def _written(asked: Asked, out: Path, stores: list[Path], computing: Computing, *, run: bool) -> Written:
    """Write the page of a dataset, of stores, of a sweep, or of the runs of a report."""
    from multibody_xval.reports.page import sources

    command = shlex.join([*PROGRAM, *asked.words, *(word for file in stores for word in ("--store", str(file)))])
    if asked.data is not None:
        return sources.dataset_page(asked.data, out, command)
    from multibody_xval.scenarios.sweeps.file import read_sweep
    from multibody_xval.scenarios.sweeps.plan import check_size

    sweep = None if asked.sweep is None else read_sweep(asked.sweep)
    if not run:
        kept = stores or [out / sources.STORE]
        return sources.stored_page(kept, out, f"{command} --no-run", asked.names, sweep)
    announce_compilation()
    store = stores[0] if stores else None
    with keeping(store or out / sources.STORE):
        if sweep is None:
            return sources.planned_page(asked.names, out, command, computing.means, store, quick=asked.quick)
        check_size(sweep, yes=False, how="multibody-xval sweep --yes")
        return sources.sweep_page(sweep, out, command, computing.means, store, asked.sweep)
