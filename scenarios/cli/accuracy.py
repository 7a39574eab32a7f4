"""What ``python -m scenarios run accuracy`` does."""

from collections.abc import Sequence
from pathlib import Path

from engines.interface.variant import Variant
from engines.shared.step_cost import step_cost
from reference_lcp.output import write_whole
from reference_lcp.visible import visible
from scenarios.cli.evaluation import evaluator_of_run
from scenarios.execution.executor import Executor
from scenarios.studies.accuracy import Accuracy, accuracies, accuracy_tasks, exact_tasks
from scenarios.studies.accuracy_table import PRINTED_COLUMNS, AccuracyRow, accuracy_document, csv_table, remark
from scenarios.tables import print_table, text_table
from scenarios.verdicts.steady_case import EXACT


def accuracy_rows(
    variants: list[Variant], store: Path | None, executor: Executor, *, cost: bool, retry_blocked: bool
) -> list[AccuracyRow]:
    """Compare with the exact motion; what a step costs is measured at the end, with nothing else running."""
    measured = _accuracies(variants, store, executor, retry_blocked)
    return [(row, step_cost(row.variant) if cost and row.certified else None) for row in measured]


def write_accuracy(rows: Sequence[AccuracyRow], out: Path | None, command: str) -> None:
    """Print the table and what it leaves out, and write it."""
    print_table(text_table(PRINTED_COLUMNS, rows))
    for row in rows:
        if row[0].certified < row[0].points:
            print(visible(remark(row[0])))
    if out is not None:
        write_whole(out, accuracy_document(rows, command) if out.suffix == ".md" else csv_table(rows))


def _accuracies(variants: list[Variant], store: Path | None, executor: Executor, retry_blocked: bool) -> list[Accuracy]:
    """Run everything, with bars on the way."""
    expected = [*exact_tasks().values(), *(task for variant in variants for task in accuracy_tasks(variant))]
    shown = [EXACT, *variants]
    with evaluator_of_run(store, executor, shown, expected, retry_blocked=retry_blocked) as evaluator:
        return accuracies(variants, evaluator)
