"""Numbers as people read them, and templates that print them; files hold them in full."""

import math
import re
from collections.abc import Sequence
from decimal import ROUND_HALF_UP, Context, Decimal
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from reference_lcp.terminal import visible

MISSING = "–"
"""Stands where there is no number."""


def fixed(value: float, digits: int) -> str:
    """Give `value` with this many decimals and a true minus sign."""
    if not math.isfinite(value):
        return MISSING
    text = f"{value:.{digits}f}"
    return _minus(text.removeprefix("-") if float(text) == 0 else text)


RESIDUE = 1e-9
"""Sizes below it are shown as zero: round-off, in every unit that a page has."""

SMALLEST_IN_TABLE = 0.01
"""From it on, three decimals have two digits that count."""

SMALLEST_PLAIN = Decimal("1e-4")
"""Below it, a number is shorter as a power of ten."""

TWO_DIGITS = Context(prec=2, rounding=ROUND_HALF_UP)


def significant(value: float, sign: str = "") -> str:
    """Give two significant digits: 15, 0.12, 1,700; zero below `RESIDUE`. With ``+`` as `sign`, differences have it.

    It is rounded as the table of accuracy is first, to three decimals: texts that are made from either are the same.
    """
    if not math.isfinite(value):
        return MISSING
    if abs(value) < RESIDUE:
        return "0"
    rounded = TWO_DIGITS.create_decimal(f"{value:.3f}" if abs(value) >= SMALLEST_IN_TABLE else f"{value:.2e}")
    size = abs(rounded)
    text = f"{rounded:,.0f}" if size >= 10 else f"{rounded:f}" if size >= SMALLEST_PLAIN else f"{float(rounded):.1e}"
    return _minus(f"{sign}{text}" if value > 0 else text)


def signed(value: float) -> str:
    """Give a difference in two digits with its sign."""
    return significant(value, "+")


def scientific(value: float) -> str:
    """Give a residual: two digits and a power of ten."""
    if not math.isfinite(value):
        return MISSING
    return _minus(f"{value:.1e}") if value else "0"


def ratio(value: float) -> str:
    """Give a friction or frequency ratio as short as it is on the grid."""
    return _minus(f"{value:.6g}")


def per_cell(value: float | Sequence[float]) -> str:
    """Give a ratio of the chain: one number, or as many as there are cells, from the base on."""
    return f"({', '.join(ratio(cell) for cell in value)})" if isinstance(value, Sequence) else ratio(value)


def span(values: list[int]) -> str:
    """Give the range of whole numbers: one number where they are equal."""
    if not values:
        return MISSING
    low, high = min(values), max(values)
    return str(low) if low == high else f"{low}–{high}"


def typeset(text: str) -> Markup:
    """Escape `text`, set the indices of its symbols low (η_r, ω_max, λ_T, U0, P0) and give numbers a true minus."""
    text = re.sub(r"(?<![\w.)−-])-(?=[\d.])|(?<=\de)-(?=\d)", "−", text)
    lowered = re.sub("\\b(μ?[A-Za-zΑ-ω]\u0303?)_(max|red|\\w)\\b", r"\1<sub>\2</sub>", str(escape(_safe(text))))
    return Markup(re.sub(r"\b([UP])0\b", r"\1<sub>0</sub>", lowered))


def _minus(text: str) -> str:
    return text.replace("-", "−")


def _safe(value: Any) -> Any:
    """Show the characters of a text that would be obeyed, but for ends of lines."""
    return "\n".join(map(visible, value.split("\n"))) if type(value) is str else value


def environment(*packages: str, markup: bool = True) -> Environment:
    """Give the templates of packages, which refuse names that are not there; those of markup escape what they print."""
    templates = Environment(
        loader=ChoiceLoader([PackageLoader(name) for name in dict.fromkeys(packages)]),
        autoescape=markup,
        finalize=_safe,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=not markup,
    )
    for display in (fixed, significant, signed, scientific, ratio, per_cell, span, typeset):
        templates.filters[display.__name__] = display
    return templates
