"""uv, which finds versions of packages and installs them: how it is called, and its errors as one line."""

import shutil
import subprocess
from collections.abc import Mapping
from types import MappingProxyType

from reference_lcp.refusal import ParameterError

PROBLEMS: Mapping[str, str] = MappingProxyType({
    "No space left on device": "the disk is full",
    "No interpreter found": "there is no such Python on this machine",
    "Failed to inspect Python": "that Python does not start",
    "No solution found": "there is no such version for this Python and this machine",
    "were not found in the package registry": "there is no such package",
    "Failed to fetch": "the package index cannot be reached",
    "error sending request": "the package index cannot be reached",
    "Network connectivity is disabled": "the package index cannot be reached",
    "Failed to build": "there is no wheel for this Python and this machine, and it cannot be built",
})  # fmt: skip
"""What a phrase in uv's errors means; of several, the first one counts."""


def run_uv(*arguments: str, given: str = "") -> str:
    """Run uv, and give what it prints.

    Parameters
    ----------
    arguments
        Its command and options; it heeds its own variables of the environment and its own files beside.
    given
        What it reads from standard input.

    Raises
    ------
    ParameterError
        If it is missing or fails; the message says what that means.
    """
    try:
        done = subprocess.run(
            [_uv(), "--no-progress", "--no-python-downloads", *arguments],
            input=given, capture_output=True, text=True, check=False,
        )  # fmt: skip
    except OSError as problem:
        raise ParameterError(f"uv cannot be started: {problem}") from None
    if done.returncode != 0:
        raise ParameterError(_explained(done.stderr))
    return done.stdout.strip()


def _uv() -> str:
    """Find uv: the one that pip has installed beside the suite, or else the system's."""
    try:
        from uv import find_uv_bin

        return find_uv_bin()
    except (ImportError, FileNotFoundError):
        command = shutil.which("uv")
    if command is None:
        raise ParameterError("environments are made by uv, which is not installed; pip install uv")
    return command


def _explained(errors: str) -> str:
    """Say in one line what has gone wrong, with uv's own words."""
    said, _, error = errors.partition("error: ")
    words = " ".join((error or said).replace("cause: ", "").split())
    meanings = [meaning for phrase, meaning in PROBLEMS.items() if phrase in words]
    return f"{meanings[0]} ({words})" if meanings else f"uv failed: {words}"
