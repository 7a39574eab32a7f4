"""``python -m reports compare``: what changed from one store to another, for people and for CI."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import pandas as pd
import typer
from rich.console import Console

from reference_lcp.console import checked_output_file
from reference_lcp.exit_code import ExitCode
from reference_lcp.output import write_whole
from reference_lcp.validation import ParameterError
from scenarios.tables import Column, csv_text, full_table, plain, printed_table, text_table
from scenarios.tasks.result import ResultStatus
from scenarios.verdicts.regression import Change, StoreComparison, Thresholds, compare_stores

MOST_ROWS = 20
"""Affected points that are printed; a file holds all of them."""

VARIANT_COLUMN = Column[Change]("variant", lambda change: change.first.variant, "engine:formulation:preset")
FRICTION_COLUMN = Column[Change]("friction_ratio", lambda change: change.first.task["friction_ratio"], "friction")
FREQUENCY_COLUMN = Column[Change]("frequency_ratio", lambda change: change.first.task.get("frequency_ratio"), "η_r")
STEPS_COLUMN = Column[Change]("steps_per_period", lambda change: change.first.task.get("steps_per_period"), "steps")
BEYOND_COLUMN = Column[Change]("beyond", lambda change: "; ".join(change.beyond), "what changed")

CHANGE_COLUMNS: tuple[Column[Change], ...] = (
    VARIANT_COLUMN, FRICTION_COLUMN, FREQUENCY_COLUMN, STEPS_COLUMN,
    Column("status_first", lambda change: change.first.result.status),
    Column("status_second", lambda change: change.second.result.status),
    Column("reason_first", lambda change: change.first.result.reason),
    Column("reason_second", lambda change: change.second.result.reason),
    Column("transmittance_db_first", lambda change: change.first.result.transmittance_db),
    Column("transmittance_db_second", lambda change: change.second.result.transmittance_db),
    Column("transmittance_db_change", lambda change: change.transmittance_db),
    Column("stuck_fraction_change", lambda change: change.stuck_fraction),
    Column("transition_change", lambda change: change.transition),
    Column("unmatched_transitions", lambda change: change.unmatched),
    BEYOND_COLUMN,
)  # fmt: skip


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
    comparison = compare_stores(first, second, Thresholds(decibel, stuck_fraction, transition))
    if not comparison.common:
        raise ParameterError(f"{first} and {second} have no task in common; allowed: stores of the same points")
    console = Console(width=max(Console().width, 120))
    console.print(printed_table(_overview(comparison)))
    for line in _identities(comparison.changes):
        console.print(plain(line))
    if comparison.beyond:
        shown = text_table(
            (VARIANT_COLUMN, FRICTION_COLUMN, FREQUENCY_COLUMN, STEPS_COLUMN, BEYOND_COLUMN),
            comparison.beyond[:MOST_ROWS],
        )
        more = f", the {MOST_ROWS} largest" if len(comparison.beyond) > MOST_ROWS else ""
        console.print(printed_table(shown, title=f"{len(comparison.beyond)} points beyond{more}"))
    if out is not None:
        write_whole(out, csv_text(full_table(CHANGE_COLUMNS, comparison.changes)))
    raise typer.Exit(ExitCode.FAILED if comparison.beyond else ExitCode.DONE)


def _overview(comparison: StoreComparison) -> pd.DataFrame:
    """Give a row for each variant."""
    rows = []
    by_variant = _by_variant(comparison.changes)
    for variant in dict.fromkeys((*by_variant, *comparison.only_first, *comparison.only_second)):
        changes = by_variant.get(variant, [])
        sizes = [abs(change.transmittance_db) for change in changes if not math.isnan(change.transmittance_db)]
        row = {
            "engine:formulation:preset": variant,
            "compared": str(len(changes) - comparison.only_first.get(variant, 0)),
            "beyond": str(sum(bool(change.beyond) for change in changes)),
            "largest change [dB]": f"{max(sizes):.4g}" if sizes else "–",
            "blocked before": str(sum(change.first.result.status == ResultStatus.BLOCKED for change in changes)),
            "blocked now": str(sum(change.second.result.status == ResultStatus.BLOCKED for change in changes)),
            "only first": str(comparison.only_first.get(variant, 0)),
            "only second": str(comparison.only_second.get(variant, 0)),
        }
        rows.append(row)
    return pd.DataFrame(rows)


def _identities(changes: Iterable[Change]) -> list[str]:
    """Name every change of a version or an option once."""
    lines = []
    for variant, own in _by_variant(changes).items():
        pairs = {(change.first.version, change.second.version) for change in own}
        lines += [f"{variant}: version {old} → {new}" for old, new in sorted(pairs) if old != new]
        options = {
            (name, change.first.options.get(name, "not set"), change.second.options.get(name, "not set"))
            for change in own
            for name in {*change.first.options, *change.second.options}
        }
        lines += [f"{variant}: option {name} {old} → {new}" for name, old, new in sorted(options) if old != new]
    return lines


def _by_variant(changes: Iterable[Change]) -> dict[str, list[Change]]:
    groups: dict[str, list[Change]] = {}
    for change in changes:
        groups.setdefault(change.first.variant, []).append(change)
    return groups
