"""Stick–slip transitions of one simulation against those of another: which are the same, how far apart, which are not.

The period is cyclic: a transition just after its start and one just before its end are close.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from reference_lcp.validation import checked_scalar

MATCHING_WINDOW = 0.02
"""Largest distance of two matching transitions over the period: eight steps of 400.

Far more than the error of a step or two that the scheme makes, far less than what separates two
transitions of one contact to the same mode in figure 3.
"""

TimedTransition = tuple[int, float, str]
"""Cell from 1, time in the period [s], new mode: as results hold them."""


@dataclass(frozen=True)
class TransitionMatch:
    """How the transitions of one simulation fit to those of another.

    Parameters
    ----------
    pairs
        (observed, expected) transitions that match, by cell and then by time of the expected one.
    missed
        Expected transitions that were not observed.
    spurious
        Observed transitions that were not expected.
    time_errors
        Time of each pair's observed transition less the expected one's, over the period, in
        [−window, window].
    """

    pairs: tuple[tuple[TimedTransition, TimedTransition], ...]
    missed: tuple[TimedTransition, ...]
    spurious: tuple[TimedTransition, ...]
    time_errors: tuple[float, ...]


def match_transitions(
    observed: Sequence[TimedTransition],
    expected: Sequence[TimedTransition],
    period: float,
    window: float = MATCHING_WINDOW,
) -> TransitionMatch:
    """Pair transitions of the same cell to the same mode, one to one, the closest in cyclic time first.

    Parameters
    ----------
    observed, expected
        Transitions of the simulation and of what it is compared with, in any order.
    period
        Length of the cycle [s], > 0.
    window
        Largest distance of a pair over the period, > 0.

    Raises
    ------
    ParameterError
        If `period` or `window` is not > 0.
    """
    checked_scalar("period", period, "> 0")
    checked_scalar("window", window, "> 0")
    partner: dict[int, tuple[int, float]] = {}
    taken: set[int] = set()
    for error, f, e in _candidates(observed, expected, period, window):
        if e not in partner and f not in taken:
            partner[e] = (f, error)
            taken.add(f)
    order = sorted(partner, key=lambda e: expected[e])
    return TransitionMatch(
        pairs=tuple((observed[partner[e][0]], expected[e]) for e in order),
        missed=tuple(transition for e, transition in enumerate(expected) if e not in partner),
        spurious=tuple(transition for f, transition in enumerate(observed) if f not in taken),
        time_errors=tuple(partner[e][1] for e in order),
    )


def _candidates(
    observed: Sequence[TimedTransition], expected: Sequence[TimedTransition], period: float, window: float
) -> list[tuple[float, int, int]]:
    """Pairs that may match as (time error over the period, index observed, index expected), the closest first."""
    of_kind: dict[tuple[int, str], list[tuple[float, int]]] = {}
    for f, (cell, time, kind) in enumerate(observed):
        of_kind.setdefault((cell, kind), []).append((time, f))
    near = []
    for e, (cell, time, kind) in enumerate(expected):
        for other_time, f in of_kind.get((cell, kind), ()):
            error = _cyclic((other_time - time) / period)
            if abs(error) <= window:
                near.append((error, f, e))
    return sorted(near, key=lambda candidate: (abs(candidate[0]), candidate[2], candidate[1]))


def _cyclic(fraction: float) -> float:
    """Shift a fraction of a period into [−1/2, 1/2)."""
    return (fraction + 0.5) % 1.0 - 0.5
