"""Results kept in one SQLite file: what has been computed once is never computed again."""

import itertools
import sqlite3
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TypeVar

from reference_lcp.validation import ParameterError
from scenarios.execution.closing import Closing
from scenarios.tasks.result import Result, ResultStatus, ResultSummary
from scenarios.tasks.task import Task, key_of

APPLICATION_ID = 0x4D425856
"""Marks the file as a store of this suite ("MBXV") in SQLite's header."""

LOOKUP = 500
"""Tasks that are looked up at once."""

SCHEMA_VERSION = 1
"""Layout of the tables."""


_Parsed = TypeVar("_Parsed", Result, ResultSummary)


class ResultStore(Closing):
    """Results by the hash of their tasks; every result is on disk when `keep` returns.

    Parameters
    ----------
    file
        The store; made if it is missing.

    Raises
    ------
    ParameterError
        If `file` is not a store of this suite, is damaged or cannot be written; it is left as it is.
    """

    def __init__(self, file: Path):
        self._file = file
        try:
            self._connection = sqlite3.connect(file)
            self._open()
        except sqlite3.Error as problem:
            raise ParameterError(f"store {file} cannot be used: {problem}") from None

    def _open(self) -> None:
        """Check that the file is a store, then make the table in a new one."""
        owner = self._connection.execute("PRAGMA application_id").fetchone()[0]
        tables = self._connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
        if tables and owner != APPLICATION_ID:
            raise ParameterError(f"store {self._file} belongs to another program; allowed: a new file or a store")
        version = self._connection.execute("PRAGMA user_version").fetchone()[0]
        if tables and version != SCHEMA_VERSION:
            raise ParameterError(f"store {self._file} has layout {version}; allowed: {SCHEMA_VERSION}")
        # takes and gives back the write lock: a file that cannot be written is found out before any work
        self._connection.execute("BEGIN IMMEDIATE")
        self._connection.rollback()
        if not tables:
            self._connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
            self._connection.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")
            with self._connection:
                self._connection.execute(
                    "CREATE TABLE answers (key TEXT PRIMARY KEY, content TEXT NOT NULL, answer TEXT NOT NULL)"
                )

    def find(self, task: Task) -> Result | None:
        """Give the result of an equal task, or ``None``."""
        return next(self.results([task]))

    def results(self, tasks: Iterable[Task]) -> Iterator[Result | None]:
        """Give the result of each task, in order, or ``None``."""
        for text in self._texts(tasks, "answer"):
            yield None if text is None else self._read(Result.from_json, text)

    def summaries(self, tasks: Iterable[Task]) -> Iterator[ResultSummary | None]:
        """Give how each task ended, in order, or ``None``; numbers are left unread."""
        for text in self._texts(tasks, "json_extract(answer, '$.status', '$.periods', '$.multiple')"):
            yield None if text is None else self._read(ResultSummary.from_json, text)

    def _read(self, parse: Callable[[str], _Parsed], text: str) -> _Parsed:
        """Read one result; an error names the store."""
        try:
            return parse(text)
        except ParameterError as problem:
            raise ParameterError(f"store {self._file}: {problem}") from None

    def _texts(self, tasks: Iterable[Task], column: str) -> Iterator[str | None]:
        """Look up an expression of SQL for each task, many at a time."""
        remaining = iter(tasks)
        while chunk := list(itertools.islice(remaining, LOOKUP)):
            keys = [task.key() for task in chunk]
            marks = ",".join("?" * len(keys))
            rows = dict(self._connection.execute(f"SELECT key, {column} FROM answers WHERE key IN ({marks})", keys))
            yield from (rows.get(key) for key in keys)

    def keep(self, results: Iterable[tuple[Task, Result]]) -> None:
        """Write results in one transaction; blocked ones are not kept, so that they are tried again."""
        texts = [
            (task.text(), result.to_json()) for task, result in results if result.status is not ResultStatus.BLOCKED
        ]
        rows = [(key_of(task), task, result) for task, result in texts]
        with self._connection:
            self._connection.executemany("INSERT OR REPLACE INTO answers VALUES (?, ?, ?)", rows)

    def close(self) -> None:
        """Close the file."""
        self._connection.close()
