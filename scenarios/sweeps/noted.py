"""Sweeps noted in the store of their results, so that a report can be made of the store alone."""

import sqlite3
from contextlib import closing
from pathlib import Path

from reference_lcp.validation import ParameterError
from scenarios.sweeps.dataset import SWEEP
from scenarios.sweeps.sweep import Sweep


def note_sweep(store: Path, sweep: Sweep) -> None:
    """Write a sweep into the store of its results, as the latest one."""
    text = SWEEP.dump_json(sweep).decode()
    with closing(sqlite3.connect(store)) as connection, connection:
        connection.execute("CREATE TABLE IF NOT EXISTS sweeps (number INTEGER PRIMARY KEY, sweep TEXT UNIQUE NOT NULL)")
        connection.execute("INSERT OR REPLACE INTO sweeps (sweep) VALUES (?)", (text,))


def noted_sweep(store: Path) -> Sweep:
    """Give the sweep that was noted last.

    Raises
    ------
    ParameterError
        If there is none, or the file is no store.
    """
    allowed = "allowed: a store of a sweep or of a report"
    if not store.is_file():
        raise ParameterError(f"store {store} does not exist; {allowed}")
    try:
        with closing(sqlite3.connect(store)) as connection:
            (text,) = connection.execute("SELECT sweep FROM sweeps ORDER BY number DESC LIMIT 1").fetchone()
    except (sqlite3.Error, TypeError):
        raise ParameterError(f"store {store} holds no sweep; {allowed}") from None
    return SWEEP.validate_json(text)
