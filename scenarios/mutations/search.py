"""The smallest error of every mutant that a gate detects, by bisection over its sizes, all mutants together."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from engines.interface.variant import Variant
from engines.mutants.mutant import Mutant
from scenarios.mutations.gates import Gate


@dataclass(frozen=True)
class Detection:
    """What a gate detects of a mutant.

    Parameters
    ----------
    smallest
        The smallest of its sizes that the gate detects; ``None`` for none of them.
    twin_caught
        The gate stops the mutant without its error too: it can say nothing of it then.
    """

    smallest: float | None
    twin_caught: bool = False


class _Bisection:
    """The search of one mutant: sizes up to `low` are caught, those from `high` on are not."""

    def __init__(self, mutant: Mutant):
        self.mutant, self.low, self.high = mutant, -1, len(mutant.sizes)

    @property
    def open(self) -> bool:
        return self.high - self.low > 1

    @property
    def middle(self) -> int:
        return (self.low + self.high) // 2

    @property
    def tried(self) -> Variant:
        return self.mutant.variant(self.mutant.sizes[self.middle])

    def narrow(self, caught: bool) -> None:
        if caught:
            self.low = self.middle
        else:
            self.high = self.middle

    @property
    def detection(self) -> Detection:
        return Detection(None if self.low < 0 else self.mutant.sizes[self.low])


def detections(gate: Gate, mutants: Sequence[Mutant], done: Callable[[], None] = lambda: None) -> list[Detection]:
    """Give what a gate detects of every mutant.

    That a larger error is caught wherever a smaller one is, is taken for granted.

    Parameters
    ----------
    gate
        The gate.
    mutants
        The mutants.
    done
        Called after every round, of `rounds`.
    """
    twins = gate.caught([mutant.variant(0) for mutant in mutants])
    done()
    searches = [_Bisection(mutant) for mutant in mutants]
    said = [search for search in searches if search.mutant.variant(0) not in twins]
    while tried := [search for search in said if search.open]:
        caught = gate.caught([search.tried for search in tried])
        done()
        for search in tried:
            search.narrow(search.tried in caught)
    return [
        search.detection if search.mutant.variant(0) not in twins else Detection(None, twin_caught=True)
        for search in searches
    ]


def rounds(mutants: Sequence[Mutant]) -> int:
    """Give how often `detections` asks a gate at most: for the twins, and once a halving."""
    return 1 + max((len(mutant.sizes).bit_length() for mutant in mutants), default=0)
