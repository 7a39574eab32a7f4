"""Tests that need an engine which may be absent: ``@pytest.mark.needs("ode")`` skips them, with the engine's reason."""

import os
from collections.abc import Iterable

import pytest

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.shared.pip_engine import PipEngine

EVERYTHING = "MULTIBODY_XVAL_EVERYTHING"
"""Environment variable: with it, an absent engine fails its tests, unless it comes with an extra of its own."""


def skip_absent(item: pytest.Item) -> None:
    """Skip a test, or fail it, where an engine that its mark `needs` names is absent."""
    for mark in item.iter_markers("needs"):
        for name in mark.args:
            needed = engine(name)
            reason = needed.unavailable_reason()
            if reason is not None:
                usual = getattr(needed, "extra", PipEngine.extra) == PipEngine.extra
                required = os.environ.get(EVERYTHING) and usual
                (pytest.fail if required else pytest.skip)(reason)


def is_extra(item: pytest.Item) -> bool:
    """Whether a test needs an engine that does not come with the suite."""
    return any(engine(name).capabilities.optional for mark in item.iter_markers("needs") for name in mark.args)


def each_variant(variants: Iterable[Variant]) -> list:
    """Give parameters of a test: variants, each of which needs its engine."""
    return [pytest.param(one, id=str(one), marks=pytest.mark.needs(one.engine)) for one in variants]


def each_engine(names: Iterable[str]) -> list:
    """Give parameters of a test: names of engines, each of which it needs."""
    return [pytest.param(name, marks=pytest.mark.needs(name)) for name in names]
