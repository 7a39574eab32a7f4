"""Engines that are installed, but in a version that is too old for their adapters."""

import pytest

from engines.interface.engine import Engine
from engines.mujoco import MuJoCo
from engines.pinocchio import Pinocchio


@pytest.mark.parametrize(("engine", "novelty"), [(MuJoCo(), "batch of models"), (Pinocchio(), "friction of joints")])
def test_older_version_is_a_reason_with_what_it_lacks(
    engine: Engine, novelty: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if engine.unavailable_reason() is not None:
        pytest.skip(f"{engine.name} is not installed")
    monkeypatch.setattr("engines.shared.wheel_engine.installed_version", lambda _: "3.9.1")
    lacking = f"{engine.capabilities.package} 3.9.1 has no {novelty}, version 4.0 or newer is needed; pip install "
    assert str(engine.unavailable_reason()).startswith(lacking)
