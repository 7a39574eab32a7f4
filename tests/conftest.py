"""Settings of the whole test run, and packages of engines that tests install."""

import os
import subprocess
import sys
from pathlib import Path

# Each worker of pytest has a processor: threads of linear algebra would wait for each other's. NumPy reads this once.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest
from hypothesis import settings

from tests.package_index import empty_folder, installed_versions, offline, wheels  # noqa: F401 (fixtures)

# A run of CI repeats bit for bit; elsewhere every run looks at new examples.
settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("ci")

ROOT = Path(__file__).parents[1]


class Site:
    """A folder into which a package of `tests` is installed, as pip does it, and processes that see it."""

    def __init__(self, folder: Path, package: str):
        install = "-m pip install --quiet --no-deps --no-index --no-build-isolation --disable-pip-version-check"
        command = [sys.executable, *install.split(), "--target", str(folder), str(ROOT / "tests" / package)]
        subprocess.run(command, check=True)
        self.environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), str(ROOT)])}

    def run(self, *arguments: str, code: int = 0) -> str:
        """Run a module of Python; gives what it prints."""
        done = subprocess.run(
            [sys.executable, *arguments], env=self.environment, cwd=ROOT, capture_output=True, text=True, check=False
        )
        assert done.returncode == code, done.stdout + done.stderr
        return done.stdout


@pytest.fixture(scope="session")
def install(tmp_path_factory: pytest.TempPathFactory):
    """Install a package of `tests`, once in a session."""
    sites: dict[str, Site] = {}

    def installed(package: str) -> Site:
        if package not in sites:
            sites[package] = Site(tmp_path_factory.mktemp(package), package)
        return sites[package]

    return installed
