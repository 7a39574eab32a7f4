"""What the clauses of the contract are run for: the presets of an engine, by what they say that they can do."""

from functools import cache
from typing import Any

import pytest

from multibody_xval.engines.interface.laws import law_of
from multibody_xval.engines.interface.presets import Formulation, NormalForce
from multibody_xval.engines.interface.registry import engine, installed_engine_names
from multibody_xval.engines.interface.variant import Variant, name_parts, variants_begun


@cache
def cases(named: tuple[str, ...]) -> dict[str, list[Any]]:
    """Give what each argument of a clause stands for, of what is named or, without any, of all that are installed.

    ``scenic`` is every preset that runs scenes. Of those that run the chain, ``tested`` is every one, ``tuned`` the
    best known options, ``default`` what a newcomer gets, ``sharing`` those that share the reference's scheme,
    ``exact`` those of them that are tuned, ``modelled`` those that have a law, ``following`` those whose normal force
    may change in time, ``following_tuned`` those of them that are tuned, ``lifting`` the tuned ones whose contacts may
    open, ``holding`` the tuned ones with static friction of its own. ``installed`` is the name of an engine.
    """
    names = named or tuple(installed_engine_names())
    every = dict.fromkeys(variant for name in names for variant in variants_begun(name))
    presets = [(variant, variant.preset) for variant in every if not variant.preset.scenes_only]
    follows = [own for own, preset in presets if preset.represents(NormalForce.MODULATED)]
    shares = [own for own, preset in presets if preset.shares_scheme and own.engine != "reference"]
    chosen = {
        "tested": [own for own, _ in presets],
        "tuned": [own for own, _ in presets if is_tuned(own)],
        "default": [own for own, _ in presets if own.preset_name == "default"],
        "sharing": shares,
        "exact": [own for own in shares if is_tuned(own)],
        "modelled": [own for own, _ in presets if is_modelled(own)],
        "following": follows,
        "following_tuned": [own for own in follows if is_tuned(own)],
        "lifting": [own for own, preset in presets if is_tuned(own) and preset.represents(NormalForce.LIFTING)],
        "scenic": [own for own in every if own.runs_scenes and not has_scene_gap(own)],
        "holding": [own for own, preset in presets if is_tuned(own) and preset.static_friction],
    }
    return {name: [marked(own, named) for own in own] for name, own in chosen.items()} | {
        "installed": list(dict.fromkeys(name_parts(name)[0][0] for name in names))
    }


def has_scene_gap(variant: Variant) -> bool:
    """Whether its engine builds no scenes of its formulation."""
    return engine(variant.engine).scene_gap(Formulation(variant.formulation)) is not None


def is_tuned(variant: Variant) -> bool:
    """Whether its options are the best known ones for the chain."""
    return variant.preset_name == "tuned"


def is_modelled(variant: Variant) -> bool:
    """Whether it has a law, or one that cannot be made: then it is the law's clause that fails."""
    try:
        return law_of(variant) is not None
    except Exception:  # a law may be a stranger's
        return True


def marked(variant: Variant, named: tuple[str, ...]) -> Any:
    """Let other presets than the tuned ones be slow, unless their engine is named; mark engines beyond the suite."""
    marks = [] if named or is_tuned(variant) else [pytest.mark.slow]
    marks += [pytest.mark.needs(variant.engine)] if engine(variant.engine).capabilities.optional else []
    return pytest.param(variant, marks=marks) if marks else variant


def label(variant: Variant) -> str:
    """Give the part of a test's name that says what it is run for."""
    return f"{variant.engine}-{variant.formulation}-{variant.preset_name}"
