"""``python -m reports compare``: what changed from one store to another, for people and for CI."""

from pathlib import Path
from typing import Annotated

import typer

from reference_lcp.console import checked_output_file
from reference_lcp.refusal import ParameterError
from scenarios.verdicts.thresholds import Thresholds


def compare(
    first: Annotated[Path, typer.Argument(help="The store before.")],
    second: Annotated[Path, typer.Argument(help="The store now.")],
    decibel: Annotated[
        float, typer.Option("--db", help="Largest change of transmittance in dB that is none.")
    ] = Thresholds.transmittance_db,
    stuck_fraction: Annotated[
        float, typer.Option(help="Largest change of a contact's stuck fraction that is none.")
    ] = Thresholds.stuck_fraction,
    transition: Annotated[
        float, typer.Option(help="Largest change of the time of a transition, over the period, that is none.")
    ] = Thresholds.transition,
    out: Annotated[Path | None, typer.Option(help="Write every point before into this table (.csv).")] = None,
) -> None:
    """Compare two stores point by point: two versions of an engine, two sets of options.

    Points are matched by their tasks; version and options may differ, and differences of them are named. A result that
    is lost, blocked now, or no longer finite passes every threshold; one that was blocked before passes none.
    Exit code 0: nothing passes its threshold; 1: something does; 2: wrong input, no point in common, or results of
    different formats; 3: --out could not be written at the end; 130: interrupted.

    Example: python -m reports compare before/results.sqlite now/results.sqlite
    """
    if out is not None:
        if out.suffix != ".csv":
            raise ParameterError(f"--out = {out} has the ending {out.suffix!r}; allowed: .csv")
        checked_output_file("--out", out, [first, second])
    from reports.cli.changes import print_changes

    print_changes(first, second, Thresholds(decibel, stuck_fraction, transition), out)
