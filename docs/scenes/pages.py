"""What a recipe gives, in numbers: the part of each recipe below what is written by hand, from `answers.csv`."""

from collections.abc import Iterator

import pandas as pd

from multibody_xval.engines.interface import registry
from multibody_xval.engines.interface.variant import FOR_THE_CHAIN, Variant
from multibody_xval.reports.reproducers.recipe import MADE, by_hand
from multibody_xval.scenarios.catalogue.worst_numbers import NOT_CURED, printed_number, with_recipe

NOT_CURED_MEANS = (
    f"*{NOT_CURED.capitalize()}*: more than twice what is allowed with the recipe, too. "
    "Where the lines above name no other option, none is known."
)


def _reaches(name: str) -> Iterator[str]:
    """Say of the options of tuned presets which hold in any model."""
    yield f"{MADE} are of no use here. {FOR_THE_CHAIN} Of what they change:"
    yield ""
    for formulation in registry.engine(name).capabilities.presets:
        tuned = Variant(name, str(formulation))
        kinds: dict[str, list[str]] = {}
        changed = tuned.changed_options
        for option in (name for name in tuned.preset.engine_options if name in changed):
            kinds.setdefault(tuned.reach(option), []).append(f"`{option}`")
        texts = [f"*{kind}* {', '.join(own)}" for kind, own in kinds.items()]
        yield f"- {formulation}: {'; '.join(texts) or 'nothing'}."
    yield ""


def with_numbers(text: str, name: str, rows: pd.DataFrame) -> str:
    """Give the page of a recipe with what it gives: all below what is to be written."""
    return "\n".join([by_hand(text), "", *_reaches(name), *_numbers(name, rows)]).rstrip() + "\n"


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
