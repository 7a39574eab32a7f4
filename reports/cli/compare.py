"""``python -m reports compare``: what changed from one store to another, for people and for CI."""

import csv
import math
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import typer
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from reference_lcp.console import checked_output_file
from reference_lcp.validation import ParameterError
from scenarios.verdicts.regression import Change, StoreComparison, Thresholds, compare_stores

CHANGED = 1
"""Exit code if something passes its threshold."""

MOST_ROWS = 20
"""Affected points that are printed; a file holds all of them."""

COLUMNS = (
    "variant", "friction_ratio", "frequency_ratio", "steps_per_period", "status_first", "status_second",
    "transmittance_db_first", "transmittance_db_second", "transmittance_db_change", "stuck_fraction_change",
    "transition_change", "unmatched_transitions", "beyond",
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
    out: Annotated[Path | None, typer.Option(help="Write every common point into this table (.csv).")] = None,
) -> None:
    """Compare two stores point by point: two versions of an engine, two sets of options.

    Points are matched by what was asked; version and options may differ, and differences of them are named.
    Exit code 0: nothing passes its threshold; 1: something does; 2: wrong input, or no point in common.

    Example: python -m reports compare before/results.sqlite now/results.sqlite
    """
    if out is not None:
        if out.suffix != ".csv":
            raise ParameterError(f"--out = {out} has the ending {out.suffix!r}; allowed: .csv")
        checked_output_file("--out", out)
    found = compare_stores(first, second, Thresholds(decibel, stuck_fraction, transition))
    if not found.changes:
        raise ParameterError(f"{first} and {second} have no question in common; allowed: stores of the same points")
    console = Console(width=max(Console().width, 120))
    console.print(_overview(found))
    for line in _identities(found.changes):
        console.print(escape(line))
    if found.beyond:
        console.print(_affected(found.beyond))
    if out is not None:
        _write(found.changes, out)
    raise typer.Exit(CHANGED if found.beyond else 0)


def _overview(found: StoreComparison) -> Table:
    """Give a row for each variant."""
    table = _table(
        "engine:formulation:preset", "compared", "beyond", "largest change [dB]", "only first", "only second"
    )
    by_variant = _by_variant(found.changes)
    for variant in dict.fromkeys((*by_variant, *found.only_first, *found.only_second)):
        changes = by_variant.get(variant, [])
        sizes = [abs(change.transmittance_db) for change in changes if not math.isnan(change.transmittance_db)]
        table.add_row(
            variant,
            str(len(changes)),
            str(sum(bool(change.beyond) for change in changes)),
            f"{max(sizes):.4g}" if sizes else "–",
            str(found.only_first.get(variant, 0)),
            str(found.only_second.get(variant, 0)),
        )
    return table


def _identities(changes: Iterable[Change]) -> list[str]:
    """Name every change of a version or an option once."""
    lines = []
    for variant, found in _by_variant(changes).items():
        pairs = {(change.first.version, change.second.version) for change in found}
        lines += [f"{variant}: version {old} → {new}" for old, new in sorted(pairs) if old != new]
        options = {
            (name, change.first.options.get(name, "not set"), change.second.options.get(name, "not set"))
            for change in found
            for name in {*change.first.options, *change.second.options}
        }
        lines += [f"{variant}: option {name} {old} → {new}" for name, old, new in sorted(options) if old != new]
    return lines


def _affected(changes: list[Change]) -> Table:
    """Give a row for each point that passes a threshold."""
    shown = changes[:MOST_ROWS]
    title = f"{len(changes)} points beyond" + (f", the {MOST_ROWS} largest" if len(changes) > len(shown) else "")
    table = _table("engine:formulation:preset", "friction", "η_r", "steps", "what changed")
    table.title = title
    for change in shown:
        row = _row(change)
        names = ("variant", "friction_ratio", "frequency_ratio", "steps_per_period", "beyond")
        table.add_row(*(escape(str(row[name])) for name in names))
    return table


def _row(change: Change) -> dict[str, Any]:
    question = change.first.question
    return {
        "variant": change.first.variant,
        "friction_ratio": question["friction_ratio"],
        "frequency_ratio": question.get("frequency_ratio"),
        "steps_per_period": question.get("steps_per_period"),
        "status_first": change.first.answer.status,
        "status_second": change.second.answer.status,
        "transmittance_db_first": change.first.answer.transmittance_db,
        "transmittance_db_second": change.second.answer.transmittance_db,
        "transmittance_db_change": change.transmittance_db,
        "stuck_fraction_change": change.stuck_fraction,
        "transition_change": change.transition,
        "unmatched_transitions": change.unmatched,
        "beyond": "; ".join(change.beyond),
    }


def _write(changes: Iterable[Change], file: Path) -> None:
    with file.open("w", newline="", encoding="utf-8") as opened:
        writer = csv.DictWriter(opened, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(_row(change) for change in changes)


def _by_variant(changes: Iterable[Change]) -> dict[str, list[Change]]:
    found: dict[str, list[Change]] = {}
    for change in changes:
        found.setdefault(change.first.variant, []).append(change)
    return found


def _table(*headings: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), title_justify="left")
    for heading in headings:
        table.add_column(escape(heading))
    return table
