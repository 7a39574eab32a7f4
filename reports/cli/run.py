"""``multibody-xval run``: scenarios of the catalogue, one or all of them, and measurements."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reference_lcp.errors import ExitCode, ParameterError
from reference_lcp.terminal import visible
from reports.cli.options import (
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
    check_outs,
    check_retry,
    command_text,
    with_settings,
)
from scenarios.catalogue.descriptions import ALL_SCENARIOS, DESCRIPTIONS
from scenarios.runs import TIME_LIMIT
from scenarios.studies import COST_SECONDS

if TYPE_CHECKING:
    from engines.interface.variant import Variant
    from scenarios.catalogue.base import Scenario
    from scenarios.catalogue.verdict_table import Results
    from scenarios.runs.executor import Executor
    from scenarios.studies.cost import CostRow
    from scenarios.tables import Column, Row
    from scenarios.verdicts.finding import Finding

BATCH_SAMPLES = 3
"""Samples of a batch of each size: a large one takes as long as many steps of one chain do, and varies less."""

MOST_LANES = 65536
"""Of a batch: a period of so many chains of seven, recorded, is some 10 GB."""

RECORD = "record"
"""The scenario whose base follows a file."""

ENDINGS = (".md", ".json", ".xml", ".csv")
"""Formats of verdicts."""

Out = Annotated[
    list[Path] | None,
    typer.Option(
        help="Write the verdicts here: a short comment for a pull request as .md, JUnit as .xml, every number as .json "
        "or .csv; may be repeated."
    ),
]


Run = Annotated[
    bool, typer.Option("--run/--no-run", help="Run missing points; --no-run judges only the results in --store.")
]
RecordFile = Annotated[
    Path | None, typer.Option(help="CSV table of time in s and displacement in m; without it, the suite's example.")
]


EXPERIMENTS = {
    "accuracy": "How large are the errors of each engine, formulation and preset, compared with the exact motion?",
    "laws": "How well does the law of each preset predict its engine, number by number and over a period?",
    "cost": "What do a step and a steady state cost in each engine, and how much faster are two workers?",
}

app = typer.Typer(name="multibody-xval run", add_completion=False, pretty_exceptions_enable=False)


@app.callback(invoke_without_command=True)
def catalogue(context: typer.Context) -> None:
    """Run a scenario of the catalogue, all of them, or a measurement; without a name, list them.

    Exit code 0: listed; 2: wrong input; 130: interrupted.

    Example: multibody-xval run unit-cell --engine mujoco --engine pybullet:joint
    """
    if context.invoked_subcommand is None:
        print_catalogue()


def print_catalogue() -> None:
    """Print scenarios and measurements."""
    import pandas as pd

    from scenarios.tables import print_table

    scenarios = [(name, *description) for name, description in DESCRIPTIONS.items()]
    print_table(pd.DataFrame(scenarios, columns=["scenario", "question", "compared with"]))
    print_table(pd.DataFrame(EXPERIMENTS.items(), columns=["measurement", "question"]))
    print("multibody-xval run NAME runs one, multibody-xval run all every scenario.")


def _help(name: str, summary: str, options: str = "") -> str:
    """Give the help of a command: the physical question, the exit codes, an example."""
    return (
        f"{summary}\n\nExit code 0: every disagreement is as its law predicts, and three in four numbers of each "
        "preset are certified; 1: otherwise; 2: wrong input; 3: results or --out could not be written; "
        "130: interrupted.\n\n"
        f"Example: multibody-xval run {name}{options} --engine mujoco --out verdicts.md"
    )


def _add_scenario(name: str, scenarios: Sequence[str], summary: str) -> None:
    """Add the command of a scenario without parameters, or of several."""

    @app.command(name, help=_help(name, summary))
    def command(
        chosen: Chosen = None,
        settings: Settings = None,
        store: Store = None,
        out: Out = None,
        run: Run = True,
        workers: Workers = None,
        time_limit: Limit = TIME_LIMIT,
        scheduler: Scheduler = None,
        retry_blocked: Retry = False,
    ) -> None:
        _judge(name, scenarios, chosen, settings, None, store, out, run, workers, time_limit, scheduler, retry_blocked)


def _record(
    chosen: Chosen = None,
    settings: Settings = None,
    record: RecordFile = None,
    store: Store = None,
    out: Out = None,
    run: Run = True,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
    scheduler: Scheduler = None,
    retry_blocked: Retry = False,
) -> None:
    """Run the scenario whose base follows a file."""
    _judge(RECORD, [RECORD], chosen, settings, record, store, out, run, workers, time_limit, scheduler, retry_blocked)


for scenario_name, description in DESCRIPTIONS.items():
    question = f"{description.question} Compared with: {description.expects}."
    if scenario_name == RECORD:
        app.command(RECORD, help=_help(RECORD, question, " --record quake.csv"))(_record)
    else:
        _add_scenario(scenario_name, [scenario_name], question)
_add_scenario(
    ALL_SCENARIOS,
    list(DESCRIPTIONS),
    "Run every scenario of the catalogue, and print a table of scenarios and variants.",
)


def _judge(
    name: str,
    scenarios: Sequence[str],
    chosen: Sequence[str] | None,
    settings: Sequence[str] | None,
    record: Path | None,
    store: Path | None,
    out: Sequence[Path] | None,
    run: bool,
    workers: int | None,
    time_limit: float,
    scheduler: str | None,
    retry_blocked: bool,
) -> None:
    """Run scenarios, of which the only one may follow a record, and end with the exit code of their verdicts."""
    check_retry(run, retry_blocked)
    outs = check_outs(out, ENDINGS, [store, record])
    from reports.cli.evaluation import chosen_variants
    from scenarios.catalogue import CATALOGUE
    from scenarios.catalogue.transient.record import Record
    from scenarios.runs.dask_cluster import executor_for

    names = with_settings(chosen, settings)
    asked = [CATALOGUE[scenario] for scenario in scenarios]
    if record is not None:
        followed = Record(record)
        followed.check()
        asked = [followed]
    variants = chosen_variants(names)
    executor = executor_for(workers, time_limit, scheduler) if run else None
    options = ([] if record is None else [f"--record={record}"]) + ([] if run else ["--no-run"])
    _end(_findings(asked, variants, store, executor, retry_blocked), outs, command_text(name, names, options))


def _findings(
    scenarios: Sequence[Scenario],
    variants: Sequence[Variant],
    store: Path | None,
    executor: Executor | None,
    retry_blocked: bool,
) -> dict[Scenario, list[Finding]]:
    """Run scenarios one after the other, with bars on the way; without an executor, judge what a store has."""
    from reports.cli.evaluation import evaluator_of_run, store_of_run
    from scenarios.catalogue.base import run_with_predictions
    from scenarios.runs.evaluator import StoredResults
    from scenarios.runs.store import existing_store

    if executor is None:
        with store_of_run(existing_store(store)) as stored, StoredResults(stored) as known:
            return {scenario: run_with_predictions(scenario, variants, known) for scenario in scenarios}
    with evaluator_of_run(store, executor, variants, retry_blocked=retry_blocked) as evaluator:
        return {scenario: run_with_predictions(scenario, variants, evaluator) for scenario in scenarios}


def _end(results: Results, outs: Sequence[Path], command: str) -> None:
    """Print and write the verdicts, and end with their exit code."""
    from reference_lcp.output import write_whole
    from scenarios.catalogue.verdict_table import VERDICT_FORMATS
    from scenarios.verdicts.finding import failures

    print_results(results)
    for out in outs:
        write_whole(out, VERDICT_FORMATS[out.suffix](results, command))
    if any(failures(findings) for findings in results.values()):
        raise typer.Exit(ExitCode.FAILED)


def print_results(results: Results) -> None:
    """Print the table of each scenario and what does not agree, the matrix of several, laws, and what fails."""
    from rich.console import Console

    from scenarios.catalogue.verdict_table import details, law_in_words, matrix, verdict_table
    from scenarios.tables import plain, print_table
    from scenarios.verdicts.finding import failures

    console = Console()
    for scenario, findings in results.items():
        console.print(f"\n[bold]{scenario.name}[/bold]: {plain(scenario.question)}", soft_wrap=True)
        console.print(plain(f"compared with {scenario.expects}", *scenario.parameters()), soft_wrap=True)
        print_table(verdict_table(findings))
        for variant, remarks in details(findings):
            console.print(plain(f"{variant}:", *(f"  {remark}" for remark in remarks)), soft_wrap=True)
    if len(results) > 1:
        print_table(matrix(results))
    every = [finding for own in results.values() for finding in own]
    for variant in dict.fromkeys(finding.variant for finding in every if finding.as_predicted):
        console.print(plain(f"as its law predicts, {variant}: {law_in_words(variant)}"), soft_wrap=True)
    for scenario, own in results.items():
        for line in failures(own):
            console.print(plain(f"{scenario.name}: {line}"), soft_wrap=True)


@app.command()
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

    Example: multibody-xval run accuracy --store accuracy.sqlite --out accuracy.md
    """
    from engines.shared.step_cost import step_cost
    from reference_lcp.output import write_whole
    from reports.cli.evaluation import chosen_variants, evaluator_of_run
    from scenarios.runs.dask_cluster import executor_for
    from scenarios.studies.accuracy import (
        PRINTED_COLUMNS,
        accuracies,
        accuracy_document,
        accuracy_tasks,
        csv_table,
        exact_tasks,
        remark,
    )
    from scenarios.tables import print_table, text_table
    from scenarios.verdicts.steady_case import EXACT

    names = with_settings(chosen, settings)
    variants = chosen_variants(names)
    check_out(out, TABLE_ENDINGS, [store])
    executor = executor_for(workers, time_limit, scheduler)
    expected = [*exact_tasks().values(), *(task for variant in variants for task in accuracy_tasks(variant))]
    with evaluator_of_run(store, executor, [EXACT, *variants], expected, retry_blocked=retry_blocked) as evaluator:
        measured = accuracies(variants, evaluator)
    rows = [(row, step_cost(row.variant) if cost and row.certified else None) for row in measured]
    print_table(text_table(PRINTED_COLUMNS, rows))
    for row, _ in rows:
        if row.certified < row.points:
            print(visible(remark(row)))
    if out is not None:
        command = command_text("accuracy", names)
        write_whole(out, accuracy_document(rows, command) if out.suffix == ".md" else csv_table(rows))


