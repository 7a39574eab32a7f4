"""Engines that are installed, but in a version that their adapters do not take."""

import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from multibody_xval.engines import engine, engine_names
from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.engines.shared.pip_engine import PipEngine

PROJECT = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text())["project"]


@pytest.mark.needs("mujoco")
@pytest.mark.parametrize(("version", "taken"), [("3.3.5", False), ("3.3.6", True), ("5.0.0", False)])
def test_another_version_is_a_reason_with_those_that_the_adapter_takes(version: str, taken: bool, monkeypatch) -> None:
    monkeypatch.setattr("multibody_xval.engines.shared.pip_engine.installed_version", lambda _: version)
    lacking = f"mujoco {version} is installed, and its adapter takes {MuJoCo.versions}; pip install "
    reason = MuJoCo().unavailable_reason()
    assert reason is None if taken else str(reason).startswith(lacking)


def test_adapters_take_the_versions_that_the_suite_asks_for() -> None:
    extras = PROJECT["optional-dependencies"]
    asked = map(Requirement, [*PROJECT["dependencies"], *extras["engines"], *extras["genesis"]])
    versions = {each.name: each.specifier for each in asked}
    adapters = [own for name in engine_names() if isinstance(own := engine(name), PipEngine) and own.versions]
    assert adapters
    for own in adapters:
        assert versions[own.capabilities.package] == Requirement(f"any{own.versions}").specifier, own.name
