"""An engine's recipe: what to write in one's own model so that friction holds, as a page beside the adapter."""

from importlib.resources.abc import Traversable

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.reports.reproducers.script import beside
from multibody_xval.scenarios.catalogue.recipes import NOTHING_TO_RECOMMEND
from reference_lcp.errors import ParameterError, checked_choice


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
