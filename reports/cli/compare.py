"""``python -m reports compare``: the changes from one store to another, for people and for CI."""

from pathlib import Path
from typing import Annotated

import typer

from scenarios.cli.options import check_outs
from scenarios.verdicts.thresholds import Thresholds

ENDINGS = (".md", ".json", ".xml", ".csv")
"""Formats of the changes."""


def compare(
    first: Annotated[Path, typer.Argument(help="The store before.")],
    second: Annotated[Path, typer.Argument(help="The store now.")],
    decibel: Annotated[
        float, typer.Option("--db", help="Largest change of transmittance in dB that does not count.")
    ] = Thresholds.transmittance_db,
    stuck_fraction: Annotated[
        float, typer.Option(help="Largest change of a contact's stuck fraction that does not count.")
    ] = Thresholds.stuck_fraction,
    transition: Annotated[
        float, typer.Option(help="Largest change of the time of a transition, over the period, that does not count.")
    ] = Thresholds.transition,
    motion: Annotated[
        float,
        typer.Option(help="Largest change of a transient motion that does not count, over its displacement scale."),
    ] = Thresholds.motion,
    strict: Annotated[
        bool, typer.Option("--strict", help="Every change fails, also one that is closer to the truth.")
    ] = False,
    exact: Annotated[
        bool,
        typer.Option(
            help="Compute the exact motion of changed points; --no-exact takes the truth only from the stores."
        ),
    ] = True,
    out: Annotated[
        list[Path] | None,
        typer.Option(
            help="Write the changes here: a short comment for a pull request as .md, JUnit as .xml, in full as .json, "
            "every point as .csv; may be repeated."
        ),
    ] = None,
) -> None:
    """Compare two stores point by point: two versions of an engine, two sets of options.

    Points are matched by their tasks. Versions and options may differ; their differences are printed. Each changed
    point is closer to the truth than before, farther from it, or as far. The truth is the exact motion, or the
    converged reference of either store; for a transient motion, also the reference with finer steps. A point that was
    blocked before cannot fail.
    Exit code 0: nothing has changed for the worse; 1: a point is farther from the truth, lost, blocked now, no longer
    finite, or changed where the truth is not known; 2: wrong input, no point in common, or results of different
    formats; 3: --out could not be written at the end; 130: interrupted.

    Example: python -m reports compare before/results.sqlite now/results.sqlite --out changes.md
    """
    outs = check_outs(out, ENDINGS, [first, second])
    from reports.cli.changes import print_changes

    thresholds = Thresholds(decibel, stuck_fraction, transition, motion)
    print_changes(first, second, thresholds, outs, strict=strict, exact=exact)
