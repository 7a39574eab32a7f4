"""``python -m scenarios run NAME``: a scenario of the catalogue, or all of them."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from scenarios.catalogue.descriptions import ALL_SCENARIOS, DESCRIPTIONS
from scenarios.cli.options import (
    Chosen,
    Limit,
    Retry,
    Scheduler,
    Settings,
    Store,
    Workers,
    check_outs,
    check_retry,
    with_settings,
)
from scenarios.execution.limits import TIME_LIMIT

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


Ask = Annotated[bool, typer.Option(help="Run missing points; --no-ask judges only the results in --store.")]


def add_scenarios(run: typer.Typer) -> None:
    """Add a command for every scenario of the catalogue, and one for all of them."""
    for name, description in DESCRIPTIONS.items():
        add = _add_record if name == RECORD else _add
        add(run, name, [name], f"{description.question} Compared with: {description.expects}.")
    _add(
        run,
        ALL_SCENARIOS,
        list(DESCRIPTIONS),
        "Run every scenario of the catalogue, and print a table of scenarios and variants.",
    )


def _help(name: str, summary: str, options: str = "") -> str:
    """Give the help of a command: the physical question, the exit codes, an example."""
    return (
        f"{summary}\n\nExit code 0: every disagreement is as its law predicts, and three in four numbers of each "
        "preset are certified; 1: otherwise; 2: wrong input; 3: results or --out could not be written; "
        "130: interrupted.\n\n"
        f"Example: python -m scenarios run {name}{options} --engine mujoco --out verdicts.md"
    )


def _add(run: typer.Typer, name: str, scenarios: Sequence[str], summary: str) -> None:
    """Add the command of a scenario without parameters, or of several."""

    @run.command(name, help=_help(name, summary))
    def command(
        chosen: Chosen = None,
        settings: Settings = None,
        store: Store = None,
        out: Out = None,
        ask: Ask = True,
        workers: Workers = None,
        time_limit: Limit = TIME_LIMIT,
        scheduler: Scheduler = None,
        retry_blocked: Retry = False,
    ) -> None:
        check_retry(ask, retry_blocked)
        outs = check_outs(out, ENDINGS, [store])
        from scenarios.cli.verdicts import perform, planned_run
        from scenarios.execution.workers.dask_cluster import executor_for

        planned = planned_run(
            name, scenarios, with_settings(chosen, settings), [] if ask else ["--no-ask"], retry_blocked
        )
        perform(planned, store, outs, executor_for(workers, time_limit, scheduler) if ask else None)


def _add_record(run: typer.Typer, name: str, scenarios: Sequence[str], summary: str) -> None:
    """Add the command of the scenario whose base follows a file."""

    @run.command(name, help=_help(name, summary, " --record quake.csv"))
    def command(
        chosen: Chosen = None,
        settings: Settings = None,
        record: Annotated[
            Path | None,
            typer.Option(help="CSV table of time in s and displacement in m; without it, the suite's example."),
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
        outs = check_outs(out, ENDINGS, [store, record])
        from scenarios.cli.verdicts import perform, planned_run
        from scenarios.execution.workers.dask_cluster import executor_for

        options = [] if record is None else [f"--record={record}"]
        options = options if ask else [*options, "--no-ask"]
        planned = planned_run(name, scenarios, with_settings(chosen, settings), options, retry_blocked, record)
        perform(planned, store, outs, executor_for(workers, time_limit, scheduler) if ask else None)
