"""Results kept in one SQLite file: what has been computed once is never computed again.

SQLite notices damage of the file, which is then refused and left as it is. While another process has the file locked,
or the disk is full, the store waits and tries again.
"""

import itertools
import sqlite3
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager
from functools import cached_property
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, TypeVar

from multibody_xval.scenarios import store as stores
from multibody_xval.scenarios.runs.recorded import ARRAYS
from multibody_xval.scenarios.runs.result import NamedNumbers, Result, ResultStatus
from multibody_xval.scenarios.runs.scratch import Closing, ScratchFolder
from multibody_xval.scenarios.runs.task import SOME, Recorded, SteadyStateTask, Task, key_of, unsourced_key
from reference_lcp.errors import ParameterError, RunError, checked_path

LARGEST_TEXT = 2**28
"""Bytes that one text of a store may have; a period of 1,000 cells, recorded in full, takes a tenth of it."""

LARGEST_LEVEL = 6000.0
"""Size of a transmittance [dB] beyond which amplitudes are no numbers of double precision."""

SPECIAL_NAMES = (":", "file:")
"""How names begin that SQLite knows for something else than a file of this name."""

ATTEMPT_SECONDS = 0.5
"""How long SQLite waits for a lock; Ctrl-C is heard between such attempts."""


def checked_store(file: Path) -> Path:
    """Give `file` if SQLite would keep a store under this name, and it is neither folder nor device."""
    if str(file).startswith(SPECIAL_NAMES):
        raise ParameterError(f"store {file} keeps nothing or means another file; allowed: the path of a file")
    path = checked_path("store", file)
    if path.exists() and not path.is_file():
        raise ParameterError(f"store {file} is a folder or a device; allowed: a file")
    if not path.absolute().parent.is_dir():
        raise ParameterError(
            f"store {file}: there is no folder {path.parent}; allowed: a file in a folder that is there"
        )
    return file


def existing_store(file: Path | None) -> Path:
    """Give `file` if it is there: a misspelt name makes no empty store."""
    if file is None:
        raise ParameterError("--store is missing; allowed where nothing is run: a store that is there")
    if not checked_store(file).is_file():
        raise ParameterError(f"store {file} does not exist; allowed where nothing is run: a store that is there")
    return file


def connected(file: Path) -> sqlite3.Connection:
    """Open a store; texts are read as bytes, and what else than tables stands in it is not trusted."""
    address = f"{checked_store(file).resolve().as_uri()}?mode=rwc"
    connection = sqlite3.connect(address, timeout=ATTEMPT_SECONDS, uri=True, isolation_level=None)
    connection.text_factory = bytes
    connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST_TEXT)
    # views, triggers and generated columns, which no store has, could not call anything either
    connection.execute("PRAGMA trusted_schema = OFF")
    return connection


APPLICATION_ID = 0x4D425856
"""Marks the file as a store of this suite ("MBXV") in SQLite's header."""

LOOKUP = 500
"""Tasks that are looked up at once: workers wait for it, and the rest is not in memory so far."""

SCHEMA_VERSION = 3
"""Layout of the tables."""

ANEW = "the same command with a new --store computes anew"
"""What to do about a store that cannot be read."""

TABLES = {
    "answers": "CREATE TABLE answers (key TEXT PRIMARY KEY, content TEXT NOT NULL, answer TEXT NOT NULL)",
    "sweeps": "CREATE TABLE sweeps (number INTEGER PRIMARY KEY, sweep TEXT UNIQUE NOT NULL)",
}
"""Everything that a store consists of; another table, a view or a trigger is not read."""

KEEP = """
INSERT INTO answers VALUES (?, ?, ?)
ON CONFLICT (key) DO UPDATE SET content = excluded.content, answer = excluded.answer
WHERE json_extract(excluded.answer, '$.status') != 'blocked' OR json_extract(answers.answer, '$.status') = 'blocked'
"""
"""Keeps a result, and a blocked one only where there is no other: two processes may run the same task."""

DAMAGE = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_ERROR, sqlite3.SQLITE_TOOBIG)
"""Errors of SQLite that come from what stands in the file; others come from the disk, locks and permissions."""

