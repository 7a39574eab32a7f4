"""``python -m scenarios run NAME``: a scenario of the catalogue, or all of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from engines.interface.variant import Variant
from reference_lcp.exit_code import ExitCode
from reference_lcp.output import write_whole
from scenarios.catalogue import ALL_SCENARIOS, CATALOGUE
from scenarios.catalogue.base import Scenario
from scenarios.catalogue.predicted import run_with_predictions
from scenarios.catalogue.transient.record import Record
from scenarios.catalogue.verdict_table import (
    Results,
    details,
    law_in_words,
    matrix,
    verdict_table,
    verdicts_text,
)
from scenarios.cli.options import (
    Chosen,
    Limit,
    Retry,
    Scheduler,
    Store,
    Workers,
    check_out,
    check_retry,
    chosen_variants,
    command_text,
    evaluator_of_run,
    store_of_run,
)
from scenarios.execution.dask_cluster import executor_for
from scenarios.execution.evaluator import StoredResults
from scenarios.execution.executor import TIME_LIMIT, Executor
from scenarios.execution.store_file import existing_store
from scenarios.tables import plain, printed_table
from scenarios.verdicts.failure import failures
from scenarios.verdicts.finding import Finding

LEAST_WIDTH = 200
"""Columns that tables may take where the output is no terminal."""

ENDINGS = (".md", ".csv", ".json")
"""Formats of verdicts."""

Out = Annotated[
    Path | None, typer.Option(help="Write the verdicts here: a document as .md, every number as .csv or .json.")
]


Ask = Annotated[bool, typer.Option(help="Run what is missing; --no-ask judges the results in --store.")]


@dataclass(frozen=True)
class _Run:
    """What a command runs."""

    scenarios: Sequence[Scenario]
    variants: Sequence[Variant]
    command: str
    retry_blocked: bool


def add_scenarios(run: typer.Typer) -> None:
    """Add a command for every scenario of the catalogue, and one for all of them."""
    for scenario in CATALOGUE.values():
        add = _add_record if isinstance(scenario, Record) else _add
        add(run, scenario.name, [scenario], f"{scenario.question} Compared with: {scenario.expects}.")
    _add(run, ALL_SCENARIOS, list(CATALOGUE.values()), "Every scenario of the catalogue; prints scenarios × variants.")


def _help(name: str, summary: str, options: str = "") -> str:
    """Give the help of a command: the physical question, the exit codes, an example."""
    return (
        f"{summary}\n\nExit code 0: every disagreement, if there is any, is as its law predicts, and three in four "
        "numbers of a preset are certified; 1: not so; 2: wrong input; 3: results or --out could not be kept; "
        "130: interrupted.\n\n"
        f"Example: python -m scenarios run {name}{options} --engine mujoco --out verdicts.md"
    )


def _add(run: typer.Typer, name: str, scenarios: Sequence[Scenario], summary: str) -> None:
    """Add the command of a scenario without parameters, or of several."""

    @run.command(name, help=_help(name, summary))
    def command(
        chosen: Chosen = None,
        store: Store = None,
        out: Out = None,
        ask: Ask = True,
        workers: Workers = None,
        time_limit: Limit = TIME_LIMIT,
        scheduler: Scheduler = None,
        retry_blocked: Retry = False,
    ) -> None:
        check_retry(ask, retry_blocked)
        check_out(out, ENDINGS, [store])
        chosen_run = _chosen_run(name, scenarios, chosen, [] if ask else ["--no-ask"], retry_blocked)
        _perform(chosen_run, store, out, executor_for(workers, time_limit, scheduler) if ask else None)


def _add_record(run: typer.Typer, name: str, scenarios: Sequence[Scenario], summary: str) -> None:
    """Add the command of the scenario whose base follows a file."""

    @run.command(name, help=_help(name, summary, " --record quake.csv"))
    def command(
        chosen: Chosen = None,
        record: Annotated[
            Path | None,
            typer.Option(help="Table of time in s and displacement in m (CSV); without it, the suite's example."),
        ] = None,
        store: Store = None,
        out: Out = None,
        ask: Ask = True,
        workers: Workers = None,
        time_limit: Limit = TIME_LIMIT,
        scheduler: Scheduler = None,
        retry_blocked: Retry = False,
    ) -> None:
        check_retry(ask, retry_blocked)
        check_out(out, ENDINGS, [store, record])
        own: Sequence[Scenario] = scenarios
        if record is not None:
            scenario = Record(record)
            scenario.check()
            own = [scenario]
        options = [] if record is None else [f"--record={record}"]
        chosen_run = _chosen_run(name, own, chosen, options if ask else [*options, "--no-ask"], retry_blocked)
        _perform(chosen_run, store, out, executor_for(workers, time_limit, scheduler) if ask else None)


def _chosen_run(
    name: str, scenarios: Sequence[Scenario], chosen: list[str] | None, options: list[str], retry_blocked: bool
) -> _Run:
    """Give what the options choose, before any work."""
    variants = chosen_variants(chosen)
    return _Run(scenarios, variants, command_text(name, chosen, options), retry_blocked)


def _perform(run: _Run, store: Path | None, out: Path | None, executor: Executor | None) -> None:
    """Run the scenarios, or judge the store alone, and print and write the verdicts."""
    results = _stored_findings(run, store) if executor is None else _findings(run, store, executor)
    print_results(results)
    if out is not None:
        write_whole(out, verdicts_text(results, run.command, out.suffix))
    if any(failures(findings) for findings in results.values()):
        raise typer.Exit(ExitCode.FAILED)


def _findings(run: _Run, store: Path | None, executor: Executor) -> dict[Scenario, list[Finding]]:
    """Run the scenarios one after the other, with bars on the way."""
    with evaluator_of_run(store, executor, run.variants, retry_blocked=run.retry_blocked) as evaluator:
        return {scenario: run_with_predictions(scenario, run.variants, evaluator) for scenario in run.scenarios}


def _stored_findings(run: _Run, store: Path | None) -> dict[Scenario, list[Finding]]:
    """Judge the results of a store; the rest is inconclusive."""
    with store_of_run(existing_store(store)) as stored, StoredResults(stored) as evaluator:
        return {scenario: run_with_predictions(scenario, run.variants, evaluator) for scenario in run.scenarios}


def print_results(results: Results) -> None:
    """Print the table of each scenario and what does not agree, and the matrix of several."""
    console = Console(width=max(Console().width, LEAST_WIDTH))
    for scenario, findings in results.items():
        console.print(f"\n[bold]{scenario.name}[/bold]: {plain(scenario.question)}")
        console.print(plain(f"compared with {scenario.expects}", *scenario.parameters()))
        console.print(printed_table(verdict_table(findings)))
        for variant, remarks in details(findings):
            console.print(plain(f"{variant}:", *(f"  {remark}" for remark in remarks)), soft_wrap=True)
    if len(results) > 1:
        console.print(printed_table(matrix(results)))
    _print_explanations(console, results)


def _print_explanations(console: Console, results: Results) -> None:
    """Print the laws that predict disagreements, and what fails."""
    findings = [finding for own in results.values() for finding in own]
    for variant in dict.fromkeys(finding.variant for finding in findings if finding.as_predicted):
        console.print(plain(f"as its law predicts, {variant}: {law_in_words(variant)}"), soft_wrap=True)
    for scenario, own in results.items():
        for line in failures(own):
            console.print(plain(f"{scenario.name}: {line}"), soft_wrap=True)
