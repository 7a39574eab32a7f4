"""What ``python -m scenarios run cost`` does."""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from engines.interface.variant import Variant
from engines.shared.step_cost import step_cost
from reference_lcp.compilation import announce_compilation
from reference_lcp.output import write_whole
from reference_lcp.progress_lines import tracked
from reference_lcp.refusal import ParameterError
from reference_lcp.validation import checked_count, checked_scalar
from reference_lcp.visible import visible
from scenarios.execution.limits import TIME_LIMIT
from scenarios.studies.cost import COST_COLUMNS, STEP_COLUMNS, CostRow, cost
from scenarios.tables import Column, Row, csv_text, full_table, markdown_lines, print_table, text_table
from scenarios.verdicts.steady_case import REFERENCE

BATCH_SAMPLES = 3
"""Samples of a batch of each size: a large one takes as long as many steps of one chain do, and varies less."""

MOST_LANES = 65536
"""Of a batch: a period of so many chains of seven, recorded, is some 10 GB."""


def checked_seconds(seconds: float) -> None:
    """Refuse a measurement that is longer than a batch may take.

    Raises
    ------
    ParameterError
        Names the length, and what is allowed.
    """
    if checked_scalar("seconds", seconds, "> 0") > TIME_LIMIT:
        raise ParameterError(f"seconds = {seconds:g}; allowed: > 0 and <= {TIME_LIMIT:g}")


def checked_lanes(lanes: Sequence[int]) -> list[int]:
    """Refuse sizes of batches that are none, or more than memory may hold.

    Raises
    ------
    ParameterError
        Names the size, and what is allowed.
    """
    return [checked_count("lanes", count, 1, MOST_LANES) for count in lanes]


def perform_batches(variants: Sequence[Variant], lanes: Sequence[int], out: Path | None) -> None:
    """Measure steps of variants that are installed in batches of these sizes; print the table, and write it."""
    announce_compilation()
    _report(STEP_COLUMNS, _measured(variants, lambda each: [step_cost(each, BATCH_SAMPLES, n) for n in lanes]), out)


def perform(variants: Sequence[Variant], seconds: float, out: Path | None) -> None:
    """Measure variants that are installed; print the table, and write it."""
    announce_compilation()
    reference = cost(REFERENCE, seconds)

    def beside_the_reference(variant: Variant) -> list[CostRow]:
        return [(reference if variant == REFERENCE else cost(variant, seconds), reference)]

    _report(COST_COLUMNS, _measured(variants, beside_the_reference), out)


def _report(columns: Sequence[Column[Row]], rows: Sequence[Row], out: Path | None) -> None:
    """Print a table, and write it."""
    table = text_table(columns, rows)
    print_table(table)
    if out is not None:
        document = "\n".join([*markdown_lines(table), ""])
        write_whole(out, document if out.suffix == ".md" else csv_text(full_table(columns, rows)))


def _measured(variants: Sequence[Variant], measure: Callable[[Variant], Sequence[Row]]) -> list[Row]:
    """Measure one variant after the other, with progress on the way; those that are missing are named."""
    rows: list[Row] = []
    for variant in tracked(variants, "variants"):
        missing = variant.unavailable_reason
        if missing is not None:
            print(visible(f"{variant}: {missing}"), file=sys.stderr)
        else:
            rows.extend(measure(variant))
    return rows