WAITS = {sqlite3.SQLITE_BUSY: ("locked by another process", 300.0), sqlite3.SQLITE_FULL: ("on a full disk", 30.0)}
"""What passes by itself, and how long it is waited for [s]: another process may read or write for minutes, as a report
does; a full disk is freed by other programs at once or not at all."""

PATIENCE_SECONDS = 5.0
"""Waits that are shorter are not worth a message [s]."""

_Value = TypeVar("_Value")
_Row = tuple[Any, ...]


class ResultStore(Closing):
    """Results by the hash of their tasks; every result is on disk when `keep` returns.

    A file that is no store of this suite, has another layout, is damaged or cannot be written is refused, and left as
    it is. Results of other sources of the suite are taken where they are to be (`keep_old`), and counted. One that
    stays locked, or cannot be read or written any more, is a `RunError`.
    """

    def __init__(self, file: Path, *, keep_old: bool = False):
        self._file, self._keep_old, self._taken = checked_path("store", file), keep_old, 0
        with errors_of(file), ExitStack() as opened:
            self._connection = opened.enter_context(closing(connected(file)))
            with_retries(file, self._open)
            opened.pop_all()

    def _open(self) -> None:
        # takes the write lock: a file that cannot be written is found out before any work
        made = f"PRAGMA application_id = {APPLICATION_ID}", f"PRAGMA user_version = {SCHEMA_VERSION}", *TABLES.values()
        refuse_sweeps(self._connection, self._file)
        self._connection.execute("BEGIN IMMEDIATE")
        with self._connection:
            if self._file.stat().st_size == 0:
                for statement in made:
                    self._connection.execute(statement)
            check_layout(self._connection, self._file)

    def check_pages(self) -> None:
        """Refuse a store whose tables are damaged: what is in it would seem to be missing."""
        with errors_of(self._file):
            found = self._connection.execute("PRAGMA quick_check(1)").fetchone()[0].decode(errors="replace")
        if found != "ok":
            raise damaged(self._file, " ".join(found.split()))

    def find(self, task: Task) -> Result | None:
        """Give the result of an equal task, or ``None``."""
        return next(self.results([task]))

    def results(self, tasks: Iterable[Task]) -> Iterator[Result | None]:
        """Give the result of each task, in order, or ``None``."""
        remaining = iter(tasks)
        while asked := list(itertools.islice(remaining, LOOKUP)):
            keys = [task.key() for task in asked]
            answers = self._answers(keys)
            if self._keep_old:
                former = {task.key(): self._former.get(unsourced_key(task.text())) for task in asked}
                old = self._answers([name for key, name in former.items() if name and key not in answers])
                answers |= {key: old[name] for key, name in former.items() if name in old and key not in answers}
                self._taken += len(old)
            for task, key in zip(asked, keys, strict=True):
                yield self._result_of(task, answers[key]) if key in answers else None

    def _answers(self, keys: Sequence[str]) -> dict[str, bytes]:
        query = "SELECT key, answer FROM answers WHERE key IN (" + ",".join("?" * len(keys)) + ")"
        return {key.decode(): answer for key, answer in self._read(query, keys)}

    @cached_property
    def _former(self) -> dict[str, str]:
        """The key of every result, whatever version of the suite has computed it, the latest last."""
        return {unsourced_key(content): key.decode() for key, content, _ in self._rows()}

    def _rows(self) -> Iterator[tuple[bytes, bytes, bytes]]:
        """Give key, content and answer of every row, in the order of writing."""
        self.check_pages()  # those that lead to each other would never end
        query = "SELECT rowid, key, content, answer FROM answers WHERE rowid > ? ORDER BY rowid LIMIT ?"
        number = -1
        while rows := self._read(query, (number, LOOKUP)):
            yield from (row[1:] for row in rows)
            number = rows[-1][0]

    def _result_of(self, task: Task, text: bytes) -> Result:
        result = self._result(text)
        fault = _misfit(task, result)
        if fault is not None:
            raise ParameterError(f"store {self._file} has a result that no {task.variant} gives: {fault}")
        return result

    def _result(self, text: bytes) -> Result:
        try:
            return Result.from_json(text)
        except ParameterError as problem:
            raise ParameterError(f"store {self._file}: {problem}") from None

    def _text(self, text: bytes) -> str:
        try:
            return text.decode()
        except UnicodeDecodeError:
            raise damaged(self._file, "a text of it is no UTF-8") from None

    def _read(self, query: str, parameters: Sequence[object] = ()) -> list[_Row]:
        """Give the rows that a query finds."""
        return self._use(lambda: self._connection.execute(query, parameters).fetchall())

    def keep(self, results: Iterable[tuple[Task, Result]]) -> None:
        """Write results in one transaction; a blocked one does not take the place of another."""
        texts = [(task.text(), result.to_json()) for task, result in results]
        self._write(KEEP, [(key_of(task), task, result) for task, result in texts])

    def note(self, sweep: str) -> None:
        """Write a sweep, as JSON, as the latest one."""
        self._write("INSERT OR REPLACE INTO sweeps (sweep) VALUES (?)", [(sweep,)])

    def saved(self) -> list[str]:
        """Give the sweeps that were saved, the latest first."""
        return [self._text(sweep) for (sweep,) in self._read("SELECT sweep FROM sweeps ORDER BY number DESC")]

    def _write(self, statement: str, rows: Sequence[_Row]) -> None:
        """Write rows in one transaction; where the file has been taken away, they and all others go into a copy.

        The copy lies in a new folder beside it: under its name there may be another file.
        """

        def write() -> None:
            self._connection.execute("BEGIN IMMEDIATE")
            with self._connection:
                self._connection.executemany(statement, rows)

        try:
            self._use(write)
        except _Moved as moved:
            folder = self._file.parent if self._file.parent.is_dir() else None
            copy = Path(mkdtemp(prefix=f"{self._file.stem}-", dir=folder)) / self._file.name
            with errors_of(self._file, while_running=True):
                self._connection.execute("VACUUM INTO ?", (str(copy),))
            with closing(sqlite3.connect(copy)) as connection, connection:
                connection.executemany(statement, rows)
            raise RunError(f"{moved}; all its results are in {copy}") from None

    def _use(self, action: Callable[[], _Value]) -> _Value:
        with errors_of(self._file, while_running=True):
            return with_retries(self._file, action)

    def close(self) -> None:
        """Close the file, and say how many results of another version of the suite have been taken from it."""
        if self._taken:
            print(f"store {self._file}: {self._taken} results are of another version of the suite", file=sys.stderr)
            self._taken = 0
        self._connection.close()


