"""``multibody-xval compare``: the changes from one store to another, for people and for CI."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.reports.cli.options import Work, check_outs
from multibody_xval.scenarios.verdicts.thresholds import Thresholds
from reference_lcp.errors import ExitCode
from reference_lcp.output import write_whole
from reference_lcp.terminal import visible

if TYPE_CHECKING:
    from multibody_xval.reports.export.changes import Regression
    from multibody_xval.scenarios.runs.result import Result
    from multibody_xval.scenarios.runs.task import Task

app = typer.Typer(name="multibody-xval compare", add_completion=False, pretty_exceptions_enable=False)

MOST_ROWS = 20
"""Changed points that are printed; a file holds all of them."""

ENDINGS = (".md", ".json", ".csv")
"""Formats of the changes."""


@app.command()
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
            help="Write the changes here: a short comment for a pull request as .md, in full as .json, every point as "
            ".csv; may be repeated."
        ),
    ] = None,
) -> None:
    """Compare two stores point by point: two versions of an engine, two sets of options.

    Points are matched by their tasks. Versions and options may differ; their differences are printed. Each changed
    point has improved, regressed, or is as far from the truth as before. The truth is the proven level, the
    exact motion, or the converged reference of either store; for a transient motion, also the reference with finer
    steps. A point that was blocked before cannot fail.
    Exit code 0: nothing has changed for the worse; 1: a point has regressed, is missing, blocked now, no longer
    finite, or changed where the truth is not known; 2: wrong input, no point in common, or results of different
    formats; 3: --out could not be written at the end; 130: interrupted.

    Example: multibody-xval compare before/results.sqlite now/results.sqlite --out changes.md
    """
    outs = check_outs(out, ENDINGS, first, second)
    from multibody_xval.reports.export.changes import CHANGE_FORMATS, Regression
    from multibody_xval.scenarios.verdicts.regression import compare_stores

    thresholds = Thresholds(decibel, stuck_fraction, transition, motion)
    comparison = compare_stores(first, second, thresholds, _computed if exact else None)
    regression = Regression(comparison, str(first), str(second), thresholds, strict)
    _print(regression)
    for written in outs:
        write_whole(written, CHANGE_FORMATS[written.suffix](regression))
    raise typer.Exit(ExitCode.FAILED if regression.failing else ExitCode.DONE)


def _computed(tasks: Sequence[Task]) -> list[Result]:
    """Compute exact motions, which are not kept."""
    from multibody_xval.scenarios.verdicts.steady_case import EXACT

    with Work().evaluator(None, [EXACT]) as evaluator:
        return evaluator.evaluate(tasks)


def _print(regression: Regression) -> None:
    from multibody_xval.reports.export.changes import PRINTED_COLUMNS, counted_by_variant, identities
    from multibody_xval.scenarios import tables

    for line in (*counted_by_variant(regression.comparison), *identities(regression.comparison)):
        print(visible(line))
    shown = regression.comparison.beyond[:MOST_ROWS]
    for variant in dict.fromkeys(change.variant for change in shown):
        own = [change for change in shown if change.variant == variant]
        tables.print_table(tables.text_table(PRINTED_COLUMNS, own), title=variant)
    left = len(regression.comparison.beyond) - len(shown)
    if left:
        print(f"{left} more changed points; --out writes all of them")
    print(visible(regression.summary))
