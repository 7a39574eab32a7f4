"""A document in Markdown, from sentences, lists and tables."""

from collections.abc import Iterable
from typing import NamedTuple

import pandas as pd

from multibody_xval.scenarios.table_text import markdown_lines, markdown_list


class Folded(NamedTuple):
    """Parts that are shown when a reader opens their title."""

    title: str
    parts: "Parts"


Part = str | list[str] | pd.DataFrame | Folded
"""A paragraph in Markdown, items of a list, a table of texts, or parts that are folded."""

Parts = Iterable[Part]


def document(parts: Parts) -> str:
    """Write parts one after the other, with a blank line between; those with nothing in them are left out."""
    return "\n\n".join(map(_written, filter(len, parts))) + "\n"


def _written(part: Part) -> str:
    if isinstance(part, Folded):
        within = document(part.parts)
        return f"<details><summary>{part.title}</summary>\n\n{within}\n</details>"
    if isinstance(part, str):
        return part
    return "\n".join(markdown_list(part) if isinstance(part, list) else markdown_lines(part))
