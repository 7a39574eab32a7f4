"""Results in one table of SQLite, kept the moment they are there; several stores merge into one table.

The key of a result is its run, version and options of its engine, and a digest of the sources that compute it: what is
corrected or newer is computed anew. Two processes may share a file on this machine; network disks do not keep SQLite's
promises.
"""

import hashlib
import json
import sqlite3
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import NamedTuple, TypeVar

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.texts import checked_path
from multibody_xval.scenarios.compute.sources import digest
from multibody_xval.scenarios.model import Config, Result, Run, Status
from multibody_xval.scenarios.output_files import RunError
from reference_lcp.errors import ParameterError, shown

SCHEMA = """CREATE TABLE IF NOT EXISTS results (
    key TEXT PRIMARY KEY, run TEXT NOT NULL, version TEXT NOT NULL, options TEXT NOT NULL, result TEXT NOT NULL)"""

TABLES = {"results"}
"""Of the file: earlier versions of the suite had others, under the same marks."""

APPLICATION_ID = 0x4D425856
"""Marks the file as a store of this suite ("MBXV") in SQLite's header."""

FORMAT = 3
"""Of runs and results in the file; those of another format are not read."""

LOCKED_SECONDS = 60.0
"""How long another process may have the file locked [s]."""

_Value = TypeVar("_Value")


class Stored(NamedTuple):
    """A row of a store."""

    run: Run
    version: str
    result: Result


class Store:
    """Results by the key of their run, in a file, or in memory without one.

    Raises
    ------
    ParameterError
        If the file is no store of this format; it stays as it is.
    RunError
        If it cannot be read or written.
    """

    def __init__(self, path: Path | None = None):
        self.path = path
        self._file = _used(
            path, lambda: sqlite3.connect(path or ":memory:", timeout=LOCKED_SECONDS, isolation_level=None)
        )
        try:
            _used(path, self._prepare)
        except BaseException:
            self._file.close()
            raise

    def _prepare(self) -> None:
        """Make the table of a new file; refuse another kind of file."""
        made = "SELECT name FROM sqlite_master WHERE type = 'table'"
        tables = {name for (name,) in self._file.execute(made).fetchall()}
        marks = [self._file.execute(f"PRAGMA {name}").fetchone()[0] for name in ("application_id", "user_version")]
        if tables and (marks != [APPLICATION_ID, FORMAT] or tables != TABLES):
            raise ParameterError(
                f"store {self.path} {_other(*marks)}; allowed: one of format {FORMAT}, or a new file to compute anew"
            )
        if not tables:
            self._file.execute(f"PRAGMA application_id = {APPLICATION_ID}")
            self._file.execute(f"PRAGMA user_version = {FORMAT}")
        self._file.execute("PRAGMA journal_mode = WAL")
        self._file.execute("PRAGMA wal_autocheckpoint = 1")  # a copy of the file alone has all but what is being added
        self._file.execute("PRAGMA synchronous = NORMAL")
        self._file.execute(SCHEMA)

    def add(self, results: Mapping[Run, Result]) -> None:
        """Keep results, but those that failed by no fault of their engine; what is there already is replaced."""
        rows = [
            (key(run), run.text, *identity(run.config), result.to_json())
            for run, result in results.items()
            if not result.circumstance
        ]

        def write() -> None:
            with self._file:
                self._file.execute("BEGIN IMMEDIATE")
                self._file.executemany("INSERT OR REPLACE INTO results VALUES (?, ?, ?, ?, ?)", rows)

        _used(self.path, write)

    def known(self, runs: Iterable[Run]) -> dict[Run, Result]:
        """Give the results that are there of runs by the engines of this environment."""
        keys = {key(run): run for run in runs}
        query = "SELECT key, result FROM results WHERE key IN (SELECT value FROM json_each(?))"
        rows = self._read(query, [json.dumps(list(keys))])
        return {keys[name]: self._readable(Result.from_json, text) for name, text in rows}

    def rows(self) -> Iterator[Stored]:
        """Give every result, whatever engine and version it is of."""
        query = "SELECT run, version, result FROM results ORDER BY rowid"
        for run, version, result in self._read(query):
            yield Stored(self._readable(Run.from_text, run), version, self._readable(Result.from_json, result))

    def _readable(self, read: Callable[[str], _Value], text: str) -> _Value:
        """Read a text of the file, which anybody may have written."""
        try:
            return read(text)
        except ParameterError as problem:
            raise ParameterError(f"store {self.path}: {problem}") from None
        except (ValueError, TypeError, LookupError, AttributeError, RecursionError) as problem:
            what = f"{shown(text)} cannot be read: {type(problem).__name__}: {problem}"
            raise ParameterError(f"store {self.path}: {what}; allowed: what this suite writes") from None

    def options(self) -> dict[str, str]:
        """Give the options of every configuration by its name, as JSON; of several versions, those of the last."""
        rows = self._read("SELECT run, options FROM results ORDER BY rowid")
        return {json.loads(run)["config"]: options for run, options in rows}

    def _read(self, query: str, values: Sequence[str] = ()) -> list[tuple[str, ...]]:
        return _used(self.path, lambda: self._file.execute(query, values).fetchall())

    def close(self) -> None:
        """Write everything into the one file, so that a copy of it is whole."""
        try:
            self._file.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            self._file.execute("PRAGMA journal_mode = DELETE")
        except sqlite3.OperationalError:
            pass  # another process uses the file, and does it when it ends
        finally:
            self._file.close()


