"""Orders of events that are wrong on purpose, and proofs of them without repair."""

import dataclasses
from collections.abc import Iterable
from functools import cache

from flint import ctx

from reference_lcp import NotProven
from reference_lcp.exact.proof.candidate import Candidate, candidate
from reference_lcp.exact.proof.coulomb import observe
from reference_lcp.exact.proof.dynamics import Dynamics
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.exact.proof.krawczyk import Solution, solve
from reference_lcp.exact.proof.repair import listed

BITS = 128
Event = tuple[float, int, int]
"""Time, cell and new mode."""

POINTS = (("0.3", "0.6"), ("0.1", "0.95"), ("1", "0.95"))


def unrepaired(exact: ExactChain, guess: Candidate) -> Solution:
    """Prove this order of events, or raise `NotProven`."""
    with ctx.workprec(BITS):
        dynamics = Dynamics(exact)
        solution = solve(dynamics, guess)
        observe(dynamics, solution)
        return solution


def refused(exact: ExactChain, guess: Candidate) -> bool:
    try:
        unrepaired(exact, guess)
    except NotProven:
        return True
    return False


@cache
def point(friction: str, frequency: str) -> tuple[ExactChain, Candidate]:
    """The canonical chain, and the right order of its events."""
    exact = ExactChain.from_ratios(friction_ratio=friction, frequency_ratio=frequency)
    return exact, candidate(exact)


def with_events(guess: Candidate, kept: list[Event], first: tuple[int, ...] | None = None) -> Candidate:
    events, times = tuple((cell, new) for _, cell, new in kept), tuple(time for time, _, _ in kept)
    return dataclasses.replace(guess, events=events, times=times, first=first or guess.first)


def swapped(guess: Candidate) -> list[Candidate]:
    """Neighbouring events of different cells in the other order."""
    events = listed(guess)
    pairs = [k for k in range(len(events) - 1) if events[k][1] != events[k + 1][1]]
    return [with_events(guess, [*events[:k], events[k + 1], events[k], *events[k + 2 :]]) for k in pairs]


def without_sticks(guess: Candidate) -> list[Candidate]:
    """A slip that goes on where it stops for a while, or turns round at once."""
    events, wrong = listed(guess), []
    for k, (time, cell, new) in enumerate(events):
        following = next((event for event in events[k + 1 :] if event[1] == cell), None)
        if new == 0 and following is not None:
            rest = [event for event in events if event is not events[k] and event is not following]
            turned = [] if following[2] == guess.modes[k][cell] else [(time, cell, following[2])]
            wrong.append(with_events(guess, sorted([*rest, *turned])))
    return wrong


def always(mode: int, guess: Candidate, cells: Iterable[int]) -> list[Candidate]:
    """Each of these cells in one mode all the time."""
    return [
        with_events(
            guess,
            [event for event in listed(guess) if event[1] != cell],
            tuple(mode if k == cell else other for k, other in enumerate(guess.first)),
        )
        for cell in sorted(cells)
    ]


def wrong_orders(kind: str) -> list[tuple[ExactChain, Candidate]]:
    """All wrong orders of one kind."""
    return [(exact, wrong) for exact, guess in (point(*each) for each in POINTS) for wrong in WRONG[kind](guess)]


WRONG = {
    "events swapped": swapped,
    "a stick left out, or a reversal instead of it": without_sticks,
    "a slipping cell declared stuck": lambda guess: always(0, guess, {cell for cell, _ in guess.events}),
    "a stuck cell declared slipping": lambda guess: always(1, guess, guess.always_stuck),
}
