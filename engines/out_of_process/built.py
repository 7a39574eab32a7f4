"""What a worker process has built: it is built on first use, and again by a fresh worker."""

import weakref
from collections.abc import Callable
from typing import Any

from engines.out_of_process.process import EngineProcess
from engines.out_of_process.worker import Message

REQUEST_LIMIT = 60.0
"""Seconds that any request may take, on a machine that is busy."""

STEP_LIMIT = 0.02
"""Seconds that a step of a lane may take beside; a hundred times what one of the slowest engine here does."""


class Built:
    """A lane, or a simulation, of a server.

    Parameters
    ----------
    process
        The worker process.
    parameters
        What it is built of.
    limit
        Seconds that building may take.
    """

    def __init__(self, process: EngineProcess, parameters: Message, limit: float = REQUEST_LIMIT):
        self._process = process
        self._parameters = parameters
        self._limit = limit
        self._generation = 0
        self._release: Callable[[], object] = int
        self.number = -1
        """By which the worker knows it."""

    def request(self, request: str, limit: float, /, **values: Any) -> Message:
        """Send a request that concerns it; see `EngineProcess.request`."""
        self._ensure_built()
        return self._process.request(request, limit, number=self.number, **values)

    def close(self) -> None:
        """Let the worker drop it; another use builds it again."""
        self._release()
        self._generation = 0

    def _ensure_built(self) -> None:
        """Build it unless the worker that runs has it."""
        if self._generation == self._process.generation and self._process.alive():
            return
        self._release()
        self.number = self._process.new_number()
        self._process.request("build", self._limit, number=self.number, **self._parameters)
        self._generation = self._process.generation
        self._release = weakref.finalize(self, self._process.release, self.number)
