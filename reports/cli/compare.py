"""``multibody-xval compare``: the changes from one store to another, for people and for CI."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from engines.completion import complete_variant
from reference_lcp.errors import ExitCode, ParameterError
from reference_lcp.output import write_whole
from reference_lcp.terminal import visible
from reports.cli.options import NAME_METAVAR, Work, check_outs
from scenarios.verdicts.thresholds import Thresholds

if TYPE_CHECKING:
    from reports.export.changes import Regression
    from scenarios.runs.result import Result
    from scenarios.runs.task import Task

app = typer.Typer(name="multibody-xval compare", add_completion=False, pretty_exceptions_enable=False)

MOST_ROWS = 20
"""Changed points that are printed; a file holds all of them."""

GUARD_FRICTION_RATIOS, GUARD_FREQUENCY_RATIOS = [0.1, 0.3, 1.0], (0.3, 1.6, 8)
GUARD_SCENARIO = "breakaway"
"""What two engines are compared by, as in CI: points from well below the band to well above, and a block."""

Pair = Annotated[
    list[str] | None,
    typer.Option(
        "--engine",
        metavar=NAME_METAVAR,
        help="Instead of stores, the engine before and the one now: both compute 24 points and a block.",
        autocompletion=complete_variant,
    ),
]

ENDINGS = (".md", ".json", ".csv")
"""Formats of the changes."""


@app.command()
def compare(
    first: Annotated[Path | None, typer.Argument(help="The store before.")] = None,
    second: Annotated[Path | None, typer.Argument(help="The store now.")] = None,
    engines: Pair = None,
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
    """Compare two stores, or two engines, point by point: two versions of an engine, two sets of options.

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
    from reports.export.changes import CHANGE_FORMATS, Regression
    from scenarios.verdicts.regression import compare_stores

    thresholds = Thresholds(decibel, stuck_fraction, transition, motion)
    with _stores(first, second, engines or []) as (before, now):
        comparison = compare_stores(before, now, thresholds, _computed if exact else None)
    before_name, now_name = engines or (str(first), str(second))
    regression = Regression(comparison, before_name, now_name, thresholds, strict)
    _print(regression)
    for written in outs:
        write_whole(written, CHANGE_FORMATS[written.suffix](regression))
    raise typer.Exit(ExitCode.FAILED if regression.failing else ExitCode.DONE)


@contextmanager
def _stores(first: Path | None, second: Path | None, engines: Sequence[str]) -> Iterator[tuple[Path, Path]]:
    """Give the two stores, of engines those of the guard's points, which are not kept."""
    from engines.interface.variant import variants_named
    from scenarios import check, sweep

    if not engines and first is not None and second is not None:
        yield first, second
        return
    if len(engines) != 2 or first is not None:
        stores = sum(store is not None for store in (first, second))
        raise ParameterError(f"{stores} stores and {len(engines)} --engine; allowed: two stores, or two --engine")
    for name in engines:
        variants_named([name])  # refuses what is wrong before any work
    with TemporaryDirectory() as folder:
        before, now = Path(folder, "before.sqlite"), Path(folder, "now.sqlite")
        for name, store in zip(engines, (before, now), strict=True):
            sweep(name, friction_ratio=GUARD_FRICTION_RATIOS, frequency_ratio=GUARD_FREQUENCY_RATIOS, store=store)
            check(GUARD_SCENARIO, name, store=store)
        yield before, now


def _computed(tasks: Sequence[Task]) -> list[Result]:
    """Compute exact motions, which are not kept."""
    from scenarios.verdicts.steady_case import EXACT

    with Work().evaluator(None, [EXACT]) as evaluator:
        return evaluator.evaluate(tasks)


def _print(regression: Regression) -> None:
    from reports.export.changes import PRINTED_COLUMNS, counted_by_variant, identities
    from scenarios import tables

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
