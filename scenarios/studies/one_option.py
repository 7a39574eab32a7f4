"""Variants with one option changed: they are compared with the truth alone, and decide about nothing."""

from collections.abc import Collection
from typing import Any

from engines.interface.presets import Formulation
from engines.interface.registry import engine
from engines.interface.variant import Variant
from reference_lcp.errors import ParameterError


def one_option_variants(judged: Collection[Variant], beside: Collection[Variant] = ()) -> tuple[Variant, ...]:
    """Give the variants that show what single options decide.

    Those are presets at other values of the options that they vary (`Preset.varied`), and defaults with one option of
    the tuned preset each: only of engines whose default is judged on the whole grid, for a law predicts it there.
    """
    settling = {variant.engine for variant in judged if variant.preset_name == "default"}
    chosen = []
    for variant in (*judged, *beside):
        if variant.preset_name == "default" and variant.engine in settling:
            chosen += with_single_options(variant)
        values = variant.preset.varied
        chosen += [variant.changed(option, value) for option, own in values.items() for value in own]
    return tuple(dict.fromkeys(chosen))


def with_single_options(default: Variant) -> list[Variant]:
    """Give a default preset with each of the options of the tuned one alone; without those that it cannot set."""
    if "tuned" not in default.capabilities.presets[Formulation(default.formulation)]:
        return []
    variants = []
    for option, value in tuned_options(default.engine, default.formulation).items():
        try:
            variants.append(default.changed(option, value))
        except ParameterError:
            continue
    return variants


def tuned_options(name: str, formulation: str) -> dict[str, Any]:
    """Give the options of the tuned preset of an engine whose values are others than in its default preset."""
    tuned, default = (engine(name).preset(formulation, preset).engine_options for preset in ("tuned", "default"))
    return {
        option: own.value
        for option, own in tuned.items()
        if own.value != (default[option].value if option in default else own.default)
    }
