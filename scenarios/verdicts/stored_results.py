"""The results of a store, each with what it depends on."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from engines.interface.law_engine import LAW_SUFFIX
from engines.interface.variant import Variant
from reference_lcp.refusal import ParameterError
from scenarios.execution.storage.store import ResultStore
from scenarios.execution.storage.store_file import existing_store
from scenarios.tasks.result import Result
from scenarios.tasks.validation_message import first_error


@dataclass(frozen=True)
class _Content:
    """The part of a task's content that results are compared by, see `Task.content`."""

    format: int
    task: dict[str, Any]
    version: str
    options: dict[str, str]


_CONTENT = TypeAdapter(_Content)


@dataclass(frozen=True)
class StoredResult:
    """One result of a store, with what it depends on.

    Parameters
    ----------
    task
        The task as plain data: the same for every version and every set of options.
    format
        Format of the result: what its numbers mean.
    version, options
        Of the engine that ran it; options by name, as text.
    result
        Its result.
    """

    task: Mapping[str, Any]
    format: int
    version: str
    options: Mapping[str, str]
    result: Result

    @property
    def engine(self) -> str:
        """Its engine, with ``@VERSION`` where that is one of several."""
        return str(self.task["variant"]["engine"])

    @property
    def unversioned_engine(self) -> str:
        """Its engine without ``@VERSION``; the model of an engine's law is another engine."""
        return self.engine if self.engine.endswith(LAW_SUFFIX) else self.engine.partition("@")[0]

    @property
    def variant(self) -> str:
        """Give its name, as everywhere."""
        return str(Variant(*(self.task["variant"][name] for name in ("engine", "formulation", "preset_name"))))

    def key(self, *, versioned: bool = True) -> str:
        """Give the task as one text, with or without the version in the name of the engine."""
        if versioned:
            return json.dumps(self.task, sort_keys=True)
        variant = self.task["variant"] | {"engine": self.unversioned_engine}
        return json.dumps({**self.task, "variant": variant}, sort_keys=True)


def read_all(file: Path) -> dict[str, StoredResult]:
    """Give every result of a store by its task, without version and options; of several the latest.

    Raises
    ------
    ParameterError
        If the file is missing, is no store, or is damaged.
    """
    return {stored.key(): stored for stored in _rows(existing_store(file))}


def _rows(file: Path) -> Iterator[StoredResult]:
    with ResultStore(file) as store:
        store.check_pages()
        for content, result in store.all_results():
            about = _read(file, content)
            yield StoredResult(about.task, about.format, about.version, about.options, result)


def _read(file: Path, content: str) -> _Content:
    """Read what a row of a store is about."""
    try:
        return _CONTENT.validate_json(content)
    except ValidationError as problem:
        raise ParameterError(f"store {file}: {first_error(problem, 'format, task, version, options')}") from None
