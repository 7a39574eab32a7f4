"""``python -m scenarios run NAME``: a scenario of the catalogue, or all of them."""

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from engines.interface.variant import Variant
from reference_lcp.validation import ParameterError
from scenarios.catalogue import CATALOGUE
from scenarios.catalogue.base import Scenario
from scenarios.catalogue.record import Record
from scenarios.catalogue.verdict_table import (
    Results,
    details,
    explained,
    law,
    matrix,
    unexplained,
    verdict_table,
    verdicts_text,
)
from scenarios.cli.options import (
    Chosen,
    Limit,
    Scheduler,
    Store,
    Workers,
    check_out,
    chosen_variants,
    store_of_run,
)
from scenarios.execution.dask_cluster import executor_for
from scenarios.execution.evaluator import StoredResults
from scenarios.execution.executor import TIME_LIMIT, Executor
from scenarios.execution.progress import Bars, CountingEvaluator
from scenarios.tables import printed_table
from scenarios.verdicts.finding import Finding

EVERY = "all"

UNEXPLAINED = 1
"""Exit code where a disagreement has no law of the engine for its reason."""

WIDEST = 200
"""Columns that tables may take where the output is no terminal."""

Out = Annotated[
    Path | None, typer.Option(help="Write the verdicts here: a document as .md, every number as .csv or .json.")
]


Ask = Annotated[bool, typer.Option(help="Answer what is missing; --no-ask judges what --store knows.")]


@dataclass(frozen=True)
class _Run:
    """What a command was asked to run."""

    scenarios: Sequence[Scenario]
    variants: Sequence[Variant]
    command: str


def add_scenarios(run: typer.Typer) -> None:
    """Add a command for every scenario of the catalogue, and one for all of them."""
    for scenario in CATALOGUE.values():
        add = _add_record if isinstance(scenario, Record) else _add
        add(run, scenario.name, [scenario], f"{scenario.question} Compared with: {scenario.expects}.")
    _add(run, EVERY, list(CATALOGUE.values()), "Every scenario of the catalogue; prints scenarios × variants.")


def _help(name: str, question: str, options: str = "") -> str:
    """Say what a command asks, how it ends, and give an example."""
    return (
        f"{question}\n\nExit code 0: no disagreement without a law of the engine that explains it; 1: some; "
        "2: wrong input; 130: interrupted.\n\n"
        f"Example: python -m scenarios run {name}{options} --engine mujoco --out verdicts.md"
    )


def _add(run: typer.Typer, name: str, scenarios: Sequence[Scenario], question: str) -> None:
    """Add the command of a scenario without parameters, or of several."""

    @run.command(name, help=_help(name, question))
    def command(
        chosen: Chosen = None,
        store: Store = None,
        out: Out = None,
        ask: Ask = True,
        workers: Workers = None,
        time_limit: Limit = TIME_LIMIT,
        scheduler: Scheduler = None,
    ) -> None:
        asked = _asked(name, scenarios, chosen, out, [] if ask else ["--no-ask"])
        _perform(asked, store, out, executor_for(workers, time_limit, scheduler) if ask else None)


def _add_record(run: typer.Typer, name: str, scenarios: Sequence[Scenario], question: str) -> None:
    """Add the command of the scenario whose base follows a file."""

    @run.command(name, help=_help(name, question, " --record quake.csv"))
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
    ) -> None:
        own: Sequence[Scenario] = scenarios
        if record is not None:
            scenario = Record(record)
            scenario.check()
            own = [scenario]
        options = [] if record is None else [f"--record={record}"]
        asked = _asked(name, own, chosen, out, options if ask else [*options, "--no-ask"])
        _perform(asked, store, out, executor_for(workers, time_limit, scheduler) if ask else None)


def _asked(
    name: str, scenarios: Sequence[Scenario], chosen: list[str] | None, out: Path | None, options: list[str]
) -> _Run:
    """Check what was asked for, before any work."""
    variants = chosen_variants(chosen)
    check_out(out, (".md", ".csv", ".json"))
    words = ["python", "-m", "scenarios", "run", name, *(f"--engine={c}" for c in chosen or []), *options]
    return _Run(scenarios, variants, shlex.join(words))


def _perform(asked: _Run, store: Path | None, out: Path | None, executor: Executor | None) -> None:
    """Run what was asked, by an executor or from the store alone, and print and write the verdicts."""
    results = _known_results(asked, store) if executor is None else _results(asked, store, executor)
    print_results(results)
    if out is not None:
        out.write_text(verdicts_text(results, asked.command, out.suffix))
    if any(unexplained(found) for found in results.values()):
        raise typer.Exit(UNEXPLAINED)


def _results(asked: _Run, store: Path | None, executor: Executor) -> dict[Scenario, list[Finding]]:
    """Run the scenarios one after the other, with bars on the way."""
    with (
        store_of_run(store) as kept,
        Bars(asked.variants) as bars,
        CountingEvaluator(kept, executor, [], bars) as evaluator,
    ):
        return {scenario: scenario.run(asked.variants, evaluator) for scenario in asked.scenarios}


def _known_results(asked: _Run, store: Path | None) -> dict[Scenario, list[Finding]]:
    """Judge what a store knows; the rest is inconclusive."""
    if store is None or not store.is_file():
        raise ParameterError(f"--no-ask with --store = {store}; allowed: a store that is there")
    with store_of_run(store) as kept, StoredResults(kept) as evaluator:
        return {scenario: scenario.run(asked.variants, evaluator) for scenario in asked.scenarios}


def print_results(results: Results) -> None:
    """Print the table of each scenario and what does not agree, and the matrix of several."""
    console = Console(width=max(Console().width, WIDEST))
    for scenario, found in results.items():
        console.print(f"\n[bold]{scenario.name}[/bold]: {escape(scenario.question)}")
        console.print(escape("\n".join([f"compared with {scenario.expects}", *scenario.parameters()])))
        console.print(printed_table(verdict_table(found)))
        for variant, remarks in details(found):
            console.print(escape("\n".join([f"{variant}:", *(f"  {remark}" for remark in remarks)])), soft_wrap=True)
    if len(results) > 1:
        console.print(printed_table(matrix(results)))
    _print_laws(console, [one for found in results.values() for one in found])


def _print_laws(console: Console, findings: Sequence[Finding]) -> None:
    """Print the laws that explain disagreements, and how many have none."""
    for variant in dict.fromkeys(one.variant for one in findings if explained(one)):
        console.print(escape(f"explained, {variant}: {law(variant)}"), soft_wrap=True)
    left = unexplained(findings)
    if left:
        names = ", ".join(dict.fromkeys(str(one.variant) for one in left))
        console.print(escape(f"unexplained: {len(left)} disagreements, of {names}"), soft_wrap=True)
