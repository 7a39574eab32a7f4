"""From names to variants: one, several with ``all``, and those that are compared where none is named."""

from collections.abc import Iterable, Sequence

from engines.interface.registry import default_engine_names, engine, engine_names
from engines.interface.variant import Variant, name_parts
from reference_lcp.refusal import ParameterError, checked_choice

ALL = "all"
"""In place of a part of a name: every one."""

EVERY_VARIANT = f"{ALL}:{ALL}:{ALL}"
"""Every preset of every engine."""


def variants_of(name: str, *, optional: bool = False) -> list[Variant]:
    """Give the variants of an engine, in the order in which its capabilities list them.

    Parameters
    ----------
    name
        Of the engine.
    optional
        Give those of `Preset.optional` too.

    Raises
    ------
    ParameterError
        If no engine of this name is registered.
    """
    return [
        Variant(name, str(formulation), preset_name)
        for formulation, presets in engine(name).capabilities.presets.items()
        for preset_name, preset in presets.items()
        if optional or not preset.optional
    ]


def variants_named(names: Sequence[str]) -> list[Variant]:
    """Give the variants that are to be run by their names, each once.

    Parameters
    ----------
    names
        ``ENGINE[:FORMULATION[:PRESET]][:OPTION=VALUE]...``; joint and tuned where they are left out. ``all`` in place
        of a part stands for every one, but for presets that take part only where they are named.

    Raises
    ------
    ParameterError
        If there is no such engine, formulation, preset or option; if an engine that is named is not installed.
    """
    return list(dict.fromkeys(variant for name in names for variant in _variants(name)))


def _variants(text: str) -> list[Variant]:
    """Give the variants of one name; its engine is installed, unless it is one of all."""
    names, settings = name_parts(text)
    if ALL not in names:
        variant = Variant.parse(text)
        check_installed(variant.engine, variant.unavailable_reason)
        return [variant]
    if settings:
        raise ParameterError(f"engine = {text!r} sets {settings[0]} in several variants; allowed: in one")
    name, formulation, preset = [*names, *("joint", "tuned")[len(names) - 1 :]]
    if name != ALL:
        check_installed(name, engine(name).unavailable_reason())
    listed = [each for own in (engine_names() if name == ALL else [name]) for each in variants_of(own)]
    if formulation != ALL:
        checked_choice(f"formulation of {name}", formulation, _each(each.formulation for each in listed))
        listed = [each for each in listed if each.formulation == formulation]
    if preset != ALL:
        checked_choice(f"preset of {name}", preset, _each(each.preset_name for each in listed))
        listed = [each for each in listed if each.preset_name == preset]
    return listed


def _each(names: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(names))


def check_installed(name: str, missing: str | None) -> None:
    """Refuse an engine that is named, if it is missing.

    Parameters
    ----------
    name
        Of the engine.
    missing
        What is missing, and what installs it; ``None`` if nothing is.

    Raises
    ------
    ParameterError
        If it is missing.
    """
    if missing is not None:
        raise ParameterError(f"engine = {name} is not installed: {missing}; allowed: one that is")


def default_variants() -> list[Variant]:
    """Give the variants that are compared where none is named: every formulation, tuned and as the engine comes.

    Those of the engines that come with the suite.
    """
    return [
        Variant(name, str(formulation), preset_name)
        for name in default_engine_names()
        for formulation, presets in engine(name).capabilities.presets.items()
        for preset_name in ("tuned", "default")
        if preset_name in presets
    ]
