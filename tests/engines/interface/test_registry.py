"""Engines by name: those that come with the suite, and further ones."""

import importlib.util
import re
import sys

import pytest

from multibody_xval.engines import engine, engine_names
from multibody_xval.engines.interface.registry import default_engine_names
from multibody_xval.engines.isolated import out_of_process
from reference_lcp import ParameterError

WITHOUT_WHEEL = {"pybullet"} if sys.version_info >= (3, 12) else set()


def test_every_engine_that_comes_with_the_suite_is_installed() -> None:
    assert {"reference", "mujoco", "pybullet", "exudyn-regularised", "exudyn-bristle"} <= set(default_engine_names())
    missing = {name for name in default_engine_names() if engine(name).unavailable_reason() is not None}
    assert missing <= WITHOUT_WHEEL


FURTHER = (
    "box2d", "dart", "drake", "genesis", "mujoco-warp", "newton", "ode", "pinocchio", "pymunk", "rapier", "sapien",
    "siconos",
)  # fmt: skip


def test_further_engines_are_those_that_are_not_usual() -> None:
    assert set(FURTHER) <= set(engine_names()) - set(default_engine_names())


@pytest.mark.parametrize("name", FURTHER)
def test_further_engine_that_is_missing_says_how_to_install_it(name, monkeypatch) -> None:
    """Here none may be missing: no package is found, and the system's Python is one that is not there."""
    monkeypatch.setattr(importlib.util, "find_spec", lambda _package: None)
    monkeypatch.setattr(out_of_process, "system_python", lambda: "/nowhere/python3")
    for variable in ("MULTIBODY_XVAL_SICONOS_PYTHON", "MULTIBODY_XVAL_ODE_PYTHON"):
        monkeypatch.delenv(variable, raising=False)
    assert re.search(r"\b(pip|apt) install\b", engine(name).unavailable_reason())


def test_unknown_engine_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ParameterError, match="engine = 'bullet' is unknown; allowed: reference"):
        engine("bullet")
