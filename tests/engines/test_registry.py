"""Engines by name: those that come with the suite, and further ones."""

import sys

import pytest

from engines import engine, engine_names
from engines.registry import usual_engine_names
from reference_lcp import ParameterError

WITHOUT_WHEEL = {"pybullet"} if sys.version_info >= (3, 12) else set()


def test_every_engine_that_comes_with_the_suite_is_installed() -> None:
    assert {"reference", "mujoco", "pybullet", "exudyn-regularised", "exudyn-bristle"} <= set(usual_engine_names())
    missing = {name for name in usual_engine_names() if engine(name).why_not_installed() is not None}
    assert missing <= WITHOUT_WHEEL


def test_further_engine_that_is_missing_says_how_to_install_it() -> None:
    further = set(engine_names()) - set(usual_engine_names())
    assert {"drake", "siconos", "ode", "dart", "pinocchio", "box2d", "pymunk"} <= further
    missing = {name: reason for name in further if (reason := engine(name).why_not_installed()) is not None}
    assert all("install" in reason for reason in missing.values())


def test_unknown_engine_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ParameterError, match="engine = 'bullet' is unknown; allowed: reference"):
        engine("bullet")
