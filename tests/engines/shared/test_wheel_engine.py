"""Engines that are installed, but in a version that their adapters do not take."""

import pytest

from engines.mujoco import MuJoCo
from engines.pinocchio import Pinocchio
from engines.shared.wheel_engine import WheelEngine


@pytest.mark.parametrize(("engine", "version"), [(MuJoCo(), "3.3.6"), (MuJoCo(), "5.0.0"), (Pinocchio(), "3.9.1")])
def test_another_version_is_a_reason_with_those_that_the_adapter_takes(
    engine: WheelEngine, version: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if engine.unavailable_reason() is not None:
        pytest.skip(f"{engine.name} is not installed")
    monkeypatch.setattr("engines.shared.wheel_engine.installed_version", lambda _: version)
    package, allowed = engine.capabilities.package, engine.versions
    lacking = f"{package} {version} is installed, and its adapter takes {allowed}; multibody-xval "
    assert str(engine.unavailable_reason()).startswith(lacking)


@pytest.mark.parametrize("version", ["3", "3.3", "3.3.7", "3.17.0", "4", "4.0.0", "4.1.0rc1"])
def test_a_version_is_taken_if_one_that_begins_so_is(version: str) -> None:
    assert MuJoCo.takes(version)


@pytest.mark.parametrize("version", ["2", "3.2", "3.3.6", "5", "5.0"])
def test_a_version_is_not_taken_if_none_that_begins_so_is(version: str) -> None:
    assert not MuJoCo.takes(version)
