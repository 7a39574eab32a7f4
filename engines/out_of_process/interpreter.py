"""Which Python an engine lives in, the one child that runs it there, and what to do where it is missing."""

import functools
import os
import shutil
from dataclasses import dataclass
from pathlib import Path

from engines.out_of_process.process import EngineProcess, EngineProcessError

START_LIMIT = 60.0
"""Seconds that a child may take to start and to import its engine, on a machine that is busy."""

SYSTEM_PYTHON = "/usr/bin/python3"
"""Where distributions keep the Python that their packages are for; a virtual environment's own comes first in PATH."""


@dataclass(frozen=True)
class Installation:
    """An engine that lives in another Python.

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
        """The Python that is asked for, as a path or as a command."""
        return os.environ.get(self.variable) or SYSTEM_PYTHON

    def process(self) -> EngineProcess:
        """Give the child that all lanes of this engine share."""
        return _process(self, self.interpreter)

    def versions(self) -> dict[str, str]:
        """Give versions as the server states them; the engine's own is under ``"engine"``.

        Raises
        ------
        EngineProcessError
            If the engine cannot be used.
        """
        return dict(_versions(self, self.interpreter))

    def unavailable_reason(self) -> str | None:
        """Say why the engine cannot be used, and what to do; ``None`` if it can. Each Python is tried once."""
        try:
            self.versions()
        except EngineProcessError as problem:
            return f"{problem}; {self.remedy}, or let {self.variable} name a Python that has it"
        return None


@functools.cache
def _process(engine: Installation, interpreter: str) -> EngineProcess:
    found = shutil.which(interpreter)
    return EngineProcess(engine.name, found or interpreter, engine.server)


_answers: dict[tuple[Installation, str], dict[str, str] | str] = {}
"""What each Python said when it was asked for versions: these, or the reason why it has none."""


def _versions(engine: Installation, interpreter: str) -> dict[str, str]:
    key = (engine, interpreter)
    if key not in _answers:
        try:
            answer = _process(engine, interpreter).request("versions", START_LIMIT)
            _answers[key] = {name: str(value) for name, value in answer.items()}
        except EngineProcessError as problem:
            _answers[key] = str(problem)
    answer_or_reason = _answers[key]
    if isinstance(answer_or_reason, str):
        raise EngineProcessError(answer_or_reason)
    return answer_or_reason
