"""Programs in a Python of their own, where every warning is an error."""

import os
import subprocess
import sys
from pathlib import Path


def python_in(folder: Path, program: str) -> "subprocess.CompletedProcess[str]":
    """Run a program that finds the tests, in this folder; gives what it wrote and how it ended."""
    path = os.pathsep.join(filter(None, [str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH")]))
    return subprocess.run(
        [sys.executable, "-B", "-W", "error", "-c", program], cwd=folder, env={**os.environ, "PYTHONPATH": path},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
