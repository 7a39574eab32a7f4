"""What Linux lets a process say of itself and of its children; elsewhere nothing is said."""

import ctypes
from contextlib import suppress
from typing import Any

SET_PARENT_DEATH_SIGNAL, SET_NAME, SET_CHILD_SUBREAPER = 1, 15, 36
"""A signal at the end of the parent; a name, which children inherit; whether orphans become its children."""


def prctl(option: int, value: Any) -> None:
    """Set an option."""
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)