@contextmanager
def opened(path: Path | None) -> Iterator[Store]:
    """Open a store, and close it at the end."""
    store = Store(None if path is None else checked_store(path))
    try:
        yield store
    finally:
        store.close()


def existing_store(path: str | Path) -> Path:
    """Give the path of a store that is there."""
    path = checked_path("store", path)
    if not path.is_file():
        raise ParameterError(f"store {path} is no file; allowed: a file that an earlier command has written")
    return path


def checked_store(path: str | Path) -> Path:
    """Give the path of a store, if a file can be there."""
    path = checked_path("store", path)
    if str(path).startswith((":", "file:")):
        raise ParameterError(f"store {path} has a name that SQLite takes for something else; allowed: a file")
    if path.exists() and not path.is_file():
        raise ParameterError(f"store {path} is a folder or a device; allowed: a file")
    if not path.absolute().parent.is_dir():
        raise ParameterError(
            f"store {path}: there is no folder {path.parent}; allowed: a file in a folder that is there"
        )
    return path


def key(run: Run) -> str:
    """Give the hash of all that the result of a run depends on."""
    return hashlib.sha256("\n".join((run.text, *identity(run.config), digest(run.config.engine))).encode()).hexdigest()


@cache
def identity(config: Config) -> tuple[str, str]:
    """Give the version of an engine, empty where it is not installed, and the options of a configuration as JSON."""
    adapter = engine(config.engine)
    version = "" if adapter.unavailable_reason() else adapter.version()
    preset = config.preset
    options = {**preset.options, **preset.modulated_options}
    return version, json.dumps({name: repr(option.value) for name, option in sorted(options.items())})


def _other(mark: int, form: int) -> str:
    """Say what a file is that is no store of this format."""
    if mark != APPLICATION_ID:
        return "is no store of this suite"
    return "has other tables than a store" if form == FORMAT else f"is of format {form}"


def is_kept(result: Result, *, retry_failed: bool) -> bool:
    """Whether a stored result is used: what an engine failed at is not tried again, unless that is asked for."""
    return not (retry_failed and result.status is Status.FAILED) and not result.reason.startswith("not installed")


def _used(path: Path | None, action: Callable[[], _Value]) -> _Value:
    """Use SQLite, whose errors become one line."""
    try:
        return action()
    except sqlite3.OperationalError as problem:
        code = getattr(problem, "sqlite_errorcode", 0) & 0xFF
        wait = {sqlite3.SQLITE_FULL: "the disk is full", sqlite3.SQLITE_BUSY: "another process has it locked"}
        raise RunError(f"store {path}: {wait.get(code, problem)}; what is stored stays, run again to go on") from None
    except sqlite3.DatabaseError as problem:
        raise ParameterError(
            f"store {path} is damaged or no store: {problem}; allowed: a store, or a new file to compute anew"
        ) from None
