"""Packages of engines that tests install, and processes that see them."""

import contextlib
import importlib
import os
import subprocess
import sys
from collections.abc import Iterator
from multiprocessing import forkserver
from pathlib import Path
from unittest.mock import patch

from multibody_xval.engines.interface import registry

ROOT = Path(__file__).parents[1]


class Site:
    """A folder into which a package of `tests` is installed, as pip does it."""

    def __init__(self, folder: Path, package: str):
        install = "-m pip install --quiet --no-deps --no-index --no-build-isolation --disable-pip-version-check"
        command = [sys.executable, *install.split(), "--target", str(folder), str(ROOT / "tests" / package)]
        subprocess.run(command, check=True)
        self._folder = str(folder)
        self.environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), str(ROOT)])}

    def run(self, *arguments: str, code: int = 0) -> str:
        """Run a module of Python; gives what it prints, with its errors where it is to fail."""
        done = subprocess.run(
            [sys.executable, *arguments], env=self.environment, cwd=ROOT, capture_output=True, text=True, check=False
        )
        assert done.returncode == code, done.stdout + done.stderr
        return done.stdout + done.stderr if code else done.stdout

    @contextlib.contextmanager
    def visible(self) -> Iterator[None]:
        """Let this process, and those that it starts, see its engines."""
        with patch.dict(os.environ, self.environment), patch.object(sys, "path", [self._folder, *sys.path]):
            importlib.invalidate_caches()
            forget()
            try:
                yield
            finally:
                forget()


def forget() -> None:
    """Forget which engines there are, and end the process that forks workers: it sees those of its own start."""
    registry._entry_points.cache_clear()
    if sys.platform == "linux":
        forkserver._forkserver._stop()  # type: ignore[attr-defined]
