"""The file of a store, opened as if a stranger had written it."""

import sqlite3
from pathlib import Path

from reference_lcp.validation import ParameterError

LARGEST_TEXT = 2**28
"""Bytes that one text of a store may have; a period of 1,000 cells, recorded in full, takes a tenth of it."""

SPECIAL_NAMES = (":", "file:")
"""How names begin that SQLite knows for something else than a file of this name."""


def checked_store(file: Path) -> Path:
    """Give `file` if it is a path that a store may have.

    Raises
    ------
    ParameterError
        If SQLite would keep nothing under this name, or it is a folder.
    """
    if str(file).startswith(SPECIAL_NAMES):
        raise ParameterError(f"store {file} keeps nothing or means another file; allowed: the path of a file")
    if file.is_dir():
        raise ParameterError(f"store {file} is a folder; allowed: a file")
    return file


def existing_store(file: Path | None) -> Path:
    """Give `file` if it is there: a misspelt name makes no empty store.

    Raises
    ------
    ParameterError
        If it is not.
    """
    if file is None or not checked_store(file).is_file():
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
    connection = sqlite3.connect(address, uri=True, isolation_level=None)
    connection.text_factory = bytes
    connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST_TEXT)
    # views, triggers and generated columns, which no store has, could not call anything either
    connection.execute("PRAGMA trusted_schema = OFF")
    return connection
