"""What ``python -m scenarios run cost`` does."""

import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import track

from engines.interface.variant import Variant
from reference_lcp.compilation import announce_compilation
from reference_lcp.output import write_whole
from reference_lcp.refusal import ParameterError
from reference_lcp.validation import checked_scalar
from reference_lcp.visible import visible
from scenarios.execution.evaluator import unavailable_reason
from scenarios.execution.limits import TIME_LIMIT
from scenarios.studies.cost import COST_COLUMNS, Cost, cost
from scenarios.tables import csv_text, full_table, markdown_lines, print_table, text_table
from scenarios.verdicts.steady_case import REFERENCE


def checked_seconds(seconds: float) -> None:
    """Refuse a measurement that is longer than a batch may take.

    Raises
    ------
    ParameterError
        Names the length, and what is allowed.
    """
    if checked_scalar("seconds", seconds, "> 0") > TIME_LIMIT:
        raise ParameterError(f"seconds = {seconds:g}; allowed: > 0 and <= {TIME_LIMIT:g}")


def perform(variants: Sequence[Variant], seconds: float, out: Path | None) -> None:
    """Measure variants that are installed; print the table, and write it."""
    announce_compilation()
    reference = cost(REFERENCE, seconds)
    rows = [(own, reference) for own in _costs(variants, seconds, reference)]
    table = text_table(COST_COLUMNS, rows)
    print_table(table)
    if out is not None:
        document = "\n".join([*markdown_lines(table), ""])
        write_whole(out, document if out.suffix == ".md" else csv_text(full_table(COST_COLUMNS, rows)))


def _costs(variants: Sequence[Variant], seconds: float, reference: Cost) -> list[Cost]:
    """Measure one variant after the other, with a bar on the way; those that are missing are named."""
    costs = []
    for variant in track(variants, "cost", console=Console(stderr=True), transient=True):
        missing = unavailable_reason(variant)
        if missing is not None:
            print(visible(f"{variant}: {missing}"), file=sys.stderr)
        else:
            costs.append(reference if variant == REFERENCE else cost(variant, seconds))
    return costs
