"""Making environments by uv: what will be installed is said first, and an environment is whole or not there."""

import contextlib
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Self

from engines.isolated.environment import (
    FOLDER_VARIABLE,
    LOCK,
    Environment,
    Record,
    environments_folder,
)
from engines.isolated.process import EngineProcessError, unavailable_reason
from engines.isolated.versioned_engine import Requirement, tried_versions
from reference_lcp.errors import ParameterError

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
    """Run uv, and give what it prints; `given` is what it reads. Its errors say what they mean."""
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


UNPACKED = 4.0
"""Size of installed files over that of their wheels: 3.2 for MuJoCo 3.3.7, and up to 4 for packages of text."""

START_SECONDS, DOWNLOAD_RATE = 3.0, 10e6
"""What the shortest installation takes [s], and what a usual connection brings [B/s]: for what is announced."""


@dataclass(frozen=True)
class Plan:
    """What is to be installed."""

    requirement: Requirement
    interpreter: str
    """Path of the Python that it is made with."""
    packages: dict[str, str]
    """Exact versions, by name."""
    lock: str
    """The same as uv wrote it, with the hash of every file."""
    download: int
    """Size of all wheels [B]; those that uv has kept are not downloaded again."""

    @classmethod
    def of(cls, requirement: Requirement, python: str | None = None) -> Self:
        """Find out what an engine needs; nothing is written."""
        reason = unavailable_reason()
        if reason is not None:
            raise ParameterError(f"{requirement.name} cannot be installed: {reason}")
        interpreter = sys.executable
        try:
            if python is not None:
                interpreter = run_uv("python", "find", "--no-project", "--system", python)
            lock = run_uv(
                "pip", "compile", "--python", interpreter, "--format", "pylock.toml", "--no-annotate", "-",
                given="\n".join(requirement.lines),
            )  # fmt: skip
        except ParameterError as problem:
            own = f"{requirement.name} cannot be installed ({', '.join(requirement.lines)})"
            raise ParameterError(f"{own}: {problem}") from None
        packages = tomllib.loads(lock)["packages"]
        versions = {package["name"]: str(package.get("version", "")) for package in packages}
        download = sum(_smallest_wheel(package) for package in packages)
        return cls(requirement, interpreter, versions, lock, download)

    @property
    def environment(self) -> Environment:
        """The environment."""
        return self.requirement.environment

    @property
    def size(self) -> float:
        """About how much the installed files take [B]."""
        return UNPACKED * self.download

    @property
    def seconds(self) -> float:
        """About how long it takes [s]."""
        return START_SECONDS + self.download / DOWNLOAD_RATE

    def __str__(self) -> str:
        """Say what will be done."""
        packages = ", ".join(f"{name} {version}" for name, version in self.packages.items())
        return (
            f"{self.environment.name}: {packages}; into {self.environment.folder}; about {self.size / 1e6:.0f} MB, "
            f"{self.download / 1e6:.0f} MB of it to download and some {self.seconds:.0f} s, less where uv has kept it"
        )


def _smallest_wheel(package: dict[str, Any]) -> int:
    """Give the size of the wheel that may be taken [B]; 0 where it is not known, as of one on this machine."""
    return min((int(wheel.get("size", 0)) for wheel in package.get("wheels", [])), default=0)


def install(plan: Plan) -> Record:
    """Make the environment: the folder, its packages, a trial of the engine, and then the record that it is whole.

    What was there under its name is removed. Whatever ends it, nothing is left that would be taken for an environment.
    """
    environment, start = plan.environment, time.monotonic()
    with _reserved(environment):
        _check_space(plan)
        _remove(environment)
        try:
            run_uv("venv", "--no-project", "--python", plan.interpreter, str(environment.folder))
            for left in environment.folder.glob("lib/python*/site-packages/_virtualenv.*"):  # by older versions of uv
                left.unlink()
            lock = environment.folder / LOCK
            lock.write_text(plan.lock)
            run_uv("pip", "sync", "--python", str(environment.interpreter), str(lock))
            python = _python_of(plan)
            size = sum(file.lstat().st_size for file in environment.folder.rglob("*"))
            record = Record(python, environment.packages(), round(time.monotonic() - start, 1), round(size / 1e6))
            environment.write_record(record)
        except BaseException as problem:
            _remove(environment)
            if isinstance(problem, OSError):
                reason = problem.strerror or str(problem)
                raise ParameterError(f"{environment.folder} cannot be written: {reason}") from None
            raise
    return record


def remove(environment: Environment) -> None:
    """Remove an environment, whole or not, unless another process is making it."""
    with _reserved(environment):
        _remove(environment)


def _remove(environment: Environment) -> None:
    shutil.rmtree(environment.folder, ignore_errors=True)


def _python_of(plan: Plan) -> str:
    """Try the engine where it has been installed; gives the version of its Python."""
    try:
        return tried_versions(plan.requirement.adapter, plan.environment)["python"]
    except EngineProcessError as problem:
        raise ParameterError(f"{plan.environment.name} was installed and cannot be used: {problem}") from None


def _check_space(plan: Plan) -> None:
    """Refuse an installation for which the disk has no room."""
    free = shutil.disk_usage(environments_folder()).free
    if free < plan.size:
        needed = f"{plan.environment.name} needs about {plan.size / 1e6:.0f} MB"
        raise ParameterError(f"{needed}, and {environments_folder()} has {free / 1e6:.0f} MB left")


@contextlib.contextmanager
def _reserved(environment: Environment) -> Iterator[None]:
    """Let no other process make or remove the same environment meanwhile; a lock ends with its process."""
    from filelock import FileLock, Timeout

    folder = environments_folder()
    lock = FileLock(folder / f".{environment.name}.lock", timeout=0)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock.acquire()
    except Timeout:
        raise ParameterError(f"{environment.name} is being installed or removed by another process") from None
    except OSError as problem:
        raise ParameterError(
            f"{folder} cannot be written: {problem.strerror}; {FOLDER_VARIABLE} names another"
        ) from None
    try:
        yield
    finally:
        lock.release()
