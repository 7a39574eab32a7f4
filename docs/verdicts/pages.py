"""Pages of verdicts: a heat map of engines over scenarios, and a page an engine and a scenario, from one table.

The documentation calls `write` before it is built; what it writes is not kept.
"""

from collections.abc import Iterator, Mapping
from html import escape
from pathlib import Path
from typing import Any

import pandas as pd
from summary import NUMBERS, read

from multibody_xval.engines.interface import registry
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS

SIGNS = {
    "deviates": "✗", "failed": "!", "not periodic": "~", "unknown": "?", "time step too large": "Δ",
    "unsupported": "–", "agrees": "✓",
}  # fmt: skip
"""What a cell shows beside its colour, by verdict; of several, the worst, which comes first."""

ENGINES = Path(__file__).parents[1] / "engines"
"""Pages of the engines."""


def cell_of(counts: Mapping[Any, int]) -> dict[str, str]:
    """Give the class, the text and the words of a cell: the worst verdict, with how many have it where not all do."""
    found = {name: int(counts[name]) for name in SIGNS if counts[name]}
    worst = next(iter(found))
    return {
        "class": worst.replace(" ", "-"),
        "text": SIGNS[worst] + ("" if len(found) == 1 else f" {found[worst]}"),
        "words": ", ".join(f"{count} {name}" for name, count in found.items()),
    }


def write(table: Path, folder: Path) -> None:
    """Write the heat map as HTML, and the pages as Markdown."""
    rows = read(table)
    rows["configuration"] = rows.formulation + " " + rows.preset
    texts = {"heat_map.html": heat_map(rows)}
    for kind, page in (("engine", engine_page), ("scenario", scenario_page)):
        texts |= {f"{kind}s/{name}.md": page(str(name), own) for name, own in rows.groupby(kind, sort=False)}
    absent = set(registry.engine_names()) - {"reference", *rows["engine"]}
    texts |= {f"engines/{name}.md": engine_page(name, rows[:0]) for name in absent}
    for file, lines in texts.items():
        (folder / file).parent.mkdir(exist_ok=True)
        (folder / file).write_text("\n".join(lines), encoding="utf-8")


def heat_map(rows: pd.DataFrame) -> Iterator[str]:
    """Give the lines of HTML tables: a column a scenario, a row a configuration; defaults are folded."""
    default = rows["preset"].str.startswith("default")
    yield from _map(rows, rows[~default])
    yield "<details><summary>Default options: the presets <code>default</code></summary>"
    yield from _map(rows, rows[default])
    yield "</details>"


def _map(every: pd.DataFrame, rows: pd.DataFrame) -> Iterator[str]:
    scenarios = [name for name in SCENARIOS if name in set(every["scenario"])]
    yield '<div class="verdict-map"><table><thead><tr><th>formulation, preset</th>'
    yield from (f'<th><a href="scenarios/{name}.html"><span>{name}</span></a></th>' for name in scenarios)
    yield "</tr></thead>"
    for engine, of_engine in rows.groupby("engine", sort=False):
        title = f'<a href="engines/{engine}.html">{engine}</a>'
        yield f'<tbody><tr><th class="engine" scope="rowgroup" colspan="{1 + len(scenarios)}">{title}</th></tr>'
        for name, own in of_engine.groupby("configuration", sort=False):
            by_scenario = dict(list(own.groupby("scenario")))
            yield f"<tr><th>{escape(str(name))}</th>"
            yield from (_cell(str(engine), str(name), each, by_scenario.get(each)) for each in scenarios)
            yield "</tr>"
        yield "</tbody>"
    yield "</table></div>"


def _cell(engine: str, configuration: str, scenario: str, rows: pd.DataFrame | None) -> str:
    if rows is None:
        return "<td></td>"
    cell = cell_of(rows[list(SIGNS)].sum())
    return (
        f'<td class="{cell["class"]}"><a href="engines/{engine}.html#{scenario}" '
        f'title="{engine} {configuration}, {scenario}: {cell["words"]}">{cell["text"]}</a></td>'
    )


def engine_page(name: str, rows: pd.DataFrame) -> Iterator[str]:
    """Give the lines of the page of an engine: a table a scenario, or what makes them where there are no numbers."""
    yield from (f"# {name}: verdicts", "", f"[All engines](../index.md).{_reasons(name)}", "")
    if rows.empty:
        made = f"`multibody-xval run all --engine {name}:all:all --out numbers.csv`"
        yield from (f"The table has no numbers of this engine. {made} makes them.", "")
    for scenario, own in rows.groupby("scenario", sort=False):
        yield from (f"## {scenario}", "", f"[{SCENARIOS[str(scenario)].question}](../scenarios/{scenario}.md)", "")
        yield from (*_table(own), "")


def _reasons(name: str) -> str:
    """Link to the page of an engine that explains its numbers; the reference has none."""
    page = ENGINES / f"{type(registry.engine(name)).__module__.split('.')[1]}.md"
    return f" [Why its numbers are what they are](../../engines/{page.name})." if page.is_file() else ""


def scenario_page(name: str, rows: pd.DataFrame) -> Iterator[str]:
    """Give the lines of the page of a scenario: what it asks, and a table an engine."""
    scenario = SCENARIOS[name]
    yield from (f"# {name}: verdicts", "", scenario.question, "", "[All scenarios](../index.md).", "")
    yield from (f"- from: {scenario.source}", f"- compared with: {scenario.expects}")
    yield from (f"- {_with_unit(each.name, each.unit)}: {each.meaning}" for each in scenario.quantities)
    yield from (f"- {line}" for line in scenario.details)
    for engine, own in rows.groupby("engine", sort=False):
        yield from ("", f"## {engine}", "", *_table(own))
    yield ""


def _table(rows: pd.DataFrame) -> list[str]:
    """Give a table with one row a preset and quantity, in HTML: Sphinx need not read its thousands of cells."""
    shown = pd.DataFrame({
        "configuration": rows["configuration"],
        "judged": rows["judged"].map({True: "yes", False: "no"}),
        "quantity": list(map(_with_unit, rows["quantity"], rows["unit"])),
        "verdicts": [cell_of(own)["words"] for own in rows[list(SIGNS)].to_dict("records")],
        "worst at": rows["case"],
        **{name: rows[name].map("{:.4g}".format).replace("nan", "–") for name in NUMBERS},
        "why": rows["reason"],
    })  # fmt: skip
    with pd.option_context("display.max_colwidth", None):
        table = shown.to_html(index=False, border=0, justify="left", classes="docutils")
    return ["```{raw} html", table, "```"]


def _with_unit(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name
