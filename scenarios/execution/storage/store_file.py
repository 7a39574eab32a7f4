"""The file of a store, opened as if a stranger had written it."""

import itertools
import sqlite3
from pathlib import Path

from reference_lcp.refusal import ParameterError, checked_path

LARGEST_TEXT = 2**28
"""Bytes that one text of a store may have; a period of 1,000 cells, recorded in full, takes a tenth of it."""

SPECIAL_NAMES = (":", "file:")
"""How names begin that SQLite knows for something else than a file of this name."""

ATTEMPT_SECONDS = 0.5
"""How long SQLite waits for a lock; Ctrl-C is heard between such attempts."""

STEPS_A_BYTE = 1
"""Steps of SQLite that a check may take, over the bytes of the file; an intact store takes a fiftieth of one."""

STEPS_A_CALL = 100_000
"""Steps of SQLite after which it asks whether to go on: a thousandth of a second."""


def checked_store(file: Path) -> Path:
    """Give `file` if it is a path that a store may have.

    Raises
    ------
    ParameterError
        If SQLite would keep nothing under this name, or it is a folder or a device.
    """
    if str(file).startswith(SPECIAL_NAMES):
        raise ParameterError(f"store {file} keeps nothing or means another file; allowed: the path of a file")
    path = checked_path("store", file)
    if path.exists() and not path.is_file():
        raise ParameterError(f"store {file} is a folder or a device; allowed: a file")
    return file


def existing_store(file: Path | None) -> Path:
    """Give `file` if it is there: a misspelt name makes no empty store.

    Raises
    ------
    ParameterError
        If it is not.
    """
    if file is None:
        raise ParameterError("--store is missing; allowed where nothing is run: a store that is there")
    if not checked_store(file).is_file():
        raise ParameterError(f"store {file} does not exist; allowed where nothing is run: a store that is there")
    return file


def connected(file: Path, *, read_only: bool = False) -> sqlite3.Connection:
    """Open a store; texts are read as bytes, and what else than tables stands in it is not trusted.

    Raises
    ------
    ParameterError
        If it cannot be a store by its name.
    sqlite3.Error
        If it cannot be opened.
    """
    address = f"{checked_store(file).resolve().as_uri()}?mode={'ro' if read_only else 'rwc'}"
    connection = sqlite3.connect(address, timeout=ATTEMPT_SECONDS, uri=True, isolation_level=None)
    connection.text_factory = bytes
    connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST_TEXT)
    # views, triggers and generated columns, which no store has, could not call anything either
    connection.execute("PRAGMA trusted_schema = OFF")
    return connection


def problems_of(connection: sqlite3.Connection, size: int) -> list[str]:
    """Give what SQLite finds wrong with pages and indices of a file of so many bytes; nothing where it is whole."""
    calls = itertools.count()  # pages that lead to each other never end
    connection.set_progress_handler(lambda: next(calls) * STEPS_A_CALL > STEPS_A_BYTE * size, STEPS_A_CALL)
    try:
        texts = [row[0].decode(errors="replace") for row in connection.execute("PRAGMA integrity_check")]
    except sqlite3.DatabaseError as problem:
        texts = [str(problem)]
    connection.set_progress_handler(None, 0)
    return [" ".join(text.split()) for text in texts if text != "ok"]
