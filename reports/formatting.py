"""Numbers as people read them, and templates that print them; files hold them in full."""

import math
import platform
from decimal import ROUND_HALF_UP, Context, Decimal
from textwrap import wrap
from typing import Any

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined

from multibody_xval.engines.interface.texts import visible

MISSING = "–"
"""Stands where there is no number."""


RESIDUE = 1e-9
"""Sizes below it are shown as zero: round-off, in every unit that a page has."""

SMALLEST_IN_TABLE = 0.01
"""From it on, three decimals have two digits that count."""

SMALLEST_PLAIN = Decimal("1e-4")
"""Below it, a number is shorter as a power of ten."""

NAME_WIDTH = 26
"""Columns of the names of cases: beside all others in 80."""

TWO_DIGITS = Context(prec=2, rounding=ROUND_HALF_UP)


def significant(value: float) -> str:
    """Give two significant digits: 15, 0.12, 1,700; zero below `RESIDUE`.

    It is rounded as the table of accuracy is first, to three decimals: texts that are made from either are the same.
    """
    if not math.isfinite(value):
        return MISSING
    if abs(value) < RESIDUE:
        return "0"
    rounded = TWO_DIGITS.create_decimal(f"{value:.3f}" if abs(value) >= SMALLEST_IN_TABLE else f"{value:.2e}")
    size = abs(rounded)
    text = f"{rounded:,.0f}" if size >= 10 else f"{rounded:f}" if size >= SMALLEST_PLAIN else f"{float(rounded):.1e}"
    return text.replace("-", "−")


def numbered(name: str, unit: str, case: str) -> str:
    """Name a number, and below it its case, in lines that leave room for the other columns."""
    first = f"{name} [{unit}]" if unit else name
    return "\n".join([first, *wrap(case, NAME_WIDTH, initial_indent="  ", subsequent_indent="  ")])


def number_text(value: Any) -> str:
    """Give a number in five digits; of a complex one, its size."""
    size = abs(value) if isinstance(value, complex) else float(value)
    if not math.isfinite(size):
        return MISSING
    text = f"{size:.5g}"
    return (text if len(text) <= len("-0.12345") else f"{size:.2e}").replace("-", "−")


def size_text(value: float) -> str:
    """Give a distance in two digits; of one that round-off makes, that it is below `RESIDUE`: it is not zero."""
    return "<1e−9" if 0 < value < RESIDUE else significant(value)


def flat(table: pd.DataFrame) -> pd.DataFrame:
    """Give texts in one line each."""
    return table.map(_line)


def _line(text: str) -> str:
    first, *rest = map(str.strip, text.split("\n"))
    return "; ".join([first, " ".join(rest)]) if rest else first


def versions(rows: pd.DataFrame) -> str:
    """Name the versions of the engines of a table, and of Python."""
    pairs = rows[rows.version != ""][["engine", "version"]].drop_duplicates().sort_values("engine")
    named = [f"{own.engine} {own.version}" for own in pairs.itertuples()]
    return f"Versions: {', '.join([*named, f'Python {platform.python_version()}'])}."


def _safe(value: Any) -> Any:
    """Show the characters of a text that would be obeyed, but for ends of lines."""
    return "\n".join(map(visible, value.split("\n"))) if type(value) is str else value


def environment(package: str | None = None, *, markup: bool = True) -> Environment:
    """Give the templates of a package: they refuse names that are not there; those of markup escape what they print."""
    return Environment(
        loader=None if package is None else PackageLoader(package),
        autoescape=markup,
        finalize=_safe,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=not markup,
    )
