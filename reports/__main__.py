"""``python -m reports``: one page on every engine, with its tables."""

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from engines.registry import engine_names, usual_engine_names
from engines.variant import Variant
from reference_lcp.console import INTERRUPTED, checked_output_file, checked_output_folder, run_command
from reports.page import page, sections
from reports.provenance import provenance
from reports.sections.stick_slip import stick_slip_rows
from reports.tables import (
    BAND_EDGE_COLUMNS,
    TRANSITION_COLUMNS,
    TRANSMITTANCE_COLUMNS,
    band_edge_rows,
    csv_text,
    json_text,
    transition_rows,
    transmittance_rows,
    write_all,
)
from scenarios.cluster import crew_of
from scenarios.figure3 import (
    FRICTION_RATIOS,
    QUICK_FRICTION_RATIOS,
    Figure3,
    Figure3Result,
    default_frequency_ratios,
    quick_frequency_ratios,
    run,
)
from scenarios.isolation import TIME_LIMIT, Crew
from scenarios.progress import Bars, CountingEvaluator
from scenarios.questions import ChainRatios
from scenarios.store import ResultStore

TITLE = "Dry friction in multibody engines: a frictional mass-in-mass chain against its LCP reference"
PAGE = "index.html"
FILES = ("band_edges.csv", "transmittance.csv", "transitions.csv", "report.json", PAGE)

app = typer.Typer(name="python -m reports", add_completion=False, pretty_exceptions_enable=False)


@app.command()
def report(
    out: Annotated[Path, typer.Option(help="Folder of the page and its tables; made if it is missing.")] = Path(
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
    store: Annotated[
        Path | None, typer.Option(help="File that keeps every answer; without it, results.sqlite in --out.")
    ] = None,
    workers: Annotated[int | None, typer.Option(help="Worker processes; without it, one a processor.")] = None,
    time_limit: Annotated[
        float, typer.Option(help="Seconds that a batch of points may take; an engine that hangs is stopped then.")
    ] = TIME_LIMIT,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a dask scheduler whose workers compute, instead of this machine's.")
    ] = None,
) -> None:
    """Compare every engine with the reference on the frictional chain, and write a page about it.

    Answers are kept: a second run takes seconds, and an interrupted one goes on where it was.
    Exit code 0: the page is written, whatever the verdicts; 2: wrong input.

    Example: python -m reports --quick --engine mujoco --engine mujoco:contact --engine mujoco:joint:default
    """
    asked = _asked(_names(chosen), quick)
    crew = crew_of(workers, time_limit, scheduler)
    checked_output_folder("--out", out)
    for file in FILES:
        checked_output_file("output file", out / file)
    store = store if store is not None else out / "results.sqlite"
    with ResultStore(store) as kept:
        try:
            result = _run(asked, kept, crew)
        except KeyboardInterrupt:
            print(f"interrupted: answers are kept in {store}; the same command goes on from there", file=sys.stderr)
            raise typer.Exit(INTERRUPTED) from None
    write_all(out, files_of(result, _command(chosen, quick)))
    print(out / PAGE)


def files_of(result: Figure3Result, command: str) -> dict[str, str]:
    """Give the text of every file of the report, the page last."""
    stick_slip = stick_slip_rows(result)
    origin = provenance(result, command)
    return {
        "band_edges.csv": csv_text(BAND_EDGE_COLUMNS, band_edge_rows(result)),
        "transmittance.csv": csv_text(TRANSMITTANCE_COLUMNS, transmittance_rows(result)),
        "transitions.csv": csv_text(TRANSITION_COLUMNS, transition_rows(result)),
        "report.json": json_text(result, stick_slip, origin),
        PAGE: page(TITLE, sections(result, stick_slip, origin)),
    }


def _names(chosen: list[str] | None) -> list[str]:
    """Say who is compared."""
    if not chosen:
        return usual_engine_names()
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


def _run(asked: Figure3, kept: ResultStore, crew: Crew) -> Figure3Result:
    """Answer everything, with bars on the way."""
    with Bars(asked.all_variants) as bars, CountingEvaluator(kept, crew, asked.grid, bars) as evaluator:
        return run(asked, evaluator)


def _command(chosen: list[str] | None, quick: bool) -> str:
    """Give the command that asks for the same numbers; where they are written makes no difference."""
    options = ["--quick"] if quick else []
    for name in chosen or []:
        options += ["--engine", name]
    return shlex.join(["python", "-m", "reports", *options])


if __name__ == "__main__":
    sys.exit(run_command(app))
