"""What the commands of ``python -m scenarios`` have in common: options, checks, a store for the run."""

import shlex
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from engines.interface.registry import engine_names
from engines.interface.variant import Variant, variants_named
from reference_lcp.console import checked_output_file
from reference_lcp.exit_code import ExitCode
from reference_lcp.interrupt import announce_interrupt
from reference_lcp.validation import ParameterError
from scenarios.execution.executor import Executor
from scenarios.execution.progress import CountingEvaluator, ProgressBars
from scenarios.execution.store import ResultStore, opened_store
from scenarios.tasks.task import Task

Chosen = Annotated[
    list[str] | None,
    typer.Option(
        "--engine",
        metavar="NAME[:FORMULATION[:PRESET]]",
        help="An engine in all its formulations and presets, or the one that is named; may be repeated. "
        "Without it, or with all: every engine.",
    ),
]
Store = Annotated[
    Path | None, typer.Option(help="File that keeps every result, so that a stopped run goes on; none without it.")
]
TableFile = Annotated[Path | None, typer.Option(help="Write the table here: Markdown as .md, full precision as .csv.")]
Workers = Annotated[int | None, typer.Option(help="Worker processes; without it, one a processor.")]
Limit = Annotated[
    float, typer.Option(help="Seconds that a batch of points may take; an engine that hangs is stopped then.")
]
Scheduler = Annotated[
    str | None, typer.Option(help="Address of a dask scheduler whose workers compute, instead of this machine's.")
]
Retry = Annotated[
    bool,
    typer.Option(
        "--retry-blocked",
        help="Run again the points at which, by the store, their engine has failed: crashed, raised an error or passed "
        "the time limit.",
    ),
]


TABLE_ENDINGS = (".md", ".csv")
"""Formats of a `TableFile`."""


def chosen_variants(chosen: list[str] | None) -> list[Variant]:
    """Give the variants of the chosen names: whole engines, or single variants.

    Raises
    ------
    ParameterError
        If there is no such engine, formulation or preset.
    """
    names = engine_names() if not chosen or "all" in chosen else chosen
    return list(dict.fromkeys(variant for name in names for variant in variants_named(name)))


def check_out(out: Path | None, endings: tuple[str, ...], inputs: Iterable[Path | None]) -> None:
    """Refuse a file that cannot be written, whose ending names no format, or that is one of `inputs`.

    Raises
    ------
    ParameterError
        Names the file, and what is allowed.
    """
    if out is None:
        return
    if out.suffix not in endings:
        raise ParameterError(f"--out = {out} has the ending {out.suffix!r}; allowed: {' or '.join(endings)}")
    checked_output_file("--out", out, inputs)


def check_retry(ask: bool, retry_blocked: bool) -> None:
    """Refuse to run points again where nothing is run.

    Raises
    ------
    ParameterError
        If both are wanted.
    """
    if retry_blocked and not ask:
        raise ParameterError("--retry-blocked with --no-ask, which runs nothing; allowed: one of the two")


@contextmanager
def store_of_run(store: Path | None) -> Iterator[ResultStore]:
    """Open the store of a run, a temporary one if none is named; Ctrl-C prints what is kept and ends the command.

    Raises
    ------
    ParameterError
        If `store` cannot be used.
    """
    with opened_store(store) as stored:
        try:
            yield stored
        except KeyboardInterrupt:
            where = "nothing is kept without --store"
            if store is not None:
                where = f"results are kept in {store}; the same command goes on from there"
            announce_interrupt(f"interrupted: {where}")
            raise typer.Exit(ExitCode.INTERRUPTED) from None


@contextmanager
def evaluator_of_run(
    store: Path | None,
    executor: Executor,
    shown: Sequence[Variant],
    expected: Sequence[Task] = (),
    *,
    retry_blocked: bool = False,
) -> Iterator[CountingEvaluator]:
    """Evaluate with the store of a run, see `store_of_run`, and bars on the way.

    Parameters
    ----------
    store, executor, retry_blocked
        As for `Evaluator`; a temporary store without one.
    shown
        Variants that have a bar from the start.
    expected
        Tasks that are known from the start.
    """
    with (
        store_of_run(store) as stored,
        ProgressBars(shown) as bars,
        CountingEvaluator(stored, executor, expected, bars, retry_blocked=retry_blocked) as evaluator,
    ):
        yield evaluator


def command_text(name: str, chosen: Sequence[str] | None, options: Sequence[str] = ()) -> str:
    """Give the command that made a document: `run` with its name, the chosen engines and other options."""
    return shlex.join(["python", "-m", "scenarios", "run", name, *(f"--engine={c}" for c in chosen or []), *options])
