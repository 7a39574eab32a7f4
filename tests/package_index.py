"""A package index in a folder: versions of MuJoCo that are the one beside the suite under other numbers, or broken."""

import base64
import hashlib
import zipfile
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest

from engines.isolated.environment import FOLDER_VARIABLE
from engines.isolated.installation import Plan, install
from engines.isolated.versioned_engine import Requirement
from engines.mujoco import MuJoCo

CRASHES = "import ctypes\n\n\ndef MjSpec():\n    ctypes.string_at(0)\n"
HANGS = "import time\n\n\ndef MjSpec():\n    time.sleep(1000)\n"

MODULES = {"3.95.0": "raise ImportError('libmissing.so: no such file')\n", "3.96.0": HANGS, "3.97.0": CRASHES}
"""Versions whose package is broken, and what it does."""

WHOLE = ("3.98.0", "3.99.0", "4.99.0")


def write_wheel(folder: Path, name: str, version: str, files: dict[str, str]) -> None:
    """Write a distribution as pip takes it."""
    details = f"{name}-{version}.dist-info"
    files = {
        **files,
        f"{details}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n",
        f"{details}/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    rows = []
    for path, text in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(text.encode()).digest()).rstrip(b"=").decode()
        rows.append(f"{path},sha256={digest},{len(text.encode())}")
    rows.append(f"{details}/RECORD,,")
    with zipfile.ZipFile(folder / f"{name}-{version}-py3-none-any.whl", "w") as wheel:
        for path, text in (*files.items(), (f"{details}/RECORD", "\n".join(rows) + "\n")):
            wheel.writestr(path, text)


@pytest.fixture(scope="session")
def wheels(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Distributions of which nothing but the number is new: what they hold is found beside the suite."""
    folder = tmp_path_factory.mktemp("wheels")
    numpy = find_spec("numpy")
    assert numpy is not None
    assert numpy.origin is not None
    write_wheel(folder, "numpy", "9.0", {"beside_the_suite.pth": f"{Path(numpy.origin).parents[1]}\n"})
    write_wheel(folder, "packaging", "9.0", {})
    for version in WHOLE:
        write_wheel(folder, "mujoco", version, {})
    for version, module in MODULES.items():
        write_wheel(folder, "mujoco", version, {"mujoco/__init__.py": module})
    return folder


@pytest.fixture(scope="module")
def offline(wheels: Path) -> Iterator[pytest.MonkeyPatch]:
    """No index but these wheels, in the modules that ask for it."""
    with pytest.MonkeyPatch.context() as patch:
        settings = wheels / "uv.toml"
        settings.write_text(f"no-index = true\nfind-links = [{str(wheels)!r}]\n")
        patch.setenv("UV_CONFIG_FILE", str(settings))
        patch.setenv("UV_NO_CACHE", "1")
        yield patch


@pytest.fixture(name="folder")
def empty_folder(offline: pytest.MonkeyPatch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of environments, without any."""
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path / "environments"))
    return tmp_path / "environments"


@pytest.fixture(scope="module")
def installed_versions(offline: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The folder of environments, with three of MuJoCo: one that works, one that crashes, one that hangs."""
    made = tmp_path_factory.mktemp("installed")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(FOLDER_VARIABLE, str(made))
        for version in ("3.99.0", "3.97.0", "3.96.0"):
            install(Plan.of(Requirement.of(MuJoCo(), version)))
        yield made
