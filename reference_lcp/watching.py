"""Who watches how far a search is: whoever waits for it, and a time limit, which ends it by an exception."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

Watcher = Callable[[str, int, int], None]
"""Is told what is being done, how many periods of it are done, and how many there are at most."""

_WATCHER: ContextVar[Watcher | None] = ContextVar("watcher", default=None)


@contextmanager
def watched(watcher: Watcher) -> Iterator[None]:
    """Let a watcher be told how far searches are, here and in what is called from here."""
    token = _WATCHER.set(watcher)
    try:
        yield
    finally:
        _WATCHER.reset(token)


def tell(what: str = "", done: int = 0, most: int = 0) -> None:
    """Tell whoever watches how far a search is, or, without words, that it goes on."""
    watcher = _WATCHER.get()
    if watcher is not None:
        watcher(what, done, most)
