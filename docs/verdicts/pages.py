"""Pages of verdicts: a heat map of engines over scenarios, and a page an engine and a scenario, from one table.

The documentation calls `write` before it is built; what it writes is not kept.
"""

from collections.abc import Iterator, Mapping
from enum import StrEnum
from html import escape
from pathlib import Path
from typing import Any

import pandas as pd

from multibody_xval.engines.interface import registry
from multibody_xval.scenarios.catalogue.registry import CATALOGUE


class Outcome(StrEnum):
    """Of one number; several have that of the worst, which comes first."""

    UNMODELLED = "unmodelled"
    MODELLED = "modelled"
    INCONCLUSIVE = "inconclusive"
    BLOCKED = "blocked"
    AGREES = "agrees"


SIGNS: Mapping[str, str] = {
    Outcome.UNMODELLED: "✗", Outcome.MODELLED: "≈", Outcome.INCONCLUSIVE: "?",
    Outcome.BLOCKED: "–", Outcome.AGREES: "✓",
}  # fmt: skip
"""What a cell shows beside its colour."""


ENGINES = Path(__file__).parents[1] / "engines"
"""Pages of the engines."""

NUMBERS = ("value", "expected", "difference", "allowed")
"""Columns that can be empty."""

OUTCOMES = tuple(map(str, Outcome))
"""Of one number; a group has that of its worst."""


def cell_of(counts: Mapping[Any, int]) -> dict[str, str]:
    """Give the class, the text and the words of a cell: the worst outcome, with how many have it where not all do."""
    worst = next(iter(counts))
    number = "" if len(counts) == 1 else f" {counts[worst]}"
    return {
        "outcome": str(worst).replace(" ", "-"),
        "text": SIGNS[worst] + number,
        "words": ", ".join(f"{count} {outcome}" for outcome, count in counts.items()),
    }


def read(table: Path) -> pd.DataFrame:
    """Read the table that `summary.py` writes."""
    rows = pd.read_csv(table, keep_default_na=False, na_values=dict.fromkeys(NUMBERS, ""))
    absent = {name: 0 for name in OUTCOMES if name not in rows}
    return rows.assign(**absent, variant=rows["formulation"] + " " + rows["preset"])


def write(table: Path, folder: Path) -> None:
    """Write the heat map as HTML, and the pages as Markdown."""
    rows = read(table)
    texts = {"heat_map.html": heat_map(rows)}
    for kind, page in (("engine", engine_page), ("scenario", scenario_page)):
        texts |= {f"{kind}s/{name}.md": page(str(name), own) for name, own in rows.groupby(kind, sort=False)}
    for file, lines in texts.items():
        (folder / file).parent.mkdir(exist_ok=True)
        (folder / file).write_text("\n".join(lines), encoding="utf-8")


def _counted(counts: Mapping[Any, Any]) -> dict[str, int]:
    """Give how many numbers have each outcome that there is, the worst first."""
    return {name: int(count) for name, count in counts.items() if count}


def heat_map(rows: pd.DataFrame) -> Iterator[str]:
    """Give the lines of HTML tables: a column a scenario, a row a variant below its engine; defaults are folded."""
    installed = rows["preset"].str.startswith("default")
    yield from _map(rows, rows[~installed])
    yield "<details><summary>As installed: the presets <code>default</code></summary>"
    yield from _map(rows, rows[installed])
    yield "</details>"


def _map(every: pd.DataFrame, rows: pd.DataFrame) -> Iterator[str]:
    scenarios = [name for name in CATALOGUE if name in set(every["scenario"])]
    yield '<div class="verdict-map"><table><thead><tr><th>formulation, preset</th>'
    yield from (f'<th><a href="scenarios/{name}.html"><span>{name}</span></a></th>' for name in scenarios)
    yield "</tr></thead>"
    for engine, of_engine in rows.groupby("engine", sort=False):
        title = f'<a href="engines/{engine}.html">{engine}</a>'
        yield f'<tbody><tr><th class="engine" scope="rowgroup" colspan="{1 + len(scenarios)}">{title}</th></tr>'
        for variant, own in of_engine.groupby("variant", sort=False):
            by_scenario = dict(list(own.groupby("scenario")))
            yield f"<tr><th>{escape(str(variant))}</th>"
            yield from (_cell(str(engine), str(variant), name, by_scenario.get(name)) for name in scenarios)
            yield "</tr>"
        yield "</tbody>"
    yield "</table></div>"


def _cell(engine: str, variant: str, scenario: str, rows: pd.DataFrame | None) -> str:
    if rows is None:
        return "<td></td>"
    cell = cell_of(_counted(rows[list(OUTCOMES)].sum().to_dict()))
    return (
        f'<td class="{cell["outcome"]}"><a href="engines/{engine}.html#{scenario}" '
        f'title="{engine} {variant}, {scenario}: {cell["words"]}">{cell["text"]}</a></td>'
    )


def engine_page(name: str, rows: pd.DataFrame) -> Iterator[str]:
    """Give the lines of the page of an engine: a table a scenario."""
    yield from (f"# {name}: verdicts", "", f"[All engines](../index.md).{_reasons(name)}", "")
    for scenario, own in rows.groupby("scenario", sort=False):
        yield from (f"## {scenario}", "", f"[{CATALOGUE[str(scenario)].question}](../scenarios/{scenario}.md)", "")
        yield from (*_table(own), "")


def _reasons(name: str) -> str:
    """Link to the page of an engine that explains its numbers; the reference has none."""
    page = ENGINES / f"{type(registry.engine(name)).__module__.split('.')[1]}.md"
    return f" [Why its numbers are what they are](../../engines/{page.name})." if page.is_file() else ""


def scenario_page(name: str, rows: pd.DataFrame) -> Iterator[str]:
    """Give the lines of the page of a scenario: what it asks, and a table an engine."""
    scenario = CATALOGUE[name]
    yield from (f"# {name}: verdicts", "", scenario.question, "", "[All scenarios](../index.md).", "")
    yield from (f"- from: {scenario.source}", f"- compared with: {scenario.expects}")
    yield from (f"- {_with_unit(each.name, each.unit)}: {each.meaning}" for each in scenario.metrics)
    yield from (f"- {line}" for line in scenario.parameters())
    for engine, own in rows.groupby("engine", sort=False):
        yield from ("", f"## {engine}", "", *_table(own))
    yield ""


def _table(rows: pd.DataFrame) -> list[str]:
    """Give a table with one row a preset and metric, in HTML: Sphinx need not read its thousands of cells."""
    shown = pd.DataFrame({
        "preset": rows["variant"],
        "metric": list(map(_with_unit, rows["metric"], rows["unit"])),
        "verdicts": [cell_of(_counted(own))["words"] for own in rows[list(OUTCOMES)].to_dict("records")],
        "worst at": rows["case"],
        **{name: rows[name].map("{:.4g}".format).replace("nan", "–") for name in NUMBERS},
        "why": rows["reason"],
    })  # fmt: skip
    with pd.option_context("display.max_colwidth", None):
        table = shown.to_html(index=False, border=0, justify="left", classes="docutils")
    return ["```{raw} html", table, "```"]


def _with_unit(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name
