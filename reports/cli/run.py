"""``multibody-xval run``: scenarios of the catalogue, one or all of them, and measurements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.reports.cli.laws import laws
from multibody_xval.reports.cli.options import Engines, Store, Work, check_outs, grouped
from multibody_xval.reports.cli.proofs import proofs
from multibody_xval.reports.cli.recipe import recipes
from multibody_xval.reports.cli.studies import accuracy, figure3, work_precision
from multibody_xval.scenarios.catalogue.descriptions import ALL_SCENARIOS, DESCRIPTIONS
from reference_lcp.errors import ExitCode, checked_choice
from reference_lcp.output import write_whole
from reference_lcp.terminal import print_table

if TYPE_CHECKING:
    from multibody_xval.scenarios.catalogue.verdict_table import Results

RECORD = "record"
"""The scenario whose base follows a file."""

STUDIES = {
    "figure3": figure3, "accuracy": accuracy, "work-precision": work_precision, "laws": laws, "proofs": proofs,
    "recipes": recipes,
}  # fmt: skip
"""Measurements; the first one has points of a scenario, and answers the paper's claims too."""

ENDINGS = (".md", ".json", ".csv")
"""Formats of verdicts."""

EXPERIMENTS = {
    "accuracy": "How large are the errors of each engine, formulation and preset, compared with the exact motion?",
    "laws": "How well does the law of each preset predict its engine over a period?",
    "proofs": "What is the exact transmittance at every point of the standard grids, proven?",
    "work-precision": "How large is each engine's error to the proven value, over the time of a simulated second?",
    "recipes": "Which options make friction hold in a user's own model, in each engine, and what do they cost?",
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
    scenarios = [(name, *description) for name, description in DESCRIPTIONS.items()]
    print_table(("scenario", "question", "compared with"), scenarios)
    print_table(("measurement", "question"), list(EXPERIMENTS.items()))
    print("multibody-xval run NAME runs one, multibody-xval run all every scenario.")


@dataclass(frozen=True)
class Verdicts:
    """Where verdicts come from, and where they are written."""

    store: Store = None
    out: Annotated[
        list[Path] | None,
        typer.Option(
            help="Write the verdicts here: a short comment for a pull request as .md, every number as .json or .csv; "
            "may be repeated."
        ),
    ] = None
    run: Annotated[
        bool, typer.Option("--run/--no-run", help="Run missing points; --no-run judges only the results in --store.")
    ] = True


@grouped
def named(
    context: typer.Context,
    others: Annotated[list[str] | None, typer.Argument(help="Other scenarios, to be run with this one.")] = None,
    *,
    engines: Engines,
    verdicts: Verdicts,
    work: Work,
) -> None:
    """Run the scenario that the command is named after, or all, and others."""
    names = [str(context.info_name), *(checked_choice("scenario", name, list(DESCRIPTIONS)) for name in others or ())]
    _judge(names, engines, verdicts, work)


@grouped
def follow(
    engines: Engines,
    *,
    record: Annotated[
        Path | None,
        typer.Option(help="CSV table of time in s and displacement in m; without it, the suite's example."),
    ] = None,
    verdicts: Verdicts,
    work: Work,
) -> None:
    """Run the scenario whose base follows a file."""
    _judge([RECORD], engines, verdicts, work, record)


def _add_scenarios() -> None:
    """Add the command of each scenario, and of all: the physical question, the exit codes, an example."""
    summaries = {name: f"{own.question} Compared with: {own.expects}." for name, own in DESCRIPTIONS.items()}
    summaries[ALL_SCENARIOS] = "Run every scenario of the catalogue, and print a table of scenarios and variants."
    for name, summary in summaries.items():
        text = (
            f"{summary}\n\nExit code 0: every disagreement is as its law predicts, and of the numbers of each preset "
            "that count at most one in four says nothing or is of an engine that fails; 1: otherwise; "
            "2: wrong input; 3: results or --out could not be written; "
            "130: interrupted.\n\n"
            f"Example: multibody-xval run {name}{' --record quake.csv' if name == RECORD else ''} --engine mujoco "
            "--out verdicts.md"
        )
        if name not in STUDIES:
            app.command(name, help=text)(follow if name == RECORD else named)
    for name, study in STUDIES.items():
        app.command(name)(study)


_add_scenarios()


def _judge(
    names: Sequence[str],
    engines: Engines,
    verdicts: Verdicts,
    work: Work,
    record: Path | None = None,
) -> None:
    """Run scenarios, of which the only one may follow a record, and end with the exit code of their verdicts."""
    work.check(run=verdicts.run)
    outs = check_outs(verdicts.out, ENDINGS, verdicts.store, record)
    from multibody_xval.scenarios.catalogue.base import run_with_predictions
    from multibody_xval.scenarios.catalogue.registry import CATALOGUE
    from multibody_xval.scenarios.catalogue.transient.record import Record
    from multibody_xval.scenarios.catalogue.verdict_table import VERDICT_FORMATS
    from multibody_xval.scenarios.verdicts.finding import failures

    asked = list(CATALOGUE.values()) if ALL_SCENARIOS in names else [CATALOGUE[name] for name in dict.fromkeys(names)]
    options = [] if verdicts.run else ["--no-run"]
    if record is not None:
        followed = Record(record)
        followed.check()
        asked, options = [followed], [f"--record={record}", *options]
    variants = {each: each.variants(engines.names) for each in asked}
    shown = list(dict.fromkeys(variant for own in variants.values() for variant in own))
    with work.evaluator(verdicts.store, shown, run=verdicts.run) as evaluator:
        results = {each: run_with_predictions(each, own, evaluator) for each, own in variants.items()}
    print_results(results)
    for out in outs:
        write_whole(out, VERDICT_FORMATS[out.suffix](results, engines.command(" ".join(names), options)))
    if any(failures(findings) for findings in results.values()):
        raise typer.Exit(ExitCode.FAILED)


def print_results(results: Results) -> None:
    """Print the table of each scenario and what does not agree, the matrix of several, laws, and what fails."""
    from rich.console import Console

    from multibody_xval.scenarios import tables
    from multibody_xval.scenarios.catalogue.verdict_table import details, law_in_words, matrix, verdict_table
    from multibody_xval.scenarios.verdicts.finding import engine_failures, failures

    console = Console()
    for scenario, findings in results.items():
        console.print(f"\n[bold]{scenario.name}[/bold]: {tables.plain(scenario.question)}", soft_wrap=True)
        console.print(tables.plain(f"compared with {scenario.expects}", *scenario.parameters()), soft_wrap=True)
        tables.print_table(verdict_table(findings))
        for variant, remarks in details(findings):
            console.print(tables.plain(f"{variant}:", *(f"  {remark}" for remark in remarks)), soft_wrap=True)
    if len(results) > 1:
        tables.print_table(matrix(results))
    every = [finding for own in results.values() for finding in own]
    for variant in dict.fromkeys(finding.variant for finding in every if finding.modelled):
        console.print(tables.plain(f"as its law predicts, {variant}: {law_in_words(variant)}"), soft_wrap=True)
    for scenario, own in results.items():
        for line in (*engine_failures(own), *failures(own)):
            console.print(tables.plain(f"{scenario.name}: {line}"), soft_wrap=True)
