"""Tests that need an engine which may be absent: ``@pytest.mark.needs("ode")`` skips them, with the engine's reason."""

import os
from collections.abc import Iterable

import pytest

from engines.interface.engine import Engine
from engines.interface.registry import engine, engine_names, registered_engine
from engines.interface.variant import Variant, variants_named
from engines.isolated.versioned_engine import EnvironmentEngine
from engines.shared.pip_engine import PipEngine

EVERYTHING = "MULTIBODY_XVAL_EVERYTHING"
"""Environment variable: with it, an absent engine fails its tests, unless it has an environment of its own."""

ENGINE_PACKAGES = sorted(
    {"siconos", "ode", "warp", "jax", "ovstage"}
    | {own.module.partition(".")[0] for name in engine_names() if isinstance(own := registered_engine(name), PipEngine)}
)
"""Packages of all engines: those that pip installs, those of a distribution, and what some of them are made of."""


def skip_absent(item: pytest.Item) -> None:
    """Skip a test, or fail it, where an engine that its mark `needs` names is absent."""
    for mark in item.iter_markers("needs"):
        for name in mark.args:
            needed = engine(name)
            reason = needed.unavailable_reason()
            if reason is not None:
                required = os.environ.get(EVERYTHING) and not runs_apart(needed)
                (pytest.fail if required else pytest.skip)(reason)


def runs_apart(needed: Engine) -> bool:
    """Say whether an engine has, or needs, an environment of its own."""
    return isinstance(needed, EnvironmentEngine) or getattr(needed, "apart", False)


def each_variant(variants: Iterable[Variant]) -> list:
    """Give parameters of a test: variants, each of which needs its engine."""
    return [pytest.param(one, id=str(one), marks=pytest.mark.needs(one.engine)) for one in variants]


def each_engine(names: Iterable[str]) -> list:
    """Give parameters of a test: names of engines, each of which it needs."""
    return [pytest.param(name, marks=pytest.mark.needs(name)) for name in names]


def variants_of_all() -> list[Variant]:
    """Give every variant of engines that read their options in this process."""
    return [one for one in variants_named(["all:all:all"]) if not isinstance(engine(one.engine), EnvironmentEngine)]
