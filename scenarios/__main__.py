"""``python -m scenarios``: experiments with engines, by name."""

if __name__ == "__main__":
    from reference_lcp.interrupt import heed_interrupts

    heed_interrupts()

# isort: split
import sys
from pathlib import Path
from typing import Annotated

import pandas as pd
import typer
from rich.console import Console
from rich.progress import track

from engines.interface.variant import Variant
from engines.shared.step_cost import step_cost
from reference_lcp.console import run_command
from reference_lcp.exit_code import ExitCode
from reference_lcp.interrupt import announce_interrupt
from reference_lcp.output import write_whole
from reference_lcp.validation import ParameterError, checked_scalar
from reference_lcp.visible import visible
from scenarios.catalogue import CATALOGUE
from scenarios.cli.mutations import add_mutations
from scenarios.cli.options import (
    TABLE_ENDINGS,
    Chosen,
    Limit,
    Retry,
    Scheduler,
    Store,
    TableFile,
    Workers,
    check_out,
    check_retry,
    chosen_variants,
    command_text,
    evaluator_of_run,
)
from scenarios.cli.run import add_scenarios
from scenarios.cli.store import store_app
from scenarios.cli.sweep import evaluate_sweep, print_summary, print_verdicts
from scenarios.execution.dask_cluster import executor_for
from scenarios.execution.evaluator import unavailable_reason
from scenarios.execution.executor import TIME_LIMIT, Executor
from scenarios.execution.store import ResultStore
from scenarios.execution.store_file import existing_store
from scenarios.studies.accuracy import Accuracy, accuracies, accuracy_tasks, exact_tasks
from scenarios.studies.accuracy_table import ACCURACY_COLUMNS, AccuracyRow, accuracy_document, csv_table, remark
from scenarios.studies.cost import COST_COLUMNS, SECONDS, cost
from scenarios.studies.law_agreement import LAW_COLUMNS, beside_the_reference, law_agreements, law_csv, law_document
from scenarios.sweeps.dataset import sweep_dataset, write_dataset
from scenarios.sweeps.noted import note_sweep
from scenarios.sweeps.run import stored_table
from scenarios.sweeps.size import UNCONFIRMED_POINTS, check_size, size_text
from scenarios.sweeps.spec_file import EXAMPLE, read_sweep
from scenarios.sweeps.table import points_of
from scenarios.tables import csv_text, full_table, markdown_lines, print_table, text_table
from scenarios.verdicts.steady_case import EXACT, REFERENCE

EXPERIMENTS = {
    "accuracy": "How wrong is the friction of each engine, formulation and preset? Against the exact motion.",
    "laws": "How well does the law of each preset predict its engine? Number by number, and over a period.",
    "mutations": "What would be found out? Engines with one error each, and the smallest one that each gate detects.",
    "cost": "What do a step and a steady state cost in each engine, and what is gained by two workers?",
}

app = typer.Typer(name="python -m scenarios", add_completion=False, pretty_exceptions_enable=False)
run = typer.Typer(help="Run a scenario of the catalogue, all of them, or a measurement.", no_args_is_help=True)
app.add_typer(run, name="run")
app.add_typer(store_app, name="store")
add_scenarios(run)
add_mutations(run)


@app.callback(invoke_without_command=True)
def catalogue(context: typer.Context) -> None:
    """List scenarios and measurements; `python -m scenarios run NAME` runs one, `run all` every scenario.

    Exit code 0: listed; 2: wrong input; 130: interrupted.

    Example: python -m scenarios run unit-cell --engine mujoco --engine pybullet:joint
    """
    if context.invoked_subcommand is None:
        _print_catalogue()


@app.command()
def example() -> None:
    """Print a commented file of parameters for `sweep`.

    Exit code 0: printed; 2: wrong input; 3: standard output could not be written; 130: interrupted.

    Example: python -m scenarios example > sweep.toml
    """
    print(EXAMPLE, end="")


@app.command()
def sweep(
    file: Annotated[Path, typer.Argument(help="The sweep: a TOML file as `example` prints it.")],
    store: Annotated[Path, typer.Option(help="File that keeps every result, so that a stopped sweep goes on.")] = Path(
        "sweep.sqlite"
    ),
    out: Annotated[
        Path | None, typer.Option(help="Write the results that the store holds: NetCDF as .nc, a table as .csv.")
    ] = None,
    ask: Annotated[bool, typer.Option(help="Run what is missing; --no-ask writes what there is.")] = True,
    yes: Annotated[bool, typer.Option("--yes", help=f"Run more than {UNCONFIRMED_POINTS:,} points.")] = False,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
    scheduler: Scheduler = None,
    retry_blocked: Retry = False,
) -> None:
    """Run every combination of parameters of a file, with every engine of the file.

    Exit code 0: every point has a result or a reason why not; 2: wrong input; 3: results or --out could not be kept;
    130: interrupted.

    Example: python -m scenarios sweep sweep.toml --out sweep.nc
    """
    check_retry(ask, retry_blocked)
    planned = read_sweep(file)
    whole = out is not None or planned.tolerance is not None  # all results in memory together
    if ask or whole:
        check_size(planned, yes=yes and not whole, how="--yes, without --out and [tolerances]")
    check_out(out, (".nc", ".csv"), [store, file])
    executor = executor_for(workers, time_limit, scheduler)
    with ResultStore(store if ask else existing_store(store)) as stored:
        if ask:
            print(size_text(planned), file=sys.stderr)
            note_sweep(stored, planned)
            try:
                print_summary(planned, evaluate_sweep(planned, stored, executor, retry_blocked=retry_blocked))
            except KeyboardInterrupt:
                announce_interrupt(f"interrupted: results are kept in {store}; the same command goes on from there")
                raise typer.Exit(ExitCode.INTERRUPTED) from None
        if not whole:
            return
        judged, table = stored_table(planned, stored)
        print_verdicts(judged, points_of(table))
        if out is not None:
            write_dataset(sweep_dataset(judged, table, store), out)