def _misfit(task: Task, result: Result) -> str | None:
    """Say why a result is not one of a task, whoever wrote it; ``None`` if it may be."""
    if abs(result.transmittance_db) > LARGEST_LEVEL:
        return f"transmittance_db = {result.transmittance_db:g}; allowed: up to {LARGEST_LEVEL:g} dB"
    if result.status is not ResultStatus.FINISHED:
        return _wrong_length(result.series, _steady_lengths(task, result)) or _wrong_contact(task, result)
    if task.series is None:
        return f"status = {result.status}; allowed: one of a search for a steady state"
    missing = ", ".join(name for name in task.series if name not in result.series)
    if missing:
        return f"no series {missing}; allowed: all of {', '.join(task.series)}"
    others = (name for name in result.series if name.startswith(("joint", "gain")))  # which not every result has
    lengths = dict.fromkeys(others, next(iter(task.series.values())))
    return _wrong_length(result.series, {**lengths, **task.series})


def _steady_lengths(task: Task, result: Result) -> Mapping[str, int]:
    """Give name and length of the series that a steady state has."""
    lengths = {"travels": len(result.transitions)} if "travels" in result.series else {}
    if result.converged and isinstance(task, SteadyStateTask) and task.recorded is Recorded.PERIOD:
        lengths |= dict.fromkeys(ARRAYS, max(1, result.steps_per_period) * task.cells)
    return lengths


def _wrong_length(series: NamedNumbers, lengths: Mapping[str, int]) -> str | None:
    """Name the first series that has not the length that it is to have."""
    for name, length in lengths.items():
        own = len(series.get(name, ()))
        if own != length and (length != SOME or own == 0):
            return f"{name} has {own} numbers; allowed: {'some' if length == SOME else length}"
    return None


