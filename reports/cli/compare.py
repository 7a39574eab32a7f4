"""``multibody-xval compare``: the changes from one store to another, for people and for CI."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from multibody_xval.engines.completion import complete_variant
from multibody_xval.reports.cli.options import Store, Work, Workers, check_outs, keeping
from multibody_xval.scenarios.verdicts.thresholds import Thresholds
from reference_lcp.errors import ExitCode, ParameterError
from reference_lcp.output import write_whole
from reference_lcp.terminal import print_table, visible

if TYPE_CHECKING:
    import pandas as pd

    from multibody_xval.reports.export.changes import Regression
    from multibody_xval.scenarios.runs.result import Result
    from multibody_xval.scenarios.runs.task import Task

Pair = Annotated[
    list[str] | None,
    typer.Option(
        "--engine",
        metavar="ENGINE[:FORMULATION[:PRESET]]",
        help="Instead of stores, what is before and what is now: both compute 24 points. An engine alone stands for "
        "its presets default, recommended and tuned.",
        autocompletion=complete_variant,
    ),
]

Outs = Annotated[
    list[Path] | None,
    typer.Option(
        help="Write the changes here: a short comment for a pull request as .md, in full as .json, every point as "
        ".csv; may be repeated."
    ),
]

app = typer.Typer(name="multibody-xval compare", add_completion=False, pretty_exceptions_enable=False)

MOST_ROWS = 20
"""Changed points that are printed; a file holds all of them."""

ENDINGS = (".md", ".json", ".csv")
"""Formats of the changes."""


@app.command()
def compare(
    first: Annotated[Path | None, typer.Argument(help="The store before.")] = None,
    second: Annotated[Path | None, typer.Argument(help="The store now.")] = None,
    pair: Pair = None,
    store: Store = None,
    workers: Workers = None,
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
    out: Outs = None,
) -> None:
    """Compare two stores point by point, or two configurations: versions of an engine, sets of options, engines.

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
    if pair or first is None or second is None:
        _compare_pair(pair or [], [own for own in (first, second) if own is not None], store, workers, outs)
    from multibody_xval.reports.export.changes import CHANGE_FORMATS, Regression
    from multibody_xval.scenarios.verdicts.regression import compare_stores

    thresholds = Thresholds(decibel, stuck_fraction, transition, motion)
    comparison = compare_stores(first, second, thresholds, _computed if exact else None)
    regression = Regression(comparison, str(first), str(second), thresholds, strict)
    _print(regression)
    for written in outs:
        write_whole(written, CHANGE_FORMATS[written.suffix](regression))
    raise typer.Exit(ExitCode.FAILED if regression.failing else ExitCode.DONE)


def _compare_pair(
    names: Sequence[str], stores: Sequence[Path], store: Path | None, workers: int | None, outs: Sequence[Path]
) -> NoReturn:
    """Compare two configurations, or the presets of two engines, and end the command."""
    if len(names) != 2 or stores:
        given = f"{len(stores)} stores and {len(names)} --engine"
        raise ParameterError(f"{given}; allowed: two stores, or two --engine and no store")
    from multibody_xval.scenarios.compare import changes_between, conclusion, fails, summary
    from multibody_xval.scenarios.evaluate import Means
    from multibody_xval.scenarios.result_tables import file_columns

    with keeping(store):
        changes = changes_between(names[0], names[1], Means(store=store, workers=workers))
    table = summary(changes)
    print_table(
        [str(name) for name in table], [[_shown(value) for value in row] for row in table.itertuples(index=False)]
    )
    print(visible(conclusion(changes, *names)))
    for written in outs:
        write_whole(written, WRITTEN[written.suffix](table if written.suffix == ".md" else file_columns(changes)))
    raise typer.Exit(ExitCode.FAILED if fails(changes) else ExitCode.DONE)


def _shown(value: object) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


WRITTEN: dict[str, Callable[[pd.DataFrame], str]] = {
    ".md": lambda table: f"{table.to_markdown(index=False)}\n",
    ".json": lambda table: table.to_json(orient="records", indent=1),
    ".csv": lambda table: table.to_csv(index=False),
}
"""How the changes of a pair are written: a summary for people, every point for programs."""


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
