"""``multibody-xval compare``: what is better or worse from one store, or configuration, to another."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.engines.interface.texts import visible
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.reports.cli.options import COMMENT_ENDINGS, Store, Workers, check_outs, engine_option, keeping
from multibody_xval.scenarios.output_files import write_whole
from reference_lcp.errors import ParameterError

if TYPE_CHECKING:
    import pandas as pd

    from multibody_xval.reports.changes import Comparison

Pair = Annotated[
    list[str] | None,
    engine_option(
        "Instead of files: twice, before and now, each as ENGINE[:FORMULATION[:PRESET]][:OPTION=VALUE]; each computes "
        "24 points.",
    ),
]

Outs = Annotated[
    list[Path] | None,
    typer.Option(
        metavar="FILE", help="Write a short comment as .md, all changes as .json, or points as .csv; may be repeated."
    ),
]

app = typer.Typer(
    name="multibody-xval compare", add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False
)

MOST_ROWS = 20
"""Changed points that are printed, and changed numbers; a file holds all of them."""


@app.command()
def compare(
    first: Annotated[Path | None, typer.Argument(help="The results file before.")] = None,
    second: Annotated[Path | None, typer.Argument(help="The results file now.")] = None,
    pair: Pair = None,
    store: Store = None,
    workers: Workers = None,
    decibel: Annotated[
        float,
        typer.Option("--db", help="Largest change that does not count, in dB: 0.001 to 1000."),
    ] = 0.001,
    strict: Annotated[bool, typer.Option("--strict", help="Every change fails, also an improvement.")] = False,
    out: Outs = None,
) -> None:
    """Compare two results files point by point, or two configurations: versions of an engine, options, engines.

    Points are matched by configuration, case and steps per period; the versions and options of engines may differ, and
    are printed. Two configurations that differ in options alone are matched if each file has one of their preset.
    Of several versions of an engine in a file the last counts; run NAME --no-run shows the installed one.

    Each point is improved, regressed or unchanged: the error of its transmittance, or of the time for which contacts
    stick, is smaller, larger or as before. It is missing if there is no steady state any more, and unknown if it has
    changed and neither file has the exact motion.

    Exit code 0: nothing is worse; 1: a point has regressed, is missing, or its change is unknown.

    Example: multibody-xval compare before/results.sqlite now/results.sqlite --out changes.md
    """
    names, stores = pair or [], [own for own in (first, second) if own is not None]
    outs = check_outs(out, COMMENT_ENDINGS, *stores, store)
    _check(names, stores, {"--store": store, "--workers": workers})
    with keeping(store):
        changes = _changes(names, stores, store, workers, decibel)
    from multibody_xval.reports.changes import WRITTEN, Comparison

    before, now = names or map(str, stores)
    comparison = Comparison(changes, before, now, decibel, strict)
    _print(comparison)
    for written in outs:
        write_whole(written, WRITTEN[written.suffix](comparison))
    raise typer.Exit(ExitCode.FAILED if comparison.fails else ExitCode.DONE)


def _check(names: Sequence[str], stores: Sequence[Path], computing: dict[str, object]) -> None:
    """Refuse anything but two stores or two configurations, and options of what is not done."""
    if sorted((len(names), len(stores))) != [0, 2]:
        given = f"{len(stores)} stores and {len(names)} --engine"
        raise ParameterError(f"{given}; allowed: two stores, or two --engine and no store")
    for option, value in computing.items():
        if stores and value is not None:
            raise ParameterError(
                f"{option} = {value} with two stores, of which nothing is computed; allowed: without it"
            )


def _changes(
    names: Sequence[str], stores: Sequence[Path], store: Path | None, workers: int | None, decibel: float
) -> pd.DataFrame:
    """Compare two stores, or compute two configurations."""
    from multibody_xval.scenarios.compare.stores import changes_between, compare
    from multibody_xval.scenarios.running.evaluate import Means

    if stores:
        return compare(*stores, db=decibel)
    before, now = names
    return changes_between(before, now, Means(store=store, workers=workers), decibel)


def _print(comparison: Comparison) -> None:
    from multibody_xval.reports.changes import changed_numbers, changed_points, identities, overview
    from multibody_xval.scenarios.table_text import print_table

    for line in identities(comparison.changes):
        print(visible(line))
    table = overview(comparison.changes)
    print_table(table.assign(configuration=table.configuration.str.replace(" -> ", "\n-> ")))  # in 80 columns
    for changed, what in ((changed_points, "points"), (changed_numbers, "numbers")):
        table = changed(comparison.changes)
        for name, own in table[:MOST_ROWS].groupby("configuration", sort=False):
            print_table(own.drop(columns="configuration"), title=str(name))
        if len(table) > MOST_ROWS:
            print(f"{len(table) - MOST_ROWS} more changed {what}; --out writes all of them")
    print(visible(comparison.conclusion))
