"""What ``python -m scenarios run laws`` does."""

from collections.abc import Sequence
from pathlib import Path

from engines.interface.variant import Variant
from reference_lcp.output import write_whole
from scenarios.cli.evaluation import evaluator_of_run
from scenarios.execution.executor import Executor
from scenarios.studies.law_agreement import LAW_COLUMNS, beside_the_reference, law_agreements, law_csv, law_document
from scenarios.tables import print_table, text_table


def perform(
    chosen: Sequence[Variant],
    store: Path | None,
    out: Path | None,
    executor: Executor,
    command: str,
    *,
    retry_blocked: bool,
) -> None:
    """Compare engines with the laws of their presets; print the table, and write it."""
    variants = beside_the_reference(chosen)
    with evaluator_of_run(store, executor, variants, retry_blocked=retry_blocked) as evaluator:
        rows = law_agreements(variants, evaluator)
    print_table(text_table(LAW_COLUMNS, rows))
    if out is not None:
        write_whole(out, law_document(rows, command) if out.suffix == ".md" else law_csv(rows))
