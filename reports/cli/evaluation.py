"""What commands run with: variants, a store, an evaluator with bars on the way."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import typer

from engines.interface.variant import EVERY_VARIANT, Variant, variants_named
from reference_lcp.errors import ExitCode
from reference_lcp.process import announce_interrupt
from reference_lcp.terminal import announce_compilation
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.executor import Executor
from scenarios.runs.progress import ProgressBars
from scenarios.runs.store import ResultStore, opened_store
from scenarios.runs.task import Task


def chosen_variants(chosen: Sequence[str]) -> list[Variant]:
    """Give the variants of the chosen names, see `variants_named`; those of every engine without any."""
    return variants_named(chosen or [EVERY_VARIANT])


@contextmanager
def store_of_run(store: Path | None) -> Iterator[ResultStore]:
    """Open the store of a run, a temporary one if none is named; Ctrl-C prints what is kept and ends the command."""
    announce_compilation()
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
) -> Iterator[Evaluator]:
    """Evaluate with the store of a run, see `store_of_run`, and bars on the way."""
    with (
        store_of_run(store) as stored,
        ProgressBars(shown, expected) as bars,
        Evaluator(stored, executor, bars, retry_blocked=retry_blocked) as evaluator,
    ):
        yield evaluator
