"""A time limit that loops ask for, what says that a proof ends without one, and who watches how far a search is."""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

Watcher = Callable[[str, int, int], None]
"""Is told what is being done, how many periods of it are done, and how many there are at most."""

_WATCHER: ContextVar[Watcher | None] = ContextVar("watcher", default=None)


class NotProven(Exception):
    """Nothing is claimed; the message says which step fails."""


class Deadline:
    """A time limit that every loop of a proof, and of the search before it, asks for."""

    def __init__(self, seconds: float):
        self.seconds = seconds
        self._began = time.monotonic()

    @property
    def elapsed(self) -> float:
        """Seconds since the start."""
        return time.monotonic() - self._began

    def check(self) -> None:
        """Raise `NotProven` once the time is over."""
        if self.elapsed > self.seconds:
            raise NotProven(f"the time limit of {self.seconds:g} s is over")


UNLIMITED = Deadline(math.inf)
"""As long as it takes."""


@contextmanager
def watched(watcher: Watcher) -> Iterator[None]:
    """Let a watcher be told how far searches are, here and in what is called from here."""
    token = _WATCHER.set(watcher)
    try:
        yield
    finally:
        _WATCHER.reset(token)


def tell(what: str, done: int, most: int) -> None:
    """Tell whoever watches how far a search is."""
    watcher = _WATCHER.get()
    if watcher is not None:
        watcher(what, done, most)
