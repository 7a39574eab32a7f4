"""Compiled code that reports what nobody has asked for."""

import contextlib
import os
import sys
from collections.abc import Iterator


@contextlib.contextmanager
def silent_standard_error() -> Iterator[None]:
    """Send what compiled code writes to file descriptor 2 nowhere."""
    sys.stderr.flush()
    original = os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(original, 2)
        os.close(nowhere)
        os.close(original)
