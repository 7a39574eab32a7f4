"""What is damaged in a store, and its good rows in a new file."""

import itertools
import sqlite3
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from reference_lcp.errors import ParameterError, RunError
from reference_lcp.output import replacing
from scenarios.runs.store import ResultStore, check_layout, connected, errors_of, existing_store, intact, problems_of

COLUMNS = {"answers": ("key", "content", "answer", "digest"), "sweeps": ("sweep", "digest")}
"""Columns of each table, without its row numbers, the digest last."""

ORDERS = ("rowid", "rowid DESC", "{index}", "{index} DESC")
"""Ways through a table: where a damaged page ends one of them, another still finds rows."""

LEAST_ROW = 64
"""Bytes that a row takes at least: two hashes, the shorter one as bytes."""

Row = tuple[object, ...]


@dataclass(frozen=True)
class StoreCheck:
    """What stands in a store."""

    good: Mapping[str, Sequence[Row]]
    """Intact rows of each table, in the order of writing."""
    damage: Sequence[str]
    """What is damaged, in words; empty if nothing is."""


def check_store(file: Path) -> StoreCheck:
    """Read every row of a store; nothing is written. One in which no row can be found is refused."""
    with errors_of(existing_store(file)), closing(connected(file, read_only=True)) as connection:
        check_layout(connection, file)
        size = file.stat().st_size
        damage = [f"file: {text}" for text in problems_of(connection, size)]
        good: dict[str, list[Row]] = {}
        for table, columns in COLUMNS.items():
            good[table] = []
            for number in sorted(_numbers(connection, table, size // LEAST_ROW)):
                query = f"SELECT {', '.join(columns)} FROM {table} WHERE rowid = ?"
                try:
                    row = connection.execute(query, (number,)).fetchone()
                except (sqlite3.Error, MemoryError):
                    row = None
                if row is not None and intact(row):
                    good[table].append(row)
                else:
                    problem = "cannot be read" if row is None else "its digest does not fit"
                    damage.append(f"table {table}, row {number}: {problem}")
        return StoreCheck(good, damage)


def salvage(check: StoreCheck, new: Path) -> None:
    """Write the good rows into a new store, which is not there where that fails."""
    if new.exists() or new.is_symlink():
        raise ParameterError(f"--salvage = {new} is there already; allowed: a new file")
    with replacing(new) as part:
        try:
            ResultStore(part).close()
            with closing(connected(part)) as connection, connection:
                connection.execute("BEGIN IMMEDIATE")
                for table, columns in COLUMNS.items():
                    texts = ", ".join("?" if name == "digest" else "CAST(? AS TEXT)" for name in columns)
                    insert = f"INSERT OR IGNORE INTO {table} ({', '.join(columns)}) VALUES ({texts})"
                    connection.executemany(insert, check.good[table])  # texts as they were read, which is as bytes
        except (sqlite3.Error, ParameterError, RunError) as problem:
            part.with_name(f"{part.name}-journal").unlink(missing_ok=True)
            raise RunError(f"--salvage = {new} cannot be written: {problem}; it is not there") from None


def _numbers(connection: sqlite3.Connection, table: str, most: int) -> set[int]:
    """Give the numbers of all rows that any way through a table finds, looking at so many at most."""
    found: set[int] = set()
    for order in ORDERS:
        try:
            rows = connection.execute(f"SELECT rowid FROM {table} ORDER BY {order.format(index=COLUMNS[table][0])}")
            found.update(number for (number,) in itertools.islice(rows, most) if isinstance(number, int))
        except sqlite3.Error:
            continue
    return found
