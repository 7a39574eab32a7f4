"""An engine's recipe in its own syntax: what to write in one's own model so that friction holds."""

from collections.abc import Mapping
from importlib import import_module
from importlib.resources import files
from typing import Any

from engines.interface.engine import Engine
from engines.interface.presets import Formulation, OfStep, Preset
from engines.interface.registry import engine_names, registered_engine
from reference_lcp.errors import ParameterError, checked_choice
from reports.formatting import environment
from scenarios.catalogue.scenes.base import COMMON_STEP

TEMPLATE = "recipe.jinja"
"""File beside an adapter. It reads the options that the presets ``recommended`` change, as texts by name, in
``contact`` and ``joint``; ``formula`` of those that depend on the time step, and the ``step`` [s]."""

RECOMMENDED = "recommended"


def has_recipe(adapter: Engine) -> bool:
    """Whether an engine has a recipe."""
    return _template(adapter).is_file()


def recipe_text(name: str) -> str:
    """Write the recipe of an engine, for its own default time step.

    Raises
    ------
    ParameterError
        If no such engine is registered, or it has no recipe.
    """
    checked_choice("engine", name, engine_names())
    adapter = registered_engine(name)
    if not has_recipe(adapter):
        allowed = ", ".join(each for each in engine_names() if has_recipe(registered_engine(each)))
        raise ParameterError(f"engine = {name} has no recipe: {adapter.no_scenes}; allowed: {allowed}")
    step = adapter.scene_step if Formulation.CONTACT in adapter.scene_worlds else COMMON_STEP
    presets = {kind: own[RECOMMENDED] for kind, own in adapter.capabilities.presets.items() if RECOMMENDED in own}
    formulas = {name: text for preset in presets.values() for name, text in _formulas(preset).items()}
    values = {str(kind): _values(preset, step) for kind, preset in presets.items()}
    text = environment(markup=False).from_string(_template(adapter).read_text(encoding="utf-8"))
    return text.render(**values, formula=formulas, step=f"{step:g}").strip() + "\n"


def _template(adapter: Engine) -> Any:
    return files(import_module(type(adapter).__module__)).joinpath(TEMPLATE)


def changed_options(preset: Preset) -> list[str]:
    """Name the options that a preset changes."""
    return [name for name, option in preset.options.items() if option.value != option.default]


def _values(preset: Preset, step: float) -> Mapping[str, str]:
    """Write the options that a preset changes, as the engine takes them at a time step [s]."""
    return {name: _text(preset.value(name, step)) for name in changed_options(preset)}


def _formulas(preset: Preset) -> Mapping[str, str]:
    return {name: preset[name].text for name in changed_options(preset) if isinstance(preset[name], OfStep)}


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        return " ".join(map(_text, value))
    return f"{value:g}" if isinstance(value, float) else str(value)
