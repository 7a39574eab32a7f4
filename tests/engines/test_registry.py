"""Engines by name."""

import sys

import pytest

from engines import engine, engine_names
from reference_lcp import ParameterError

OPTIONAL = {"drake"}
"""Engines of the extra ``engines``, which a plain installation does without."""


def test_every_engine_that_has_a_wheel_for_this_python_is_installed() -> None:
    without_wheel = {"pybullet"} if sys.version_info >= (3, 12) else set()
    missing = {name for name in engine_names() if engine(name).why_not_installed() is not None}
    assert missing <= without_wheel | OPTIONAL


def test_unknown_engine_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ParameterError, match="engine = 'bullet' is unknown; allowed: reference"):
        engine("bullet")