@run.command()
def accuracy(
    chosen: Chosen = None,
    store: Store = None,
    out: TableFile = None,
    cost: Annotated[
        bool, typer.Option(help="Measure what a step costs, at the end, with nothing else running.")
    ] = True,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
    scheduler: Scheduler = None,
    retry_blocked: Retry = False,
) -> None:
    """Compare steady states with the exact motion: a row of errors for each engine, formulation and preset.

    Exit code 0: the table is complete, whatever it says; 2: wrong input; 3: results or --out could not be kept; 130:
    interrupted.

    Example: python -m scenarios run accuracy --store accuracy.sqlite --out accuracy.md
    """
    variants = chosen_variants(chosen)
    check_out(out, TABLE_ENDINGS, [store])
    measured = _accuracies(variants, store, executor_for(workers, time_limit, scheduler), retry_blocked)
    rows: list[AccuracyRow] = [(row, step_cost(row.variant) if cost and row.certified else None) for row in measured]
    _print_accuracy(rows)
    if out is not None:
        command = command_text("accuracy", chosen)
        write_whole(out, accuracy_document(rows, command) if out.suffix == ".md" else csv_table(rows))


@run.command()
def laws(
    chosen: Chosen = None,
    store: Store = None,
    out: TableFile = None,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
    scheduler: Scheduler = None,
    retry_blocked: Retry = False,
) -> None:
    """Compare engines with the laws of their presets: departure from the reference, and what the law leaves of it.

    Exit code 0: the table is complete, whatever it says; 2: wrong input; 3: results or --out could not be kept; 130:
    interrupted.

    Example: python -m scenarios run laws --engine mujoco --out laws.md
    """
    variants = beside_the_reference(chosen_variants(chosen))
    check_out(out, TABLE_ENDINGS, [store])
    executor = executor_for(workers, time_limit, scheduler)
    with evaluator_of_run(store, executor, variants, retry_blocked=retry_blocked) as evaluator:
        rows = law_agreements(variants, evaluator)
    print_table(text_table(LAW_COLUMNS, rows))
    if out is not None:
        write_whole(out, law_document(rows, command_text("laws", chosen)) if out.suffix == ".md" else law_csv(rows))


@run.command(name="cost")
def cost_command(
    chosen: Chosen = None,
    out: TableFile = None,
    seconds: Annotated[
        float, typer.Option(help="Length of a measurement of steady states that is aimed at; there are two a row.")
    ] = SECONDS,
) -> None:
    """Time steps and steady states of each variant, with one and with two worker processes, beside the reference.

    A step: in the adapter, without (advance) and with a record (run), and in the engine's own bare loop.
    Exit code 0: measured; 2: wrong input; 3: --out could not be written at the end; 130: interrupted.

    Example: python -m scenarios run cost --engine mujoco:joint
    """
    check_out(out, TABLE_ENDINGS, [])
    if checked_scalar("seconds", seconds, "> 0") > TIME_LIMIT:
        raise ParameterError(f"seconds = {seconds:g}; allowed: > 0 and <= {TIME_LIMIT:g}")
    variants = chosen_variants(chosen)
    reference = cost(REFERENCE, seconds)
    costs = []
    for variant in track(variants, "cost", console=Console(stderr=True), transient=True):
        missing = unavailable_reason(variant)
        if missing is not None:
            print(visible(f"{variant}: {missing}"), file=sys.stderr)
        else:
            costs.append(reference if variant == REFERENCE else cost(variant, seconds))
    rows = [(own, reference) for own in costs]
    table = text_table(COST_COLUMNS, rows)
    print_table(table)
    if out is not None:
        document = "\n".join([*markdown_lines(table), ""])
        write_whole(out, document if out.suffix == ".md" else csv_text(full_table(COST_COLUMNS, rows)))


def _print_catalogue() -> None:
    """Print what there is to run."""
    scenarios = [(scenario.name, scenario.question, scenario.expects) for scenario in CATALOGUE.values()]
    print_table(pd.DataFrame(scenarios, columns=["scenario", "question", "compared with"]))
    print_table(pd.DataFrame(EXPERIMENTS.items(), columns=["measurement", "question"]))
    print("python -m scenarios run NAME runs one, python -m scenarios run all every scenario.")


def _accuracies(variants: list[Variant], store: Path | None, executor: Executor, retry_blocked: bool) -> list[Accuracy]:
    """Run everything, with bars on the way."""
    expected = [*exact_tasks().values(), *(task for variant in variants for task in accuracy_tasks(variant))]
    shown = [EXACT, *variants]
    with evaluator_of_run(store, executor, shown, expected, retry_blocked=retry_blocked) as evaluator:
        return accuracies(variants, evaluator)


def _print_accuracy(rows: list[AccuracyRow]) -> None:
    """Print the table and what it leaves out."""
    print_table(text_table(ACCURACY_COLUMNS, rows))
    for row in rows:
        if row[0].certified < row[0].points:
            print(visible(remark(row[0])))


if __name__ == "__main__":
    sys.exit(run_command(app))
