"""``multibody-xval run NAME`` where the name is that of a scenario: a question whose answer is known."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from multibody_xval.reports.cli.compiling import announce_compilation
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.reports.cli.options import (
    COMMENT_ENDINGS,
    Computing,
    ScenarioEngines,
    Store,
    check_outs,
    grouped,
    keeping,
)
from multibody_xval.scenarios.output_files import write_whole
from reference_lcp.errors import ParameterError

if TYPE_CHECKING:
    import pandas as pd

    from multibody_xval.reports.answer_files import Answer
    from multibody_xval.scenarios.catalogue.scenario import Scenario

ALL = "all"

EXIT_CODES = (
    "Exit code 0: no judged number deviates; 1: one does, or more than a quarter of the numbers of a judged preset or "
    "of the runs of a named engine are missing."
)


Others = Annotated[list[str] | None, typer.Argument(help="Other scenarios to run.")]


@dataclass(frozen=True)
class Output:
    """Where results come from, and what of them is shown and written."""

    store: Store = None
    out: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE", help="Write a short comment as .md, or every number as .json or .csv; may be repeated."
        ),
    ] = None
    series: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Write the motions row by row, as .csv; needs --store."),
    ] = None
    transitions: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE", help="Write when contacts stick and slip over the period, as .csv; needs --store."
        ),
    ] = None
    details: Annotated[bool, typer.Option("--details", help="Print every number, what it means, and the source.")] = (
        False
    )
    run: Annotated[
        bool,
        typer.Option(
            "--run/--no-run",
            help="Run what is missing, or only show --store.",
            show_default=False,
        ),
    ] = True

    def check(self, record: Path | None) -> None:
        """Refuse files that cannot be written; whole motions are read from the store."""
        inputs = [*check_outs(self.out, COMMENT_ENDINGS, self.store, record), self.store, record]
        for name, files in (("--series", self.series), ("--transitions", self.transitions)):
            if files and self.store is None:
                given = f"{name} = {files[0]} without --store"
                raise ParameterError(f"{given}; allowed: with a store, which holds the runs")
            inputs += check_outs(files, [".csv"], *inputs, name=name)


def names() -> list[str]:
    """Give the names of all scenarios, and of all together."""
    from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS

    return [*SCENARIOS, ALL]


def command(name: str) -> Any:
    """Make the command of a scenario, or of all."""
    from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS

    own = SCENARIOS.get(name)
    follows = own is not None and own.of_record is not None
    what = "Run every scenario." if own is None else f"{own.question} Expected: {own.expects}."
    options = " --record quake.csv" if follows else ""
    text = f"{what}\n\n{EXIT_CODES}\n\nExample: multibody-xval run {name}{options} --engine mujoco --out numbers.md"
    made = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    made.command(name, help=text)(_followed if follows else _named)
    return typer.main.get_command(made)


@grouped
def _named(
    context: typer.Context,
    others: Others = None,
    *,
    engines: ScenarioEngines,
    output: Output,
    computing: Computing,
) -> None:
    """Run the scenario that the command is named after, or all, and others."""
    _answer([str(context.info_name), *(others or ())], engines, output, computing)


@grouped
def _followed(
    context: typer.Context,
    others: Others = None,
    *,
    engines: ScenarioEngines,
    record: Annotated[
        Path | None,
        typer.Option(help="CSV table of time in s and displacement in m; without it, the suite's example."),
    ] = None,
    output: Output,
    computing: Computing,
) -> None:
    """Run the scenario whose base follows a file, and others."""
    _answer([str(context.info_name), *(others or ())], engines, output, computing, record)


def _answer(
    asked: Sequence[str], engines: ScenarioEngines, output: Output, computing: Computing, record: Path | None = None
) -> None:
    """Run scenarios, of which the first may follow a record, print what has come out, and end with its code."""
    computing.check(output.store, run=output.run)
    output.check(record)
    from multibody_xval.reports.answer_files import WRITTEN, Answer
    from multibody_xval.scenarios.catalogue.asking import named_scenarios

    scenarios, options = named_scenarios(asked), [] if output.run else ["--no-run"]
    if record is not None and scenarios[0].of_record is not None:
        scenarios, options = [scenarios[0].of_record(record), *scenarios[1:]], [f"--record={record}", *options]
    rows = _rows(scenarios, engines, output, computing)
    answer = Answer(scenarios, rows, engines.command(" ".join(asked), options), named=bool(engines.names))
    for out in output.out or ():
        write_whole(out, WRITTEN[out.suffix](answer))
    _write_motions(answer, output)
    _print(answer, details=output.details)
    if answer.reasons:
        raise typer.Exit(ExitCode.FAILED)


def _rows(
    scenarios: Sequence[Scenario], engines: ScenarioEngines, output: Output, computing: Computing
) -> pd.DataFrame:
    """Give the numbers of scenarios: what the store lacks is run, or not."""
    from multibody_xval.scenarios.catalogue.asking import answers, stored_answers

    if not output.run:
        assert output.store is not None, "checked before"
        return stored_answers(scenarios, engines.names, output.store)
    means = computing.means(output.store)
    engines.announce_absent()
    announce_compilation()
    with keeping(output.store):
        return answers(scenarios, engines.names, means)


def _write_motions(answer: Answer, output: Output) -> None:
    """Write the rows of motions and the transitions of steady states of what was asked, as far as that is wanted."""
    from multibody_xval.scenarios.catalogue.motion_tables import series, transitions
    from multibody_xval.scenarios.running.evaluate import stored_results
    from multibody_xval.scenarios.table_text import csv_text

    for table, files in ((series, output.series), (transitions, output.transitions)):
        for file in files or ():
            assert output.store is not None, "checked before"
            rows = table(answer.scenarios, stored_results(output.store), set(answer.rows.configuration))
            write_whole(file, csv_text(rows, missing=""))
            if rows.empty:
                print(f"{file}: no rows, since there are no {table.__name__} among these runs", file=sys.stderr)


def _print(answer: Answer, *, details: bool) -> None:
    """Print what was asked and the numbers: of one scenario its worst cases, of several a row each."""
    from rich.console import Console

    from multibody_xval.reports import answers
    from multibody_xval.scenarios.catalogue.finding import MOST_NAMED
    from multibody_xval.scenarios.table_text import plain, print_table

    console = Console()
    one = len(answer.scenarios) == 1
    for scenario in answer.scenarios if one or details else ():
        rows = answer.of(scenario)
        question, source, expected, cases, *parameters = answers.asked(scenario, rows)
        lines = [source, expected, cases, *parameters] if details else [cases, expected]
        console.print(f"[bold]{scenario.name}[/bold]: {plain(question)}", highlight=False)
        console.print(plain(*lines), highlight=False)
        for title, table in answers.tables(rows, details=details):
            print_table(table, title)
        for line in (answers.meanings(scenario), *answers.errors(rows)):
            console.print(plain(line), highlight=False)
    if not one:
        print_table(answers.overview(answer.rows))
    reasons = answers.why(answer.rows)
    listed = reasons if details else reasons[: answers.MOST_REASONS]
    rest = [f"{len(reasons) - len(listed)} more reasons: --details"] if len(listed) < len(reasons) else []
    for line in (*listed, *rest, *answer.reasons[MOST_NAMED:], answer.conclusion):
        console.print(plain(line), highlight=False)
