"""The heat map of scenes, which the documentation calls `write` for before it is built, and what recipes give.

Recipes are pages beside the adapters: what to write, by hand, and below it what it gives, from `answers.csv`.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd

from multibody_xval.engines.interface import registry
from multibody_xval.engines.interface.variant import FOR_THE_CHAIN, Variant
from multibody_xval.reports.formatting import environment
from multibody_xval.scenarios.catalogue.worst_numbers import NOT_CURED, printed_number, with_recipe

FOLDER = Path(__file__).parent

FENCE = "```"

DECADES = 6
"""Shades of the heat map: decades of a number over the smallest one that counts as none."""

NOT_CURED_MEANS = (
    f"*{NOT_CURED.capitalize()}*: more than twice what is allowed with the recipe, too. "
    "Where the lines above name no other option, none is known."
)

LEAST = {"µm/s": 0.1, "µrad/s": 0.1, "%": 0.1, "mm": 0.1, "mrad": 1.0, "°": 0.1, "ms": 1.0}
"""By unit, what counts as none."""


def write(table: Path = FOLDER / "answers.csv", folder: Path = FOLDER) -> None:
    """Write the heat map as HTML."""
    rows = pd.read_csv(table)
    pages = {name: f"../engines/{_page(name)}.html" for name in rows.engine.unique()}
    (folder / "heat_map.html").write_text(heat_map(rows[~rows.number.str.startswith("cost")], pages), encoding="utf-8")


def heat_map(rows: pd.DataFrame, pages: Mapping[str, str]) -> str:
    """Give a table of numbers and engines, default options over the recipe, in shades of the recipe's.

    `pages` are linked, by the name of the engine.
    """
    engines = list(dict.fromkeys(rows.engine))
    values: dict[Any, list[float]] = rows.set_index(["number", "engine"])[["default", "recommended"]].T.to_dict("list")
    cells = {
        number: [_cell(number, values.get((number, name), [])) for name in engines] for number in rows.number.unique()
    }
    titles = {name: registry.engine(name).capabilities.title for name in engines}
    template = environment().from_string((FOLDER / "heat_map.jinja").read_text(encoding="utf-8"))
    return template.render(titles=titles, cells=cells, pages=pages)


def _cell(number: str, values: Sequence[float]) -> tuple[int, list[str]] | None:
    """Give the shade of a cell and its lines; ``None`` of an empty one."""
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return None
    first, *others = dict.fromkeys(printed_number(value).replace("-", "−") for value in known)
    return _shade(number, known[-1]), [first, *(f"→ {text}" for text in others)]


def _shade(number: str, value: float) -> int:
    """Give the decades of a number over what counts as none."""
    least = LEAST[number.rpartition("[")[2].rstrip("]")]
    if not math.isfinite(value):
        return DECADES
    return min(DECADES, max(0, math.ceil(math.log10(max(abs(value), least) / least))))


def _reaches(name: str) -> Iterator[str]:
    """Say of the options of tuned presets which hold in any model."""
    yield f"*Tuned* presets are of no use here. {FOR_THE_CHAIN} Of what they change:"
    yield ""
    for formulation in registry.engine(name).capabilities.presets:
        tuned = Variant(name, str(formulation))
        kinds: dict[str, list[str]] = {}
        changed = tuned.preset.changed_from(replace(tuned, preset_name="default").preset)
        for option in (name for name in tuned.preset.engine_options if name in changed):
            kinds.setdefault(tuned.reach(option), []).append(f"`{option}`")
        texts = [f"*{kind}* {', '.join(own)}" for kind, own in kinds.items()]
        yield f"- {formulation}: {'; '.join(texts) or 'nothing'}."
    yield ""


def _page(name: str) -> str:
    """Give the page of an engine; both of Exudyn's have one."""
    own = name.replace("-", "_")
    return own if (FOLDER.parent / "engines" / f"{own}.md").is_file() else own.partition("_")[0]


def with_numbers(text: str, name: str, rows: pd.DataFrame) -> str:
    """Give the page of a recipe with what it gives: all below what is to be written."""
    written = text[: text.index(f"{FENCE}\n", text.index(FENCE) + 1) + len(FENCE)]
    return "\n".join([written, "", *_reaches(name), *_numbers(name, rows)]).rstrip() + "\n"


def _numbers(name: str, rows: pd.DataFrame) -> Iterator[str]:
    if rows.empty:
        return
    yield f"Worst number of each scene at the engine's own time step (`multibody-xval recipe {name}`):"
    yield from ("", "| scene | default options | recipe |", "|---|---|---|")
    for row in rows.itertuples():
        if row.number.startswith("cost"):
            yield f"| {row.number.removesuffix(' [×]')} | 1 | ×{row.recommended:.2f} |"
        else:
            recipe = with_recipe(row.recommended, cured=row.cured)
            yield f"| {row.number} | {printed_number(row.default)} | {recipe} |"
    if not rows.cured.all():
        yield from ("", NOT_CURED_MEANS)
