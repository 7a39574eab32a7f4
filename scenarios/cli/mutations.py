"""``python -m scenarios run mutations``: which errors of engines the gates detect."""

from typing import Annotated

import typer

from reference_lcp.refusal import checked_choice
from scenarios.cli.options import TABLE_ENDINGS, Limit, Store, TableFile, Workers, check_out, command_text
from scenarios.execution.limits import TIME_LIMIT

ChosenMutants = Annotated[
    list[str] | None,
    typer.Option("--mutant", metavar="NAME", help="A mutant; may be repeated. Without it, all mutants."),
]


GATES = ("contract", "scenarios", "report")
"""All gates, in the order of the columns."""

ChosenGates = Annotated[
    list[str] | None,
    typer.Option("--gate", metavar="|".join(GATES), help="A gate; may be repeated. Without it, all gates."),
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
        """Run engines with one error each through contract, scenarios and report: the smallest error that each detects.

        Exit code 0: the table is complete, whatever its numbers; 2: wrong input; 3: results or --out could not be
        written; 130: interrupted.

        Example: python -m scenarios run mutations --mutant bound --out mutations.md
        """
        from engines.mutants.catalogue import MUTANTS
        from scenarios.cli.mutation_rows import mutation_rows, write_mutations
        from scenarios.execution.workers.dask_cluster import executor_for

        names = [checked_choice("mutant", name, list(MUTANTS)) for name in chosen or MUTANTS]
        gates = [checked_choice("gate", name, GATES) for name in gate or GATES]
        check_out(out, TABLE_ENDINGS, [store])
        executor = executor_for(workers, time_limit, None)
        mutants = [MUTANTS[name] for name in dict.fromkeys(names)]
        rows = mutation_rows(mutants, list(dict.fromkeys(gates)), store, executor)
        options = [f"--mutant={name}" for name in chosen or []] + [f"--gate={name}" for name in gate or []]
        write_mutations(rows, out, command_text("mutations", None, options))
