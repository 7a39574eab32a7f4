"""Another order of events where the one before is proven wrong: contacts that slip or stick for an instant, or do not.

Near a grazing a sticking force passes its bound for a moment, or a slip comes to rest for one: events are missing.
Where there is no such moment, events are too many: they would happen in the wrong order.
"""

import dataclasses

from reference_lcp.exact.proof.candidate import Candidate, Number
from reference_lcp.exact.proof.coulomb import OutOfOrder, Violation

SHORT_SLIP = 1.5
"""Length of a short slip over the time for which the force would pass its bound: with an excess like 1 − τ² on (−1, 1),
ġ begins at τ = −1 and is zero again at τ = 2."""

SHORT_REVERSAL = 2.0
"""The same where a stick would begin beyond its bound: the excess falls linearly, and ġ like a parabola comes back."""

SHORTEST_PHASE = 0.02
"""Part of the map's length below which a slip or a stick is dropped where the equations with it have no solution."""

Timed = tuple[float, int, int]
"""Time, cell and new mode."""


def repaired(candidate: Candidate, problem: Violation | OutOfOrder, end: float) -> Candidate:
    """Propose another order of events, up to the time `end`; raises the problem where there is none."""
    events = listed(candidate)
    if isinstance(problem, OutOfOrder):
        events = _reordered(candidate, events, problem)
    else:
        borders = [candidate.start, *(time for time, _, _ in events), end]
        events = _corrected(candidate, events, problem, (borders[problem.stretch], borders[problem.stretch + 1]))
    if any(not candidate.start < time < end for time, _, _ in events):
        raise problem
    return _with_events(candidate, sorted(events))


def without_shortest(candidate: Candidate, length: float) -> Candidate | None:
    """Propose an order without the shortest slip or stick, if one is so short that it may not happen at all."""
    events, shortest, pair = listed(candidate), SHORTEST_PHASE * length, None
    for place, first in enumerate(events):
        second = next((event for event in events[place + 1 :] if event[1] == first[1]), None)
        if second is None or second[2] != candidate.modes[place][first[1]] or second[0] - first[0] > shortest:
            continue
        shortest, pair = second[0] - first[0], (first, second)
    if pair is None:
        return None
    return _with_events(candidate, [event for event in events if event not in pair])


def listed(candidate: Candidate) -> list[Timed]:
    """Give the events with their times."""
    return [(_number(time), cell, new) for time, (cell, new) in zip(candidate.times, candidate.events, strict=True)]


def _with_events(candidate: Candidate, events: list[Timed]) -> Candidate:
    return dataclasses.replace(
        candidate,
        events=tuple((cell, new) for _, cell, new in events),
        times=tuple(time for time, _, _ in events),
    )


def _number(value: Number) -> float:
    return float(value if isinstance(value, float) else value.mid())


def _reordered(candidate: Candidate, events: list[Timed], problem: OutOfOrder) -> list[Timed]:
    """Drop a stick or a slip that would end before it begins; exchange events of different contacts."""
    late = problem.place
    if not 0 < late < len(events):
        raise problem
    first, second = events[late - 1], events[late]
    if first[1] != second[1]:
        return events  # sorted by time they are in the other order
    before, cell, time = candidate.modes[late - 1][first[1]], first[1], (first[0] + second[0]) / 2
    rest = events[: late - 1] + events[late + 1 :]
    return rest if second[2] == before else [*rest, (time, cell, second[2])]


def _corrected(
    candidate: Candidate, events: list[Timed], problem: Violation, stretch: tuple[float, float]
) -> list[Timed]:
    """Insert, move or remove events of the contact whose inequality is violated."""
    cell, (low, high) = problem.test.cell, problem.interval
    begins, ends = (abs(a - b) <= 1e-9 * (stretch[1] - stretch[0]) for a, b in ((low, stretch[0]), (high, stretch[1])))
    own = problem.stretch > 0 and events[problem.stretch - 1][1] == cell
    following = next((event for event in events[problem.stretch :] if event[1] == cell), None)
    if begins and own:
        return _begun_wrongly(candidate, events, problem, following, lasts=ends)
    if problem.test.slips:
        if ends and following is not None:
            return [*_without(events, following), (low, cell, following[2])]
        return [*events, (low, cell, 0), ((low + high) / 2, cell, problem.test.side)]
    if ends and following is not None and following[2] == -problem.test.side:
        return [*_without(events, following), (low, cell, following[2])]
    return [*events, (low, cell, -problem.test.side), (low + SHORT_SLIP * (high - low), cell, 0)]


def _begun_wrongly(
    candidate: Candidate, events: list[Timed], problem: Violation, following: Timed | None, *, lasts: bool
) -> list[Timed]:
    """Mend a mode that is wrong from its first instant on, for a while or as long as it `lasts`."""
    begun, cell = events[problem.stretch - 1], problem.test.cell
    before = candidate.modes[problem.stretch - 1][cell]
    rest = _without(events, begun)
    if problem.test.slips:
        if before:  # it rests for a while before it turns round
            return [*rest, (begun[0], cell, 0), (sum(problem.interval) / 2, cell, problem.test.side)]
        if following is None or following[2] != 0:
            raise problem
        return _without(rest, following)  # it does not leave its stick
    new = -problem.test.side
    if not lasts and new != before:  # it turns round for a while before it rests
        return [*rest, (begun[0], cell, new), (begun[0] + SHORT_REVERSAL * (problem.interval[1] - begun[0]), cell, 0)]
    if following is not None and following[2] == new:
        rest = _without(rest, following)
    return rest if new == before else [*rest, (begun[0], cell, new)]


def _without(events: list[Timed], one: Timed) -> list[Timed]:
    return [event for event in events if event is not one]
