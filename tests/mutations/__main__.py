"""``python -m tests.mutations``: which errors of engines would contract, scenarios and report detect?

It needs pytest, and nothing installed but the suite: the wrong engines are installed into a folder of their own.
"""

import argparse
import shlex
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from reference_lcp.output import write_whole
from reference_lcp.terminal import counted
from scenarios.runs import TIME_LIMIT
from scenarios.runs.dask_cluster import executor_for
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.executor import Executor
from scenarios.runs.store import opened_store
from scenarios.tables import print_table, text_table
from tests.mutations.catalogue import MUTANTS
from tests.mutations.gates import ContractGate, Gate, ReportGate, ScenarioGate
from tests.mutations.mutant import Mutant
from tests.mutations.scenes import scene_rows
from tests.mutations.search import (
    MutationRow,
    detections,
    gates_of,
    mutation_columns,
    mutation_csv,
    mutation_document,
    rounds,
)
from tests.site import Site

GATES = ("contract", "scenarios", "report")
"""All gates, in the order of the columns."""


def mutation_rows(
    mutants: Sequence[Mutant], names: Sequence[str], store: Path | None, executor: Executor
) -> list[MutationRow]:
    """Hold mutants to the gates of these names, with a bar on the way."""
    with (
        opened_store(store) as stored,
        Evaluator(stored, executor) as evaluator,
        counted("rounds of gates", len(names) * rounds(mutants)) as advance,
    ):
        columns = [detections(_gate(name, evaluator), mutants, advance) for name in names]
    return [
        MutationRow(mutant, dict(zip(names, detected, strict=True)))
        for mutant, *detected in zip(mutants, *columns, strict=True)
    ]


def _gate(name: str, evaluator: Evaluator) -> Gate:
    if name == "contract":
        return ContractGate()
    return ScenarioGate(evaluator) if name == "scenarios" else ReportGate(evaluator)


def write_mutations(rows: Sequence[MutationRow], out: Path | None, command: str) -> None:
    """Print the table, and write it."""
    print_table(text_table(mutation_columns(gates_of(rows)), rows))
    if out is not None:
        write_whole(out, mutation_document(rows, scene_rows(), command) if out.suffix == ".md" else mutation_csv(rows))


def options(arguments: Sequence[str]) -> argparse.Namespace:
    """Read the command line; exit code 2 for a wrong one."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutations", description=__doc__)
    parser.add_argument("--mutant", action="append", choices=list(MUTANTS), metavar="NAME", help="may be repeated")
    parser.add_argument("--gate", action="append", choices=GATES, help="may be repeated")
    parser.add_argument("--store", type=Path, help="file that stores every result; a stopped run continues from it")
    parser.add_argument("--out", type=Path, help="write the table here: Markdown as .md, full precision as .csv")
    parser.add_argument("--workers", type=int, help="number of worker processes; without it, one for each processor")
    parser.add_argument("--time-limit", type=float, default=TIME_LIMIT, help="of a batch of points, in seconds")
    chosen = parser.parse_args(arguments)
    if chosen.out is not None and chosen.out.suffix not in (".md", ".csv"):
        parser.error(f"--out {chosen.out}; allowed: .md or .csv")
    if chosen.out is not None and chosen.store is not None and chosen.out.resolve() == chosen.store.resolve():
        parser.error(f"--out {chosen.out} is the store")
    return chosen


def main(arguments: Sequence[str]) -> None:
    """Run engines with one error each through the gates: the smallest error that each detects."""
    chosen = options(arguments)
    mutants = [MUTANTS[name] for name in dict.fromkeys(chosen.mutant or MUTANTS)]
    gates = list(dict.fromkeys(chosen.gate or GATES))
    with tempfile.TemporaryDirectory() as folder, Site(Path(folder), "mutations").visible():
        rows = mutation_rows(mutants, gates, chosen.store, executor_for(chosen.workers, chosen.time_limit, None))
        made = [
            *(f"--mutant={name}" for name in chosen.mutant or ()),
            *(f"--gate={name}" for name in chosen.gate or ()),
        ]
        write_mutations(rows, chosen.out, shlex.join(["python", "-m", "tests.mutations", *made]))


if __name__ == "__main__":
    main(sys.argv[1:])
