"""A time limit that loops ask for, and what says that a proof ends without one."""

import math
import time


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
