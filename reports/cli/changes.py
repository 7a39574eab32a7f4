"""What ``python -m reports compare`` does: compare two stores, print what changed, and write every point."""

import math
from collections.abc import Iterable
from pathlib import Path

import pandas as pd
import typer
from rich.console import Console

from reference_lcp.exit_code import ExitCode
from reference_lcp.output import write_whole
from reference_lcp.refusal import ParameterError
from scenarios.tables import Column, csv_text, full_table, plain, print_table, text_table
from scenarios.tasks.result import ResultStatus
from scenarios.verdicts.regression import Change, StoreComparison, compare_stores
from scenarios.verdicts.thresholds import Thresholds

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


def print_changes(first: Path, second: Path, thresholds: Thresholds, out: Path | None) -> None:
    """Compare two stores point by point; ends with the exit code of the command.

    Raises
    ------
    ParameterError
        If they have no task in common, or cannot be compared.
    """
    comparison = compare_stores(first, second, thresholds)
    if not comparison.common:
        raise ParameterError(f"{first} and {second} have no task in common; allowed: stores of the same points")
    console = Console()
    print_table(_overview(comparison))
    for line in _identities(comparison.changes):
        console.print(plain(line), soft_wrap=True)
    if comparison.beyond:
        shown = text_table(
            (VARIANT_COLUMN, FRICTION_COLUMN, FREQUENCY_COLUMN, STEPS_COLUMN, BEYOND_COLUMN),
            comparison.beyond[:MOST_ROWS],
        )
        more = f", the {MOST_ROWS} largest" if len(comparison.beyond) > MOST_ROWS else ""
        print_table(shown, title=f"{len(comparison.beyond)} points beyond{more}")
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
