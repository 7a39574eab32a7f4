"""Engines by name."""

import sys

import pytest

from engines import engine, engine_names
from reference_lcp import ParameterError


def test_every_engine_that_the_suite_depends_on_is_installed() -> None:
    """Further ones may be missing: they come with extras, or with the system's Python."""
    needed = {"reference", "mujoco", "exudyn-regularised", "exudyn-bristle"}
    if sys.version_info < (3, 12):
        needed.add("pybullet")
    missing = {name for name in engine_names() if engine(name).why_not_installed() is not None}
    assert needed <= set(engine_names())
    assert not missing & needed


def test_unknown_engine_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ParameterError, match="engine = 'bullet' is unknown; allowed: reference"):
        engine("bullet")
