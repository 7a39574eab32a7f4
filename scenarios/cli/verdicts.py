"""What ``python -m scenarios run NAME`` does: run scenarios or read a store, judge, print and write the verdicts."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import typer
from rich.console import Console

from engines.interface.variant import Variant
from reference_lcp.exit_code import ExitCode
from reference_lcp.output import write_whole
from scenarios.catalogue import CATALOGUE
from scenarios.catalogue.base import Scenario
from scenarios.catalogue.predicted import run_with_predictions
from scenarios.catalogue.transient.record import Record
from scenarios.catalogue.verdict_files import VERDICT_FORMATS
from scenarios.catalogue.verdict_table import (
    Results,
    details,
    law_in_words,
    matrix,
    verdict_table,
)
from scenarios.cli.evaluation import chosen_variants, evaluator_of_run, store_of_run
from scenarios.cli.options import command_text
from scenarios.execution.evaluator import StoredResults
from scenarios.execution.executor import Executor
from scenarios.execution.storage.store_file import existing_store
from scenarios.tables import plain, print_table
from scenarios.verdicts.failure import failures
from scenarios.verdicts.finding import Finding


@dataclass(frozen=True)
class Run:
    """What a command runs."""

    scenarios: Sequence[Scenario]
    variants: Sequence[Variant]
    command: str
    retry_blocked: bool


def planned_run(
    name: str,
    scenarios: Sequence[str],
    chosen: Sequence[str],
    options: list[str],
    retry_blocked: bool,
    record: Path | None = None,
) -> Run:
    """Give what the options choose, before any work; the base follows a `record`, if there is one."""
    planned = [CATALOGUE[scenario] for scenario in scenarios] if record is None else [_of_record(record)]
    variants = chosen_variants(chosen)
    return Run(planned, variants, command_text(name, chosen, options), retry_blocked)


def _of_record(file: Path) -> Record:
    scenario = Record(file)
    scenario.check()
    return scenario


def perform(run: Run, store: Path | None, outs: Sequence[Path], executor: Executor | None) -> None:
    """Run the scenarios, or judge the store alone, and print and write the verdicts."""
    results = _stored_findings(run, store) if executor is None else _findings(run, store, executor)
    print_results(results)
    for out in outs:
        write_whole(out, VERDICT_FORMATS[out.suffix](results, run.command))
    if any(failures(findings) for findings in results.values()):
        raise typer.Exit(ExitCode.FAILED)


def _findings(run: Run, store: Path | None, executor: Executor) -> dict[Scenario, list[Finding]]:
    """Run the scenarios one after the other, with bars on the way."""
    with evaluator_of_run(store, executor, run.variants, retry_blocked=run.retry_blocked) as evaluator:
        return {scenario: run_with_predictions(scenario, run.variants, evaluator) for scenario in run.scenarios}


def _stored_findings(run: Run, store: Path | None) -> dict[Scenario, list[Finding]]:
    """Judge the results of a store; the rest is inconclusive."""
    with store_of_run(existing_store(store)) as stored, StoredResults(stored) as evaluator:
        return {scenario: run_with_predictions(scenario, run.variants, evaluator) for scenario in run.scenarios}


def print_results(results: Results) -> None:
    """Print the table of each scenario and what does not agree, and the matrix of several."""
    console = Console()
    for scenario, findings in results.items():
        console.print(f"\n[bold]{scenario.name}[/bold]: {plain(scenario.question)}", soft_wrap=True)
        console.print(plain(f"compared with {scenario.expects}", *scenario.parameters()), soft_wrap=True)
        print_table(verdict_table(findings))
        for variant, remarks in details(findings):
            console.print(plain(f"{variant}:", *(f"  {remark}" for remark in remarks)), soft_wrap=True)
    if len(results) > 1:
        print_table(matrix(results))
    _print_explanations(console, results)


def _print_explanations(console: Console, results: Results) -> None:
    """Print the laws that predict disagreements, and what fails."""
    findings = [finding for own in results.values() for finding in own]
    for variant in dict.fromkeys(finding.variant for finding in findings if finding.as_predicted):
        console.print(plain(f"as its law predicts, {variant}: {law_in_words(variant)}"), soft_wrap=True)
    for scenario, own in results.items():
        for line in failures(own):
            console.print(plain(f"{scenario.name}: {line}"), soft_wrap=True)
