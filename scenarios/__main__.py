"""``python -m scenarios``: experiments with engines, by name."""

if __name__ == "__main__":
    from reference_lcp.interrupt import heed_interrupts
    from reference_lcp.shadow import refuse_shadows

    heed_interrupts()
    refuse_shadows()

# isort: split
import sys
from pathlib import Path
from typing import Annotated

import typer

from reference_lcp.console import run_command
from scenarios.cli.mutations import add_mutations
from scenarios.cli.options import (
    TABLE_ENDINGS,
    Chosen,
    Limit,
    Retry,
    Scheduler,
    Settings,
    Store,
    TableFile,
    Workers,
    check_out,
    check_retry,
    command_text,
    with_settings,
)
from scenarios.cli.run import add_scenarios
from scenarios.cli.store import store_app
from scenarios.execution.limits import TIME_LIMIT
from scenarios.studies.limits import COST_SECONDS
from scenarios.sweeps.size import UNCONFIRMED_POINTS

EXPERIMENTS = {
    "accuracy": "How large are the errors of each engine, formulation and preset, compared with the exact motion?",
    "laws": "How well does the law of each preset predict its engine, number by number and over a period?",
    "mutations": "Which errors would the suite detect? Engines with one error each, and the smallest that is detected.",
    "cost": "What do a step and a steady state cost in each engine, and how much faster are two workers?",
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
    from scenarios.sweeps.spec_file import EXAMPLE

    print(EXAMPLE, end="")


@app.command()
def sweep(
    file: Annotated[Path, typer.Argument(help="The sweep: a TOML file; `example` prints one.")],
    store: Annotated[
        Path, typer.Option(help="File that stores every result; a stopped sweep continues from it.")
    ] = Path("sweep.sqlite"),
    out: Annotated[
        Path | None,
        typer.Option(help="Write all results of the sweep that are stored: NetCDF as .nc, a table as .csv."),
    ] = None,
    ask: Annotated[bool, typer.Option(help="Run missing points; --no-ask writes only stored results.")] = True,
    yes: Annotated[bool, typer.Option("--yes", help=f"Agree to run more than {UNCONFIRMED_POINTS:,} points.")] = False,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
    scheduler: Scheduler = None,
    retry_blocked: Retry = False,
) -> None:
    """Run every combination of the parameters and engines that a file names.

    Exit code 0: every point has a result, or a reason why it has none; 2: wrong input; 3: results or --out could not be
    written; 130: interrupted.

    Example: python -m scenarios sweep sweep.toml --out sweep.nc
    """
    check_retry(ask, retry_blocked)
    from scenarios.cli.sweep import perform, planned_sweep
    from scenarios.execution.workers.dask_cluster import executor_for

    planned = planned_sweep(file, ask=ask, yes=yes, out=out)
    check_out(out, (".nc", ".csv"), [store, file])
    executor = executor_for(workers, time_limit, scheduler)
    perform(planned, store, out, executor if ask else None, retry_blocked=retry_blocked)


@run.command()
def accuracy(
    chosen: Chosen = None,
    settings: Settings = None,
    store: Store = None,
    out: TableFile = None,
    cost: Annotated[
        bool, typer.Option(help="Also measure the time of a step, at the end, with nothing else running.")
    ] = True,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
    scheduler: Scheduler = None,
    retry_blocked: Retry = False,
) -> None:
    """Compare steady states with the exact motion: a row of errors for each engine, formulation and preset.

    Exit code 0: the table is complete, whatever its numbers; 2: wrong input; 3: results or --out could not be written;
    130: interrupted.

    Example: python -m scenarios run accuracy --store accuracy.sqlite --out accuracy.md
    """
    from scenarios.cli.accuracy import accuracy_rows, write_accuracy
    from scenarios.cli.evaluation import chosen_variants
    from scenarios.execution.workers.dask_cluster import executor_for

    names = with_settings(chosen, settings)
    variants = chosen_variants(names)
    check_out(out, TABLE_ENDINGS, [store])
    executor = executor_for(workers, time_limit, scheduler)
    rows = accuracy_rows(variants, store, executor, cost=cost, retry_blocked=retry_blocked)
    write_accuracy(rows, out, command_text("accuracy", names))


@run.command()
def laws(
    chosen: Chosen = None,
    settings: Settings = None,
    store: Store = None,
    out: TableFile = None,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
    scheduler: Scheduler = None,
    retry_blocked: Retry = False,
) -> None:
    """Compare engines with the laws of their presets: departure from the reference, and error of the prediction.

    Exit code 0: the table is complete, whatever its numbers; 2: wrong input; 3: results or --out could not be written;
    130: interrupted.

    Example: python -m scenarios run laws --engine mujoco --out laws.md
    """
    from scenarios.cli.evaluation import chosen_variants
    from scenarios.cli.laws import perform
    from scenarios.execution.workers.dask_cluster import executor_for

    names = with_settings(chosen, settings)
    variants = chosen_variants(names)
    check_out(out, TABLE_ENDINGS, [store])
    executor = executor_for(workers, time_limit, scheduler)
    perform(variants, store, out, executor, command_text("laws", names), retry_blocked=retry_blocked)


@run.command(name="cost")
def cost_command(
    chosen: Chosen = None,
    settings: Settings = None,
    out: TableFile = None,
    seconds: Annotated[
        float, typer.Option(help="Intended length of a measurement of steady states, in seconds; each row has two.")
    ] = COST_SECONDS,
    lanes: Annotated[
        list[int] | None,
        typer.Option(help="Measure time steps only, in a batch of N chains; may be repeated.", metavar="N"),
    ] = None,
) -> None:
    """Measure time steps and steady states of each variant, with one and two worker processes, and of the reference.

    A step is measured in the adapter without a record (advance) and with one (run), and in the engine's own loop.
    Exit code 0: measured; 2: wrong input; 3: --out could not be written at the end; 130: interrupted.

    Example: python -m scenarios run cost --engine mujoco:joint
    """
    check_out(out, TABLE_ENDINGS, [])
    from scenarios.cli.cost import checked_lanes, checked_seconds, perform, perform_batches
    from scenarios.cli.evaluation import chosen_variants

    checked_seconds(seconds)
    variants = chosen_variants(with_settings(chosen, settings))
    if lanes:
        perform_batches(variants, checked_lanes(lanes), out)
    else:
        perform(variants, seconds, out)


def _print_catalogue() -> None:
    """Print scenarios and measurements."""
    import pandas as pd

    from scenarios.catalogue.descriptions import DESCRIPTIONS
    from scenarios.tables import print_table

    scenarios = [(name, *description) for name, description in DESCRIPTIONS.items()]
    print_table(pd.DataFrame(scenarios, columns=["scenario", "question", "compared with"]))
    print_table(pd.DataFrame(EXPERIMENTS.items(), columns=["measurement", "question"]))
    print("python -m scenarios run NAME runs one, python -m scenarios run all every scenario.")


if __name__ == "__main__":
    sys.exit(run_command(app))
