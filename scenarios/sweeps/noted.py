"""Sweeps noted in the store of their results, so that a report can be made of the store alone."""

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from reference_lcp.refusal import ParameterError
from scenarios.execution.storage.store import ResultStore
from scenarios.execution.storage.store_file import existing_store
from scenarios.sweeps.dataset import SWEEP
from scenarios.sweeps.sweep import Sweep
from scenarios.tasks.validation_message import first_error


def note_sweep(store: ResultStore, sweep: Sweep) -> None:
    """Write a sweep into the store of its results, as the latest one."""
    store.note(SWEEP.dump_json(sweep).decode())


@dataclass(frozen=True)
class NotedSweeps:
    """What a store knows of the sweeps whose results it holds.

    Parameters
    ----------
    sweep
        The latest one, with the variants of all others of the same points.
    others
        The latest one of each other set of points.
    """

    sweep: Sweep
    others: tuple[Sweep, ...] = ()


def noted_sweeps(file: Path) -> NotedSweeps:
    """Give the sweeps that were noted in a store.

    Raises
    ------
    ParameterError
        If there is none, or the file is no store.
    """
    with ResultStore(existing_store(file)) as store:
        store.check_pages()
        texts = store.noted()
    if not texts:
        raise ParameterError(f"store {file} holds no sweep; allowed: a store of a sweep or of a report")
    merged: list[Sweep] = []
    for text in texts:
        read = _read(file, text)
        same = next((n for n, each in enumerate(merged) if _points(each) == _points(read)), None)
        if same is None:
            merged.append(read)
        else:
            variants = dict.fromkeys((*merged[same].variants, *read.variants))
            merged[same] = replace(merged[same], variants=tuple(variants))
    return NotedSweeps(merged[0], tuple(merged[1:]))


def _read(file: Path, text: str) -> Sweep:
    try:
        return SWEEP.validate_json(text)
    except ValidationError as problem:
        error = first_error(problem, "what a sweep that was noted has")
        raise ParameterError(f"store {file}: its sweep cannot be read: {error}") from None


def _points(sweep: Sweep) -> dict[str, Any]:
    """Give everything of a sweep but its variants, whatever the order of its values."""
    content = vars(sweep.ascending())
    return {each.name: content[each.name] for each in fields(Sweep) if each.name != "variants"}
