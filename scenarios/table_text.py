"""Tables as text: CSV and JSON with every digit for programs, Markdown and the terminal for people."""

from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

import pandas as pd
from pydantic_core import to_json
from rich.markup import escape

from multibody_xval.engines.interface.texts import visible
from multibody_xval.scenarios.terminal_table import print_table as print_rows

FORMULAS = ("=", "+", "-", "@")
"""How texts begin that spreadsheets take for formulas; a tab or a carriage return is made visible before."""


def csv_text(table: pd.DataFrame, missing: str = "nan") -> str:
    """Give a table as CSV, with a word for missing values; texts are those of `csv_cell`, numbers are as they are."""
    texts = {
        str(name): pd.Series([csv_cell(value) for value in column.tolist()], index=table.index, dtype=object)
        for name, column in table.items()
        if column.dtype.kind == "O"
    }
    return table.assign(**texts).to_csv(index=False, na_rep=missing, lineterminator="\n")


def csv_cell(value: Any) -> Any:
    """Give a value as CSV has it: a text in one line, with ' in front where a spreadsheet would compute it."""
    return _csv_text(value) if isinstance(value, str) else value


@lru_cache(maxsize=1000)
def _csv_text(value: str) -> str:
    text = visible(value)  # a column has few words, each in thousands of rows
    return f"'{text}" if text.startswith(FORMULAS) else text


def number_texts(table: pd.DataFrame, patterns: Mapping[str, str]) -> pd.DataFrame:
    """Give columns of numbers as people read them, by their patterns; a dash where there is none."""
    texts = {name: table[name].map(own.format).where(table[name].notna(), "–") for name, own in patterns.items()}
    return table.assign(**texts)


def records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Give the rows of a table by the names of its columns, for `json_text`."""
    columns = (column.tolist() for _, column in table.items())
    return [dict(zip(table.columns, values, strict=True)) for values in zip(*columns, strict=True)]


def json_text(content: object, indent: int | None = None) -> str:
    """Give anything as JSON: NaN and infinity become null, and objects without a JSON form their text."""
    return to_json(content, indent=indent, inf_nan_mode="null", fallback=repr).decode() + "\n"


def markdown_lines(table: pd.DataFrame) -> list[str]:
    """Give the lines of a table of texts for a document."""
    rows = [list(table.columns), *table.itertuples(index=False, name=None)]
    lines = ["| " + " | ".join(map(markdown_text, row)) + " |" for row in rows]
    return [lines[0], "|" + "---|" * len(table.columns), *lines[1:]]


def markdown_list(lines: Iterable[str]) -> list[str]:
    """Give lines as the items of a list of a document."""
    return [f"- {markdown_text(line)}" for line in lines]


def markdown_text(text: str) -> str:
    """Give a text as a document shows it: in one line, with no cells, tags and links of its own."""
    return visible(text).replace("|", "\\|").replace("<", "&lt;").replace("](", "]\\(")


def plain(*lines: str) -> str:
    """Give lines as rich prints them: neither its markup nor characters that control a terminal mean anything."""
    return escape("\n".join(map(visible, lines)))


def print_table(table: pd.DataFrame, title: str | None = None) -> None:
    """Print a table of texts, no wider than the terminal."""
    print_rows(list(map(str, table)), table.to_numpy().tolist(), title=title or None)
