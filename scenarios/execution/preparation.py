"""How a worker prepares an engine, such as letting it compile: once, and within a limit of its own."""

from collections.abc import Callable
from typing import NamedTuple

from engines.interface.registry import engine
from engines.interface.variant import Variant
from scenarios.execution.failures import reason_of

KEPT_SECONDS = 5.0
"""What an engine has to load what it has kept, without a word to the user: MuJoCo Warp takes 2 s."""


class Preparing(NamedTuple):
    """Message of a worker that begins to prepare an engine: from then on its limit counts."""

    what: str
    """What the engine does, such as ``MuJoCo Warp compiles its kernels``."""
    limit: float
    """Seconds that it may take."""

    @property
    def notice(self) -> str:
        """What the user is told where it takes longer than `KEPT_SECONDS`."""
        return f"{self.what}: at most {self.limit:g} s; what is made is kept for later runs"


class Preparations:
    """The engines that this process has prepared, and why others could not be.

    Parameters
    ----------
    within
        Calls a function within the limit of the preparation that is given with it.
    """

    def __init__(self, within: Callable[[Preparing, Callable[[], None]], None]):
        self._within = within
        self._ended: dict[tuple[Variant, int], str | None] = {}

    def problem(self, variant: Variant, cells: int) -> str | None:
        """Prepare a variant for chains of this length, unless that was done; gives the reason if it fails.

        One whose engine names no preparation, or is not there, needs none.
        """
        own = engine(variant.engine)
        if own.preparation is None or own.unavailable_reason() is not None:
            return None
        if (variant, cells) not in self._ended:
            beginning = Preparing(f"{own.capabilities.title} {own.preparation.what}", own.preparation.limit)
            self._ended[variant, cells] = self._attempt(beginning, variant, cells)
        return self._ended[variant, cells]

    def _attempt(self, beginning: Preparing, variant: Variant, cells: int) -> str | None:
        own = engine(variant.engine)
        try:
            self._within(beginning, lambda: own.prepare(cells, variant.formulation, variant.preset_name))
        except BaseException as problem:  # an engine may raise anything, and end the program
            return f"{beginning.what}: {reason_of(problem)}"
        return None
