"""Pages of scenes: a table of engines, its heat map, and what to write in one's own model, from one table.

The documentation calls `write` before it is built; what it writes is not kept.
"""

import math
from collections.abc import Iterator
from html import escape
from pathlib import Path

import pandas as pd

from engines.interface import registry
from reports.reproducers.recipe import has_recipe, recipe_text
from scenarios.catalogue.scenes.table import printed_number

FOLDER = Path(__file__).parent

DECADES = 6
"""Shades of the heat map: decades of a number over the smallest one that counts as none."""

LEAST = {"µm/s": 0.1, "µrad/s": 0.1, "%": 0.1, "mm": 0.1, "mrad": 1.0, "°": 0.1}
"""By unit, what counts as none."""


def write(table: Path = FOLDER / "answers.csv", folder: Path = FOLDER) -> None:
    """Write the heat map as HTML, and a page of Markdown an engine, to be included in that of the engine."""
    rows = pd.read_csv(table)
    (folder / "heat_map.html").write_text("\n".join(heat_map(rows)), encoding="utf-8")
    (folder / "recipes").mkdir(exist_ok=True)
    for name in filter(lambda each: has_recipe(registry.registered_engine(each)), registry.engine_names()):
        text = "\n".join(recipe_page(name, rows[rows.engine == name]))
        (folder / "recipes" / f"{name}.md").write_text(text, encoding="utf-8")


def recipe_page(name: str, rows: pd.DataFrame) -> Iterator[str]:
    """Give what to write in one's own model, and what it gives."""
    yield from ("## My blocks creep: what to write", "", "```text", recipe_text(name).rstrip(), "```", "")
    if rows.empty:
        return
    command = f"`multibody-xval recipe {name}`"
    yield f"Worst number of [each scene](../scenes/index.md) at the engine's own time step ({command}):"
    yield from ("", "| scene | as installed | recipe |", "|---|---|---|")
    for row in rows.itertuples():
        if row.number.startswith("cost"):
            yield f"| {row.number.removesuffix(' [×]')} | 1 | ×{row.recommended:.2f} |"
        else:
            yield f"| {row.number} | {printed_number(row.default)} | {printed_number(row.recommended)} |"
    yield ""


def heat_map(rows: pd.DataFrame) -> Iterator[str]:
    """Give the lines of an HTML table: a row an engine, a column a number, as installed over recommended."""
    own = rows[~rows.number.str.startswith("cost")]
    numbers = list(dict.fromkeys(own.number))
    yield '<div class="verdict-map scene-map"><table><thead><tr><th>engine</th>'
    yield from (f"<th><span>{escape(number)}</span></th>" for number in numbers)
    yield "</tr></thead><tbody>"
    for engine, each in own.groupby("engine", sort=False):
        title = registry.registered_engine(str(engine)).capabilities.title
        yield f'<tr><th><a href="../engines/{str(engine).replace("-", "_")}.html">{escape(title)}</a></th>'
        cells = {row.number: (row.default, row.recommended) for row in each.itertuples()}
        yield from (_cell(number, *cells.get(number, (math.nan, math.nan))) for number in numbers)
        yield "</tr>"
    yield "</tbody></table></div>"


def _cell(number: str, before: float, after: float) -> str:
    if math.isnan(before):
        return "<td></td>"
    texts = list(dict.fromkeys([printed_number(before), printed_number(after)]))
    return f'<td class="shade{_shade(number, after)}">{" → ".join(texts)}</td>'


def _shade(number: str, value: float) -> int:
    """Give the decades of a number over what counts as none."""
    least = LEAST[number.rpartition("[")[2].rstrip("]")]
    if not math.isfinite(value):
        return DECADES
    return min(DECADES, max(0, math.ceil(math.log10(max(abs(value), least) / least))))
