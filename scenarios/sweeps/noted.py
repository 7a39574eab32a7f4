"""Sweeps noted in the store of their results, so that a report can be made of the store alone."""

from pathlib import Path

from reference_lcp.validation import ParameterError
from scenarios.execution.store import ResultStore
from scenarios.sweeps.dataset import SWEEP
from scenarios.sweeps.sweep import Sweep


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
    allowed = "allowed: a store of a sweep or of a report"
    if not file.is_file():
        raise ParameterError(f"store {file} does not exist; {allowed}")
    with ResultStore(file) as store:
        text = store.noted()
    if text is None:
        raise ParameterError(f"store {file} holds no sweep; {allowed}")
    return SWEEP.validate_json(text)
