"""Engines by name: those that come with the suite, and further ones."""

import importlib.util
import re

import pytest

from multibody_xval.engines import engine, engine_names
from multibody_xval.engines.interface.registry import default_engine_names
from multibody_xval.engines.isolated import out_of_process
from reference_lcp import ParameterError

FURTHER = sorted({*engine_names()} - {*default_engine_names()})


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
