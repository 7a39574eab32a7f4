"""Pages of scenes: a table of engines, its heat map, and what to write in one's own model, from one table.

The documentation calls `write` before it is built; what it writes is not kept.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pandas as pd

from multibody_xval.engines.interface import registry
from multibody_xval.engines.interface.variant import FOR_THE_CHAIN, Variant
from multibody_xval.reports.figures.scene_map import heat_map
from multibody_xval.reports.reproducers.recipe import has_recipe, recipe_text
from multibody_xval.scenarios.catalogue.worst_numbers import printed_number

FOLDER = Path(__file__).parent


def write(table: Path = FOLDER / "answers.csv", folder: Path = FOLDER) -> None:
    """Write the heat map as HTML, and a page of Markdown an engine, to be included in that of the engine."""
    rows = pd.read_csv(table)
    pages = {name: f"../engines/{_page(name)}.html" for name in rows.engine.unique()}
    (folder / "heat_map.html").write_text(heat_map(rows[~rows.number.str.startswith("cost")], pages), encoding="utf-8")
    (folder / "recipes").mkdir(exist_ok=True)
    for name in filter(lambda each: has_recipe(registry.engine(each)), registry.engine_names()):
        text = "\n".join(recipe_page(name, rows[rows.engine == name]))
        (folder / "recipes" / f"{name}.md").write_text(text, encoding="utf-8")


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


def recipe_page(name: str, rows: pd.DataFrame) -> Iterator[str]:
    """Give what to write in one's own model, and what it gives."""
    yield from ("## My blocks creep: what to write", "", "```text", recipe_text(name).rstrip(), "```", "")
    yield from _reaches(name)
    if rows.empty:
        return
    command = f"`multibody-xval recipe {name}`"
    yield f"Worst number of [each scene](../scenes/index.md) at the engine's own time step ({command}):"
    yield from ("", "| scene | default options | recipe |", "|---|---|---|")
    for row in rows.itertuples():
        if row.number.startswith("cost"):
            yield f"| {row.number.removesuffix(' [×]')} | 1 | ×{row.recommended:.2f} |"
        else:
            yield f"| {row.number} | {printed_number(row.default)} | {printed_number(row.recommended)} |"
    yield ""
