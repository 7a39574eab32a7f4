"""Orders of events that are wrong on purpose, and proofs of them without repair."""

import dataclasses
from functools import cache

from flint import ctx

from reference_lcp.errors import NotProven
from reference_lcp.exact.proof.candidate import Candidate, candidate
from reference_lcp.exact.proof.coulomb import Observed, observe
from reference_lcp.exact.proof.dynamics import Dynamics
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.exact.proof.krawczyk import Solution, solve

BITS = 128
POINTS = (("0.3", "0.6"), ("0.1", "0.95"), ("1", "0.95"))


def unrepaired(exact: ExactChain, guess: Candidate) -> tuple[Solution, Observed]:
    """Prove this order of events, or raise `NotProven`."""
    with ctx.workprec(BITS):
        dynamics = Dynamics(exact)
        solution = solve(dynamics, guess)
        return solution, observe(dynamics, solution)


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


def with_events(
    guess: Candidate, kept: list[tuple[float, int, int]], first: tuple[int, ...] | None = None
) -> Candidate:
    events = tuple((cell, new) for _, cell, new in kept)
    times = tuple(time for time, _, _ in kept)
    return dataclasses.replace(guess, events=events, times=times, first=first or guess.first)


def listed(guess: Candidate) -> list[tuple[float, int, int]]:
    return [(time, cell, new) for time, (cell, new) in zip(guess.times, guess.events, strict=True)]


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


def slipping_declared_stuck(guess: Candidate) -> list[Candidate]:
    wrong = []
    for cell in sorted({cell for cell, _ in guess.events}):
        first = tuple(0 if k == cell else mode for k, mode in enumerate(guess.first))
        wrong.append(with_events(guess, [event for event in listed(guess) if event[1] != cell], first))
    return wrong


def stuck_declared_slipping(guess: Candidate) -> list[Candidate]:
    wrong = []
    for cell in sorted(guess.always_stuck):
        first = tuple(1 if k == cell else mode for k, mode in enumerate(guess.first))
        wrong.append(with_events(guess, listed(guess), first))
    return wrong


def wrong_orders(kind: str) -> list[tuple[ExactChain, Candidate]]:
    """All wrong orders of one kind."""
    return [(exact, wrong) for exact, guess in (point(*each) for each in POINTS) for wrong in WRONG[kind](guess)]


WRONG = {
    "events swapped": swapped,
    "a stick left out, or a reversal instead of it": without_sticks,
    "a slipping cell declared stuck": slipping_declared_stuck,
    "a stuck cell declared slipping": stuck_declared_slipping,
}
