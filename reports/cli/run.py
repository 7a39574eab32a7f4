"""``multibody-xval run``: scenarios of the catalogue, one or all of them, and measurements."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from multibody_xval.reports.cli import scenario
from multibody_xval.reports.cli.options import Engines, Store, Work, check_outs, grouped
from multibody_xval.reports.cli.studies import TABLE_ENDINGS, TableFile, accuracy, figure3, work_precision
from reference_lcp.errors import ExitCode
from reference_lcp.output import write_whole
from reference_lcp.terminal import print_table, tracked, visible

if TYPE_CHECKING:
    from multibody_xval.scenarios.tables import Column, Row

STUDIES = {"figure3": figure3, "accuracy": accuracy, "work-precision": work_precision}
"""Measurements of several points and engines; the first one answers the paper's claims too."""

EXPERIMENTS = {
    "accuracy": "How large are the errors of each engine, formulation and preset, compared with the exact motion?",
    "laws": "How well does the law of each preset predict its engine, number by number and over a period?",
    "proofs": "What is the exact transmittance at every point of the standard grids, proven?",
    "work-precision": "How large is each engine's error to the proven value, over the time of a simulated second?",
    "recipes": "Which options make friction hold in a user's own model, in each engine, and what do they cost?",
}


class ByName(TyperGroup):
    """A group with a command for every scenario, which is made when it is used."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Give the names of scenarios, then those of measurements."""
        return list(dict.fromkeys([*scenario.names(), *self.commands]))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Give the command of a measurement or a scenario."""
        if cmd_name not in self.commands and cmd_name in scenario.names():
            self.commands[cmd_name] = scenario.command(cmd_name)
        return self.commands.get(cmd_name)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Give the command that is named; of a name that is none, the message has those most like it."""
        if self.get_command(ctx, args[0]) is None:
            for name in scenario.names():
                self.get_command(ctx, name)
        return super().resolve_command(ctx, args)


app = typer.Typer(name="multibody-xval run", cls=ByName, add_completion=False, pretty_exceptions_enable=False)


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
    print_table(("scenario", "question"), scenario.questions())
    print_table(("measurement", "question"), list(EXPERIMENTS.items()))
    print("multibody-xval run NAME runs one, multibody-xval run all every scenario.")


for _name, _study in STUDIES.items():
    app.command(_name)(_study)


@app.command()
@grouped
def laws(engines: Engines, *, store: Store = None, out: TableFile = None, work: Work) -> None:
    """Compare engines with the laws of their presets: deviation from the reference, and error of the prediction.

    Exit code 0: the table is complete, whatever its numbers; 2: wrong input; 3: results or --out could not be written;
    130: interrupted.

    Example: multibody-xval run laws --engine mujoco --out laws.md
    """
    from multibody_xval.scenarios.studies.law_agreement import (
        LAW_COLUMNS,
        beside_the_reference,
        law_agreements,
        law_document,
    )

    shown = beside_the_reference(engines.variants())
    check_outs([out], TABLE_ENDINGS, store)
    with work.evaluator(store, shown) as evaluator:
        rows = law_agreements(shown, evaluator)
    _end(out, LAW_COLUMNS, LAW_COLUMNS, rows, lambda: law_document(rows, engines.command("laws")))


@app.command()
def proofs(
    *,
    sample: Annotated[int | None, typer.Option(help="Prove so many points at random instead of all.")] = None,
    seed: Annotated[int, typer.Option(help="Of the sample.")] = 0,
    out: Annotated[Path | None, typer.Option(help="Write the proven levels here, as .csv.")] = None,
) -> None:
    """Prove the steady states of standard grids and catalogue, and compare their levels with the table of the suite.

    Levels on both sides of the edges of the band are proven too, unless it is a sample.
    Exit code 0: all are as in the table; 1: one is not; 2: wrong input; 3: --out could not be written;
    130: interrupted.

    Example: multibody-xval run proofs --sample 20
    """
    check_outs([out], (".csv",))
    from multibody_xval.scenarios import tables
    from multibody_xval.scenarios.catalogue import proofs as study
    from multibody_xval.scenarios.verdicts.proven import DIGITS
    from reference_lcp.defaults import PROOF_TIME_LIMIT
    from reference_lcp.exact.proof.prove import check_request

    tasks = study.chosen_tasks(sample, seed)
    check_request(DIGITS, PROOF_TIME_LIMIT)
    found = [study.proof_of(task) for task in tracked(tasks, "points")]
    tables.print_table(tables.text_table(study.PROOF_COLUMNS, study.by_chain(found)))
    for proof in found:
        if proof.proven is None or not proof.in_table:
            other = "" if proof.in_table else "not as in the table; "
            print(visible(f"{proof.label}: {other}{proof.reason or proof.level}"))
    edges = study.edge_proofs() if sample is None else []
    for edge in edges:
        print(edge)
    for friction in dict.fromkeys(edge.friction_ratio for edge in edges):
        known, steps = study.known_steps(friction)
        print(f"friction {friction:g}: all crossings are known in {known} of {steps} steps of the grid: nothing slips")
    if out is not None:
        write_whole(out, study.table_text(found))
    if not all([*(proof.in_table for proof in found), *(edge.crosses for edge in edges)]):
        raise typer.Exit(ExitCode.FAILED)


@app.command()
@grouped
def recipes(
    *,
    chosen: Annotated[
        list[str] | None,
        typer.Option("--engine", metavar="NAME[:FORMULATION]", help="An engine; may be repeated. Without it, all."),
    ] = None,
    store: Store = None,
    out: TableFile = None,
    work: Work,
) -> None:
    """Measure every set of the options that a recipe changes, in all scenes: creep, cost of a step, what gets worse.

    Exit code 0: the table is complete, whatever its numbers; 2: wrong input; 3: results or --out could not be written;
    130: interrupted.

    Example: multibody-xval run recipes --engine mujoco
    """
    check_outs([out], TABLE_ENDINGS, store)
    from multibody_xval.scenarios.catalogue.scenes.recipes import RECIPE_COLUMNS, named_recipes, study

    recommended = named_recipes(chosen or [])
    with work.evaluator(store, recommended) as evaluator:
        rows = [row for each in recommended for row in study(each, evaluator)]
    _end(out, RECIPE_COLUMNS, RECIPE_COLUMNS, rows)


def _end(
    out: Path | None,
    columns: Sequence[Column[Row]],
    printed: Sequence[Column[Row]],
    rows: Sequence[Row],
    document: Callable[[], str] | None = None,
    remarks: Sequence[str] = (),
) -> None:
    """Print a table with remarks, and write it: as a document, only the table if there is none, or in full as CSV."""
    from multibody_xval.scenarios import tables

    text = tables.text_table(printed, rows)
    tables.print_table(text)
    for remark in remarks:
        print(visible(remark))
    if out is not None:
        written = document() if document is not None else "\n".join([*tables.markdown_lines(text), ""])
        _write_table(out, columns, rows, written)


def _write_table(out: Path, columns: Sequence[Column[Row]], rows: Sequence[Row], document: str) -> None:
    """Write a table in full as CSV, or else a document with it."""
    from multibody_xval.scenarios.tables import csv_text, full_table

    write_whole(out, csv_text(full_table(columns, rows)) if out.suffix == ".csv" else document)
