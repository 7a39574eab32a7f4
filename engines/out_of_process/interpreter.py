"""The Python of an engine, the one worker process that runs it there, and what to do where it is missing."""

import functools
import os
import shutil
from dataclasses import dataclass
from pathlib import Path

from engines.out_of_process.process import EngineProcess, EngineProcessError

START_LIMIT = 60.0
"""Seconds that a worker may take to start and to import its engine, on a machine that is busy."""


def system_python() -> str:
    """Give the Python that the packages of a distribution are for; a virtual environment's own comes first in PATH."""
    search = os.pathsep.join([os.defpath, os.environ.get("PATH", "")])
    return shutil.which("python3", path=search) or "python3"


@dataclass(frozen=True)
class Installation:
    """An engine that runs in another Python.

    Parameters
    ----------
    name
        Under which the engine is registered.
    server
        File that serves it there; see `engines.out_of_process.worker`.
    variable
        Environment variable that names its Python; the system's is taken without it.
    remedy
        What to do where it is missing, as the end of a sentence.
    """

    name: str
    server: Path
    variable: str
    remedy: str

    @property
    def interpreter(self) -> str:
        """The Python that is chosen, as a path or as a command."""
        return os.environ.get(self.variable) or system_python()

    def process(self) -> EngineProcess:
        """Give the worker process that all lanes of this engine share."""
        return _process(self, self.interpreter)

    def versions(self) -> dict[str, str]:
        """Give versions as the server states them; the engine's own is under ``"engine"``.

        Raises
        ------
        EngineProcessError
            If the engine cannot be used.
        """
        versions = _versions_or_reason(self, self.interpreter)
        if isinstance(versions, str):
            raise EngineProcessError(versions)
        return dict(versions)

    def unavailable_reason(self) -> str | None:
        """Reason why the engine cannot be used, and what to do; ``None`` if it can. Each Python is tried once."""
        try:
            self.versions()
        except EngineProcessError as problem:
            return f"{problem}; {self.remedy}, or let {self.variable} name a Python that has it"
        return None


@functools.cache
def _process(engine: Installation, interpreter: str) -> EngineProcess:
    return EngineProcess(engine.name, shutil.which(interpreter) or interpreter, engine.server)


@functools.cache
def _versions_or_reason(engine: Installation, interpreter: str) -> dict[str, str] | str:
    """Give the versions, or the reason why the engine cannot be used in this Python."""
    try:
        stated = _process(engine, interpreter).request("versions", START_LIMIT)
    except EngineProcessError as problem:
        return str(problem)
    return {name: str(value) for name, value in stated.items()}
