"""How a worker prepares an engine and its law, such as letting them compile: once, and within limits of their own."""

from collections.abc import Callable
from typing import NamedTuple

from engines.interface.engine import Engine
from engines.interface.law_engine import law_of
from engines.interface.preparation import sample_lane
from engines.interface.registry import engine
from engines.interface.variant import Variant
from reference_lcp.chain.trajectory import State
from scenarios.execution.computation.failures import reason_of

KEPT_SECONDS = 5.0
"""What an engine has to load what it has kept, without a word to the user: MuJoCo Warp takes 2 s."""


LAW_LIMIT = 300.0
"""Seconds in which a law is compiled: Exudyn's takes 8 s of a processor, and ten times as much where it is busy."""


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

    def __init__(self, within: Callable[[Preparing, Callable[[], object]], None]):
        self._within = within
        self._ended: dict[tuple[Variant, int], str | None] = {}

    def problem(self, variant: Variant, cells: int) -> str | None:
        """Prepare a variant for chains of this length, unless that was done; gives the reason if it fails.

        One that is not there needs none.
        """
        own = engine(variant.engine)
        if own.unavailable_reason() is not None:
            return None
        if (variant, cells) not in self._ended:
            self._ended[variant, cells] = self._prepared(own, variant, cells)
            self._compile_law(own, variant, cells)
        return self._ended[variant, cells]

    def _prepared(self, own: Engine, variant: Variant, cells: int) -> str | None:
        """Do what the engine names; gives the reason if it fails."""
        if own.preparation is None:
            return None
        beginning = Preparing(f"{own.capabilities.title} {own.preparation.what}", own.preparation.limit)
        return self._attempt(beginning, lambda: own.prepare(cells, variant.formulation, variant.preset_name))

    def _compile_law(self, own: Engine, variant: Variant, cells: int) -> None:
        """Let the model of a law take a step; what fails here fails in its tasks too, with their reasons."""
        law = law_of(variant.preset)
        if law is not None:
            lane, beginning = (
                sample_lane(cells),
                Preparing(f"the law of {own.capabilities.title} is compiled", LAW_LIMIT),
            )
            self._attempt(beginning, lambda: law.build([lane]).advance(State.at_rest(1, cells), 0, 1))

    def _attempt(self, beginning: Preparing, prepare: Callable[[], object]) -> str | None:
        try:
            self._within(beginning, prepare)
        except BaseException as problem:  # an engine may raise anything, and end the program
            return f"{beginning.what}: {reason_of(problem)}"
        return None
