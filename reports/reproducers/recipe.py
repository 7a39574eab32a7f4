"""An engine's recipe in its own syntax: what to write in one's own model so that friction holds."""

from collections.abc import Iterable, Mapping
from typing import Any

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.presets import Formulation, OfStep, Preset
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.reports.formatting import environment
from multibody_xval.reports.reproducers.script import beside
from multibody_xval.scenarios.catalogue.recipes import NOTHING_TO_RECOMMEND
from multibody_xval.scenarios.catalogue.scenario import COMMON_STEP
from reference_lcp.errors import ParameterError, checked_choice

TEMPLATE = "recipe.jinja"
"""File beside an adapter. It reads the options that the presets ``recommended`` change, as texts by name, in
``contact`` and ``joint``; ``formula`` of those that depend on the time step, and the ``step`` [s]."""

RECOMMENDED = "recommended"


def has_recipe(adapter: Engine) -> bool:
    """Whether an engine has a recipe."""
    return beside(adapter, TEMPLATE).is_file()


def recipe_text(name: str) -> str:
    """Write the recipe of an engine, for its own default time step.

    Raises
    ------
    ParameterError
        If no such engine is registered, or it has no recipe.
    """
    checked_choice("engine", name, engine_names())
    adapter = engine(name)
    if not has_recipe(adapter):
        allowed = ", ".join(each for each in engine_names() if has_recipe(engine(each)))
        recommends = any(RECOMMENDED in presets for presets in adapter.capabilities.presets.values())
        reason = NOTHING_TO_RECOMMEND if adapter.scene_worlds and not recommends else adapter.no_scenes
        raise ParameterError(f"engine = {name} has no recipe: {reason}; allowed: {allowed}")
    step = adapter.scene_step if Formulation.CONTACT in adapter.scene_worlds else COMMON_STEP
    presets = {kind: own[RECOMMENDED] for kind, own in adapter.capabilities.presets.items() if RECOMMENDED in own}
    values = {str(kind): _values(adapter, kind, step) for kind in presets}
    text = environment(markup=False).from_string(beside(adapter, TEMPLATE).read_text(encoding="utf-8"))
    return text.render(**values, formula=_formulas(presets.values()), step=f"{step:g}").strip() + "\n"


def _values(adapter: Engine, kind: Formulation, step: float) -> Mapping[str, str]:
    """Write the options that a recipe changes, as the engine takes them at a time step [s]."""
    presets = adapter.capabilities.presets[kind]
    recommended = presets[RECOMMENDED]
    changed = recommended.changed_from(presets["default"])
    return {name: _text(recommended.value(name, step)) for name in changed}


def _formulas(presets: Iterable[Preset]) -> Mapping[str, str]:
    every = ((name, option.value) for preset in presets for name, option in preset.options.items())
    return {name: value.text for name, value in every if isinstance(value, OfStep)}


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        return " ".join(map(_text, value))
    return f"{value:g}".replace("e+0", "e").replace("e-0", "e-") if isinstance(value, float) else str(value)
