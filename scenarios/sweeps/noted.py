"""Sweeps noted in the store of their results, so that a report can be made of the store alone."""

from pathlib import Path

from pydantic import ValidationError

from reference_lcp.refusal import ParameterError
from scenarios.execution.store import ResultStore
from scenarios.execution.store_file import existing_store
from scenarios.sweeps.dataset import SWEEP
from scenarios.sweeps.sweep import Sweep
from scenarios.tasks.validation_message import first_error


def note_sweep(store: ResultStore, sweep: Sweep) -> None:
    """Write a sweep into the store of its results, as the latest one."""
    store.note(SWEEP.dump_json(sweep).decode())


def noted_sweep(file: Path) -> Sweep:
    """Give the sweep that was noted last.

    Raises
    ------
    ParameterError
        If there is none, or the file is no store.
    """
    with ResultStore(existing_store(file)) as store:
        store.check_pages()
        text = store.noted()
    if text is None:
        raise ParameterError(f"store {file} holds no sweep; allowed: a store of a sweep or of a report")
    try:
        return SWEEP.validate_json(text)
    except ValidationError as problem:
        error = first_error(problem, "what a sweep that was noted has")
        raise ParameterError(f"store {file}: its sweep cannot be read: {error}") from None