def _wrong_contact(task: Task, result: Result) -> str | None:
    """Name the first numbers of contacts that are not of the chain's; a certified steady state has them."""
    opening = ("open_fraction", "largest_gap") if task.preloaded else ()
    needed = ("stuck_fraction", "creep", *opening) if result.converged else ()
    for name in ("stuck_fraction", "creep", "open_fraction", "largest_gap"):
        count = len(getattr(result, name))
        if count != task.cells and (count or name in needed):
            return f"{name} has {count} numbers; allowed: {task.cells}"
    wrong = next((cell for cell, _, _ in result.transitions if not 1 <= cell <= task.cells), None)
    return None if wrong is None else f"transitions of cell {wrong}; allowed: 1 to {task.cells}"


@contextmanager
def opened_store(file: Path | None, *, keep_old: bool = False) -> Iterator[ResultStore]:
    """Open a store, a temporary one if none is named."""
    with ExitStack() as opened:
        if file is None:
            file = opened.enter_context(ScratchFolder()).path / "results.sqlite"
        yield opened.enter_context(ResultStore(file, keep_old=keep_old))


class _Moved(RunError):
    """The file of an open store has been taken away."""


def with_retries(file: Path, action: Callable[[], _Value]) -> _Value:
    """Do something with a store, again and again while that fails for one of `WAITS`; it leaves nothing half done."""
    begin, told = time.monotonic(), False
    while True:
        try:
            return action()
        except sqlite3.Error as problem:
            state, limit = WAITS.get(_code(problem), ("", 0.0))
            waited = time.monotonic() - begin
            if waited >= limit:
                raise
        if waited >= PATIENCE_SECONDS and not told:
            told = True
            print(f"store {file} is {state}; waiting up to {limit:g} s", file=sys.stderr)
        time.sleep(ATTEMPT_SECONDS / 5)


@contextmanager
def errors_of(file: Path, *, while_running: bool = False) -> Iterator[None]:
    """Name the store in whatever SQLite raises: wrong input when it is opened, a loss while a command runs."""
    try:
        yield
    except (sqlite3.Error, MemoryError, OSError) as problem:
        if _code(problem) in DAMAGE:
            raise damaged(file, str(problem)) from None
        if getattr(problem, "sqlite_errorcode", sqlite3.SQLITE_OK) == sqlite3.SQLITE_READONLY_DBMOVED:
            raise _Moved(f"store {file} was deleted, moved or replaced while the command ran") from None
        if _code(problem) in WAITS or while_running:
            advice = "what it holds stays, and the same command goes on from there"
            raise RunError(f"store {file} cannot be used any more: {problem}; {advice}") from None
        raise ParameterError(f"store {file} cannot be used: {problem}") from None


def _code(problem: BaseException) -> int:
    """Give SQLite's primary error code; that of success for any other error."""
    return int(getattr(problem, "sqlite_errorcode", sqlite3.SQLITE_OK)) & 0xFF


def damaged(file: Path, what: str) -> ParameterError:
    """Give the error of a damaged store, with what to do."""
    return ParameterError(f"store {file} is damaged: {what}; {ANEW}")


def refuse_sweeps(connection: sqlite3.Connection, file: Path) -> None:
    """Refuse a store of `sweep` or `report`, which is whole; another process may be writing it."""
    made = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall()
    mark = connection.execute("PRAGMA application_id").fetchone()[0]
    if mark == stores.APPLICATION_ID and {name.decode(errors="replace") for (name,) in made} == stores.TABLES:
        raise stores.other_kind(file, stores.SWEEPS, stores.SCENARIOS)


def check_layout(connection: sqlite3.Connection, file: Path) -> None:
    """Refuse what is not exactly a store of this layout."""
    if connection.execute("PRAGMA application_id").fetchone()[0] != APPLICATION_ID:
        raise ParameterError(f"store {file} belongs to another program; allowed: a new file or a store")
    version = connection.execute("PRAGMA user_version").fetchone()[0]
    if version != SCHEMA_VERSION:
        raise ParameterError(f"store {file} has layout {version}; allowed: {SCHEMA_VERSION}; {ANEW}")
    made = connection.execute("SELECT type, name, tbl_name, sql FROM sqlite_master WHERE sql IS NOT NULL").fetchall()
    expected = {(b"table", name.encode(), name.encode(), sql.encode()) for name, sql in TABLES.items()}
    if len(made) != len(expected) or set(made) != expected:
        raise damaged(file, "its tables are not those of a store")