@app.command()
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

    Example: multibody-xval run laws --engine mujoco --out laws.md
    """
    from reference_lcp.output import write_whole
    from reports.cli.evaluation import chosen_variants, evaluator_of_run
    from scenarios.runs.dask_cluster import executor_for
    from scenarios.studies.law_agreement import LAW_COLUMNS, beside_the_reference, law_agreements, law_csv, law_document
    from scenarios.tables import print_table, text_table

    names = with_settings(chosen, settings)
    variants = chosen_variants(names)
    check_out(out, TABLE_ENDINGS, [store])
    executor = executor_for(workers, time_limit, scheduler)
    shown = beside_the_reference(variants)
    with evaluator_of_run(store, executor, shown, retry_blocked=retry_blocked) as evaluator:
        rows = law_agreements(shown, evaluator)
    print_table(text_table(LAW_COLUMNS, rows))
    if out is not None:
        command = command_text("laws", names)
        write_whole(out, law_document(rows, command) if out.suffix == ".md" else law_csv(rows))


@app.command(name="cost")
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

    Example: multibody-xval run cost --engine mujoco:joint
    """
    check_out(out, TABLE_ENDINGS, [])
    from engines.shared.step_cost import step_cost
    from reference_lcp.terminal import announce_compilation
    from reference_lcp.validation import checked_count, checked_scalar
    from reports.cli.evaluation import chosen_variants
    from scenarios.studies.cost import COST_COLUMNS, STEP_COLUMNS, cost
    from scenarios.verdicts.steady_case import REFERENCE

    if checked_scalar("seconds", seconds, "> 0") > TIME_LIMIT:
        raise ParameterError(f"seconds = {seconds:g}; allowed: > 0 and <= {TIME_LIMIT:g}")
    variants = chosen_variants(with_settings(chosen, settings))
    counts = [checked_count("lanes", count, 1, MOST_LANES) for count in lanes or ()]
    announce_compilation()
    if counts:
        steps = _measured(variants, lambda each: [step_cost(each, BATCH_SAMPLES, count) for count in counts])
        _print_measured(STEP_COLUMNS, steps, out)
        return
    reference = cost(REFERENCE, seconds)

    def beside_the_reference(variant: Variant) -> list[CostRow]:
        return [(reference if variant == REFERENCE else cost(variant, seconds), reference)]

    _print_measured(COST_COLUMNS, _measured(variants, beside_the_reference), out)


def _print_measured(columns: Sequence[Column[Row]], rows: Sequence[Row], out: Path | None) -> None:
    """Print a table, and write it."""
    from reference_lcp.output import write_whole
    from scenarios.tables import csv_text, full_table, markdown_lines, print_table, text_table

    table = text_table(columns, rows)
    print_table(table)
    if out is not None:
        document = "\n".join([*markdown_lines(table), ""])
        write_whole(out, document if out.suffix == ".md" else csv_text(full_table(columns, rows)))


def _measured(variants: Sequence[Variant], measure: Callable[[Variant], Sequence[Row]]) -> list[Row]:
    """Measure one variant after the other, with progress on the way; those that are missing are named."""
    from reference_lcp.terminal import tracked

    rows: list[Row] = []
    for variant in tracked(variants, "variants"):
        missing = variant.unavailable_reason
        if missing is not None:
            print(visible(f"{variant}: {missing}"), file=sys.stderr)
        else:
            rows.extend(measure(variant))
    return rows
