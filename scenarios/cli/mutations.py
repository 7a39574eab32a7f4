"""``python -m scenarios run mutations``: which errors of engines the gates detect."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress

from engines.mutants.catalogue import MUTANTS
from engines.mutants.mutant import Mutant
from reference_lcp.output import write_whole
from reference_lcp.validation import checked_choice
from scenarios.cli.options import (
    TABLE_ENDINGS,
    Limit,
    Store,
    TableFile,
    Workers,
    check_out,
    command_text,
    store_of_run,
)
from scenarios.execution.dask_cluster import executor_for
from scenarios.execution.evaluator import Evaluator
from scenarios.execution.executor import TIME_LIMIT, Executor
from scenarios.mutations.gates import Contract, Gate, Report, Scenarios
from scenarios.mutations.mutation_table import MutationRow, gates_of, mutation_columns, mutation_csv, mutation_document
from scenarios.mutations.search import detections, rounds
from scenarios.tables import print_table, text_table

ChosenMutants = Annotated[
    list[str] | None, typer.Option("--mutant", metavar="NAME", help="A mutant; may be repeated. Without it, every one.")
]


GATES = ("contract", "scenarios", "report")
"""All gates, in the order of the columns."""

ChosenGates = Annotated[
    list[str] | None,
    typer.Option("--gate", metavar="|".join(GATES), help="A gate; may be repeated. Without it, every one."),
]


def add_mutations(run: typer.Typer) -> None:
    """Add the command."""

    @run.command()
    def mutations(
        chosen: ChosenMutants = None,
        gate: ChosenGates = None,
        store: Store = None,
        out: TableFile = None,
        workers: Workers = None,
        time_limit: Limit = TIME_LIMIT,
    ) -> None:
        """Hold engines with one error each to contract, scenarios and report: the smallest error that each detects.

        Exit code 0: the table is complete, whatever it says; 2: wrong input; 3: results or --out could not be kept;
        130: interrupted.

        Example: python -m scenarios run mutations --mutant bound --out mutations.md
        """
        names = [checked_choice("mutant", name, list(MUTANTS)) for name in chosen or MUTANTS]
        gates = [checked_choice("gate", name, GATES) for name in gate or GATES]
        check_out(out, TABLE_ENDINGS, [store])
        executor = executor_for(workers, time_limit, None)
        mutants = [MUTANTS[name] for name in dict.fromkeys(names)]
        rows = mutation_rows(mutants, list(dict.fromkeys(gates)), store, executor)
        print_table(text_table(mutation_columns(gates_of(rows)), rows))
        if out is not None:
            options = [f"--mutant={name}" for name in chosen or []] + [f"--gate={name}" for name in gate or []]
            command = command_text("mutations", None, options)
            write_whole(out, mutation_document(rows, command) if out.suffix == ".md" else mutation_csv(rows))


def mutation_rows(
    mutants: Sequence[Mutant], names: Sequence[str], store: Path | None, executor: Executor
) -> list[MutationRow]:
    """Hold mutants to the gates of these names, with a bar on the way."""
    with (
        store_of_run(store) as stored,
        Evaluator(stored, executor) as evaluator,
        Progress(console=Console(stderr=True), transient=True) as progress,
    ):
        gates = [_gate(name, evaluator) for name in names]
        bars = [progress.add_task(name, total=rounds(mutants)) for name in names]
        columns = [
            detections(gate, mutants, partial(progress.advance, bar)) for gate, bar in zip(gates, bars, strict=True)
        ]
    return [
        MutationRow(mutant, dict(zip(names, detected, strict=True)))
        for mutant, *detected in zip(mutants, *columns, strict=True)
    ]


def _gate(name: str, evaluator: Evaluator) -> Gate:
    if name == "contract":
        return Contract()
    return Scenarios(evaluator) if name == "scenarios" else Report(evaluator)
