"""What ``python -m scenarios run mutations`` does."""

from collections.abc import Sequence
from pathlib import Path

from engines.mutants.mutant import Mutant
from reference_lcp.output import write_whole
from reference_lcp.progress_lines import counted
from scenarios.cli.evaluation import store_of_run
from scenarios.execution.evaluator import Evaluator
from scenarios.execution.executor import Executor
from scenarios.mutations.gates import ContractGate, Gate, ReportGate, ScenarioGate
from scenarios.mutations.mutation_table import MutationRow, gates_of, mutation_columns, mutation_csv, mutation_document
from scenarios.mutations.search import detections, rounds
from scenarios.tables import print_table, text_table


def mutation_rows(
    mutants: Sequence[Mutant], names: Sequence[str], store: Path | None, executor: Executor
) -> list[MutationRow]:
    """Hold mutants to the gates of these names, with a bar on the way."""
    with (
        store_of_run(store) as stored,
        Evaluator(stored, executor) as evaluator,
        counted("rounds of gates", len(names) * rounds(mutants)) as advance,
    ):
        columns = [detections(_gate(name, evaluator), mutants, advance) for name in names]
    return [
        MutationRow(mutant, dict(zip(names, detected, strict=True)))
        for mutant, *detected in zip(mutants, *columns, strict=True)
    ]


def write_mutations(rows: Sequence[MutationRow], out: Path | None, command: str) -> None:
    """Print the table, and write it."""
    print_table(text_table(mutation_columns(gates_of(rows)), rows))
    if out is not None:
        write_whole(out, mutation_document(rows, command) if out.suffix == ".md" else mutation_csv(rows))


def _gate(name: str, evaluator: Evaluator) -> Gate:
    if name == "contract":
        return ContractGate()
    return ScenarioGate(evaluator) if name == "scenarios" else ReportGate(evaluator)
