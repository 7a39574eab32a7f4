"""A connection to Bullet, and the import of its package."""

import contextlib
import functools
import importlib
import os
import sys
from collections.abc import Iterator
from typing import Any


class Connection:
    """A connection to Bullet, opened on first use: opening one takes longer than a period of the chain."""

    def __init__(self) -> None:
        """Start without a connection."""
        self._client: int | None = None

    @property
    def client(self) -> int:
        """Number of the connection."""
        if self._client is None:
            bullet = import_pybullet()
            self._client = int(bullet.connect(bullet.DIRECT))
            if self._client < 0:
                raise RuntimeError("PyBullet opens no further world; close simulations that are no longer used")
        return self._client

    def native_steps(self, steps: int) -> None:
        """Take steps and do nothing else."""
        step, client = import_pybullet().stepSimulation, self.client
        for _ in range(steps):
            step(physicsClientId=client)

    def close(self) -> None:
        """Close the connection; the next use opens another."""
        if self._client is not None:
            import_pybullet().disconnect(self._client)
            self._client = None

    def __del__(self) -> None:
        if not sys.is_finalizing():
            self.close()


@functools.cache
def import_pybullet() -> Any:
    """Import PyBullet, which reports its build time to the standard error stream when it is loaded."""
    with _silent_standard_error():
        return importlib.import_module("pybullet")


@contextlib.contextmanager
def _silent_standard_error() -> Iterator[None]:
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
