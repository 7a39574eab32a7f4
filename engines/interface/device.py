"""Where the worlds of an engine are: on the processor, or on a graphics card to time a step there.

Results are the processor's alone: nothing that is kept is computed on a card.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

PROCESSOR, CARD = "cpu", "cuda"
"""Names of devices, as Warp has them."""

_chosen = ContextVar("device", default=PROCESSOR)


def chosen_device() -> str:
    """Give the device on which worlds are to be made."""
    return _chosen.get()


@contextmanager
def on_device(name: str) -> Iterator[None]:
    """Make worlds on this device meanwhile."""
    token = _chosen.set(name)
    try:
        yield
    finally:
        _chosen.reset(token)
