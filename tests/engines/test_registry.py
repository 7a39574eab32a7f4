"""Engines by name."""

import sys

import pytest

from engines import engine, engine_names
from reference_lcp import ParameterError


def test_every_engine_that_has_a_wheel_for_this_python_is_installed() -> None:
    """Those of the extra ``engines`` may be missing, and say how they are installed."""
    without_wheel = {"pybullet"} if sys.version_info >= (3, 12) else set()
    reasons = {name: reason for name in engine_names() if (reason := engine(name).why_not_installed()) is not None}
    optional = {name for name, reason in reasons.items() if "pip install 'multibody-xval[engines]'" in reason}
    assert set(reasons) - optional <= without_wheel


def test_unknown_engine_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ParameterError, match="engine = 'bullet' is unknown; allowed: reference"):
        engine("bullet")
