"""Engines that are installed, but in a version that their adapters do not take."""

import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from multibody_xval.engines import engine, engine_names
from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.engines.pinocchio import Pinocchio
from multibody_xval.engines.shared.pip_engine import PipEngine

PROJECT = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text())["project"]


@pytest.mark.parametrize(
    ("engine", "version"),
    [
        pytest.param(MuJoCo(), "3.3.5", marks=pytest.mark.needs("mujoco")),
        pytest.param(MuJoCo(), "5.0.0", marks=pytest.mark.needs("mujoco")),
        pytest.param(Pinocchio(), "3.9.1", marks=pytest.mark.needs("pinocchio")),
    ],
)
def test_another_version_is_a_reason_with_those_that_the_adapter_takes(
    engine: PipEngine, version: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("multibody_xval.engines.shared.pip_engine.installed_version", lambda _: version)
    package, allowed = engine.capabilities.package, engine.versions
    lacking = f"{package} {version} is installed, and its adapter takes {allowed}; pip install "
    assert str(engine.unavailable_reason()).startswith(lacking)


@pytest.mark.needs("mujoco")
@pytest.mark.parametrize("version", ["3.3.6", "3.17.0", "4.0.0", "4.1.0rc1"])
def test_a_version_that_the_adapter_takes_is_no_reason(version: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("multibody_xval.engines.shared.pip_engine.installed_version", lambda _: version)
    assert MuJoCo().unavailable_reason() is None


def test_adapters_take_the_versions_that_the_suite_asks_for() -> None:
    extras = PROJECT["optional-dependencies"]
    asked = map(Requirement, [*PROJECT["dependencies"], *extras["engines"], *extras["genesis"]])
    versions = {each.name: each.specifier for each in asked}
    adapters = [own for name in engine_names() if isinstance(own := engine(name), PipEngine) and own.versions]
    assert adapters
    for own in adapters:
        assert versions[own.capabilities.package] == Requirement(f"any{own.versions}").specifier, own.name
