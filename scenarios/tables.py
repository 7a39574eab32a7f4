"""Columns of records: in full for programs, rounded for people."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import pandas as pd
from rich.markup import escape

from multibody_xval.scenarios.table_text import (
    csv_text,
    json_text,
    markdown_lines,
    markdown_list,
    markdown_text,
    print_table,
    records,
)
from reference_lcp.terminal import visible

__all__ = ["csv_text", "json_text", "markdown_lines", "markdown_list", "markdown_text", "print_table", "records"]

Row = TypeVar("Row")


@dataclass(frozen=True)
class Column(Generic[Row]):
    """One column of a table."""

    key: str
    value: Callable[[Row], Any]
    heading: str = ""
    """Its name for people; the key unless one is given."""
    pattern: str = "{}"

    def text(self, row: Row) -> str:
        """Give the value as people read it; a dash where there is none."""
        value = self.value(row)
        missing = value is None or (isinstance(value, float) and math.isnan(value))
        return "–" if missing else self.pattern.format(value)


def full_table(columns: Sequence[Column[Row]], rows: Iterable[Row]) -> pd.DataFrame:
    """Give a table for programs: named by keys, with every value as it is."""
    values = [[column.value(row) for column in columns] for row in rows]
    return pd.DataFrame(values, columns=[column.key for column in columns], dtype=object)


def text_table(columns: Sequence[Column[Row]], rows: Iterable[Row]) -> pd.DataFrame:
    """Give a table for people: named by headings, with every value as text."""
    texts = [[column.text(row) for column in columns] for row in rows]
    return pd.DataFrame(texts, columns=[column.heading or column.key for column in columns], dtype=object)


def plain(*lines: str) -> str:
    """Give lines as rich prints them: neither its markup nor characters that control a terminal mean anything."""
    return escape("\n".join(map(visible, lines)))
