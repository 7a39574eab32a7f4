"""Engines that are installed, but in a version that their adapters do not take."""

import pytest

from engines.mujoco import MuJoCo
from engines.pinocchio import Pinocchio
from engines.shared.pip_engine import PipEngine


@pytest.mark.parametrize(
    ("engine", "version"),
    [
        pytest.param(MuJoCo(), "3.3.6", marks=pytest.mark.needs("mujoco")),
        pytest.param(MuJoCo(), "5.0.0", marks=pytest.mark.needs("mujoco")),
        pytest.param(Pinocchio(), "3.9.1", marks=pytest.mark.needs("pinocchio")),
    ],
)
def test_another_version_is_a_reason_with_those_that_the_adapter_takes(
    engine: PipEngine, version: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("engines.shared.pip_engine.installed_version", lambda _: version)
    package, allowed = engine.capabilities.package, engine.versions
    lacking = f"{package} {version} is installed, and its adapter takes {allowed}; multibody-xval "
    assert str(engine.unavailable_reason()).startswith(lacking)


@pytest.mark.parametrize("version", ["3", "3.3", "3.3.7", "3.17.0", "4", "4.0.0", "4.1.0rc1"])
def test_a_version_is_taken_if_one_that_begins_so_is(version: str) -> None:
    assert MuJoCo.takes(version)


@pytest.mark.parametrize("version", ["2", "3.2", "3.3.6", "5", "5.0"])
def test_a_version_is_not_taken_if_none_that_begins_so_is(version: str) -> None:
    assert not MuJoCo.takes(version)
