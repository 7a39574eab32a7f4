"""An engine's recipe: what to write in one's own model so that friction holds, as a page beside the adapter."""

import re
import textwrap
from collections.abc import Iterator
from importlib.resources.abc import Traversable

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.reports.reproducers.script import beside
from multibody_xval.scenarios.catalogue.recipes import NOTHING_TO_RECOMMEND
from reference_lcp.errors import ParameterError, checked_choice

CODE = " "
"""Lines that begin with it are to be pasted as they are; all others are sentences."""

WIDTH = 80
"""Columns of the sentences on a terminal."""

ITEM = "- "
"""Begins an item of a list."""

EMPHASIS = re.compile(r"\*{1,2}([^*\n]+)\*{1,2}")
"""``*This*``, which a terminal does not show."""

MADE = "*Tuned* presets"
"""Begins the part of a page that `docs/scenes/pages.py` writes."""


def recipe_file(adapter: Engine) -> Traversable | None:
    """Give the page of an engine, which has its name where others share the folder; ``None`` if it has none."""
    pages = (beside(adapter, name) for name in (f"recipe-{adapter.name}.md", "recipe.md"))
    return next((page for page in pages if page.is_file()), None)


def recipe_text(name: str) -> str:
    """Give the recipe of an engine, in Markdown.

    Raises
    ------
    ParameterError
        If no such engine is registered, or it has no recipe.
    """
    checked_choice("engine", name, engine_names())
    adapter = engine(name)
    page = recipe_file(adapter)
    if page is None:
        allowed = ", ".join(each for each in engine_names() if recipe_file(engine(each)))
        recommends = any("recommended" in presets for presets in adapter.capabilities.presets.values())
        reason = NOTHING_TO_RECOMMEND if adapter.scene_worlds and not recommends else adapter.no_scenes
        raise ParameterError(f"engine = {name} has no recipe: {reason}; allowed: {allowed}")
    return page.read_text(encoding="utf-8")


def to_write(name: str) -> str:
    """Give what the recipe of an engine says to write, with notes and alternatives, as plain text."""
    parts = by_hand(recipe_text(name)).partition("\n")[2].split("```")
    plain = (part.removeprefix("text") if own % 2 else EMPHASIS.sub(r"\1", part) for own, part in enumerate(parts))
    notes = (part if own % 2 else re.sub(r"^ +", "", part, flags=re.MULTILINE) for own, part in enumerate(plain))
    return re.sub(r"\n{3,}", "\n\n", "".join(notes)).strip("\n") + "\n"


def for_terminal(block: str) -> Iterator[str]:
    """Give a block in lines: sentences anew in `WIDTH` columns, and all between them unbroken."""
    sentences: list[str] = []
    for line in [*block.splitlines(), CODE]:
        if sentences and (not line or line.startswith((CODE, ITEM))):
            indent = CODE * len(ITEM) * sentences[0].startswith(ITEM)
            text = " ".join(sentences)
            yield from textwrap.wrap(
                text, WIDTH, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
            )
            sentences = []
        if line and not line.startswith(CODE):
            sentences.append(line)
        elif line != CODE:
            yield line


def by_hand(text: str) -> str:
    """Give the part of a page that is written by hand: what to write, notes and alternatives."""
    return text.partition(MADE)[0].rstrip()


def blocks(text: str) -> list[str]:
    """Give what a page says to write: the recipe, then its alternatives."""
    return [own.rstrip() for own in re.findall(r"```text\n(.*?)```", text, re.DOTALL)]
