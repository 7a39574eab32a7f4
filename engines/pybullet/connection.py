"""A connection to Bullet, and the import of its package."""

import functools
import importlib
import sys
from typing import Any

from engines.shared.silence import silent_standard_error


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
    with silent_standard_error():
        return importlib.import_module("pybullet")
