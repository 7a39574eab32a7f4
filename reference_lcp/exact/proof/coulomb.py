"""That Coulomb's law holds between events: signs of polynomials on intervals, proven in Bernstein form.

Each stretch is cut into parts, on which z is a polynomial with a remainder. A contact that slips in the direction s has
s ġ > 0; one that sticks F − λ > 0 and F + λ > 0. At an event such a polynomial vanishes by the equations that have been
proven, and its power is divided out: the second where a contact leaves a stick (ġ = 0, and since λ is continuous there
g̈ = 0), the first where it turns round, where a slip ends, and for the bound by which a stick leaves. What is left has
to be positive, also at the event.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import comb
from typing import NoReturn

import numpy as np
from flint import arb, arb_mat, arb_poly, ctx, fmpq

from reference_lcp.errors import NotProven
from reference_lcp.exact.proof.dynamics import Dynamics, Row, Rows, around_zero
from reference_lcp.exact.proof.krawczyk import Solution, boundaries, state_at_start
from reference_lcp.watching import tell

BERNSTEIN = 20
"""Degree of the Bernstein form; what is above goes into a ball."""

MOST_HALVINGS = 40
"""Halvings of a part before a sign counts as undecided."""

ROOTS_OF = 30
"""Coefficients of a polynomial whose roots say where a repair begins."""

Polynomial = list[arb]


class Violation(NotProven):
    """Coulomb's law is proven not to hold: the order of events is wrong."""

    def __init__(self, message: str, test: "Test", stretch: int, interval: tuple[float, float]):
        super().__init__(message)
        self.test, self.stretch, self.interval = test, stretch, interval


@dataclass(frozen=True)
class Test:
    """An inequality of one contact over one stretch."""

    cell: int
    side: int
    """Direction of a slip; of a stick, the sign of the force whose bound is meant."""
    slips: bool
    row: Row
    """What is positive, as a row times z."""
    orders: tuple[int, int]
    """Orders of the exact zeros at start and end of the stretch."""

    __test__ = False

    def __str__(self) -> str:
        what = "slip" if self.slips else "stick"
        return f"{what} of cell {self.cell + 1}"


@dataclass(frozen=True)
class Part:
    """A part of a stretch: polynomials in s on [0, 1], s = (t − origin) / step."""

    origin: float
    step: arb
    """Negative in the last part, which begins at the end of its stretch."""
    tests: list[Polynomial]
    """What is to be positive, without the exact zeros."""
    signals: list[Polynomial]
    """u of the last outer mass, sin ωt and cos ωt."""


def observe(dynamics: Dynamics, solution: Solution) -> tuple[arb, arb]:
    """Prove every inequality of Coulomb's law, or raise `NotProven`.

    Gives what is integrated on the way: the displacement of the last outer mass times sin ωt, and times cos ωt.
    """
    check_order(dynamics, solution)
    sine, cosine = arb(0), arb(0)
    for j in range(len(solution.ends)):
        tests = list(_tests(dynamics, solution, j))
        parts = list(_parts(dynamics, solution, j, tests))
        for part in parts:
            tell()
            for place, (test, sign) in enumerate(zip(tests, signs(part.tests), strict=True)):
                if sign is not True:
                    _refuse(test, place, j, parts, violated=sign is False)
            u, *waves = map(arb_poly, part.signals)
            integrals = [abs(part.step) * (u * wave).integral()(arb(1)) for wave in waves]
            sine, cosine = sine + integrals[0], cosine + integrals[1]
    return sine, cosine


def check_order(dynamics: Dynamics, solution: Solution) -> None:
    """Events must follow each other, and the modes at the end be those of the start, or their opposites."""
    modes, times = solution.candidate.modes, boundaries(dynamics, solution.candidate)
    for place, (earlier, later) in enumerate(pairwise(times)):
        if not earlier < later:
            if later < earlier:
                raise OutOfOrder(f"events {place} and {place + 1} are in the wrong order", place)
            raise NotProven(
                f"events {place} and {place + 1} happen at one instant, to {float((later - earlier).rad()):.1g}"
            )
    if any(modes[-1][i] != dynamics.sign * modes[0][i] for i in dynamics.rubbing):
        raise NotProven("the modes at the end are not those at the start")


class OutOfOrder(NotProven):
    """Two events are proven to be in the other order."""

    def __init__(self, message: str, place: int):
        super().__init__(message)
        self.place = place


def begin(dynamics: Dynamics, solution: Solution, stretch: int) -> Rows:
    """Enclose z at the start of a stretch, rows of one entry."""
    if stretch:
        return solution.ends[stretch - 1]
    return state_at_start(dynamics, solution.candidate)


def _tests(dynamics: Dynamics, solution: Solution, stretch: int) -> Iterator[Test]:
    """Give the inequalities of a stretch; contacts without friction have none."""
    modes, events, n = solution.candidate.modes, solution.candidate.events, dynamics.cells
    begun, began = (events[stretch - 1][0], modes[stretch - 1]) if stretch else (None, modes[0])
    ended, new = events[stretch] if stretch < len(events) else (None, 0)
    for cell in dynamics.rubbing:
        mode = modes[stretch][cell]
        if mode:
            row = dynamics.zero()
            row[3 * n + cell] = arb(mode)
            start = 0 if begun != cell else 2 if began[cell] == 0 else 1
            yield Test(cell, mode, True, row, (start, int(ended == cell)))
            continue
        for side in (1, -1):
            leaves = int(ended == cell and new == -side)
            yield Test(cell, side, False, dynamics.distance(cell, side), (0, leaves))


def _parts(dynamics: Dynamics, solution: Solution, stretch: int, tests: list[Test]) -> Iterator[Part]:
    """Give the polynomials of all parts of a stretch; the last part is followed back from its end."""
    pattern, flow = dynamics.pattern(solution.candidate.modes[stretch]), solution.flows[stretch]
    start, end = begin(dynamics, solution, stretch), solution.ends[stretch]
    since, until = boundaries(dynamics, solution.candidate)[stretch : stretch + 2]
    back = since + (flow.parts - 1) * flow.step - until
    if not back < 0:
        raise NotProven("a stretch is shorter than the error of its ends")
    rows = [test.row for test in tests] + [_unit(dynamics, k) for k in _signals(dynamics)]
    moving = arb_mat([[row[k] for k in pattern.active] for row in rows])
    sizes = [sum((abs(value) for value in row), arb(0)) for row in moving.tolist()]
    resting = set(range(dynamics.size)) - set(pattern.active)
    constants = [sum((row[k] * start[k][0] for k in resting), arb(0)) for row in rows]
    for states, step, last in (
        (flow.starts(pattern.moving(start)), flow.step, False),
        (pattern.moving(end), back, True),
    ):
        coefficients, left = pattern.series(states, step)
        values = [(moving * each).tolist() for each in coefficients]
        for column in range(states.ncols()):
            polynomials = [[value[k][column] for value in values] for k in range(len(rows))]
            for polynomial, constant, size in zip(polynomials, constants, sizes, strict=True):
                polynomial[0] += constant
                polynomial[-1] += around_zero(size * left)
            orders = [test.orders[1] if last else 0 if column else test.orders[0] for test in tests]
            positive = [polynomial[order:] for polynomial, order in zip(polynomials, orders, strict=False)]
            origin = until if last else since + column * step
            yield Part(float(origin.mid()), step, positive, polynomials[len(tests) :])


def _signals(dynamics: Dynamics) -> tuple[int, int, int]:
    """Places of the last outer mass's displacement, of sin ωt and of cos ωt."""
    return dynamics.cells - 1, dynamics.sine, dynamics.sine + 1


def _unit(dynamics: Dynamics, place: int) -> Row:
    row = dynamics.zero()
    row[place] = arb(1)
    return row


@lru_cache(maxsize=4)
def _to_bernstein(precision: int) -> arb_mat:  # noqa: ARG001, balls are those of the precision
    degrees = range(BERNSTEIN + 1)
    rows = [[arb(fmpq(comb(j, i), comb(BERNSTEIN, i))) if i <= j else arb(0) for i in degrees] for j in degrees]
    return arb_mat(rows)


def signs(polynomials: list[Polynomial], depth: int = 0) -> list[bool | None]:
    """Whether polynomials are proven positive on [0, 1], or negative somewhere; ``None`` if undecided."""
    if not polynomials:
        return []
    body = [[*polynomial[:BERNSTEIN], *[arb(0)] * (BERNSTEIN - len(polynomial))] for polynomial in polynomials]
    for row, polynomial in zip(body, polynomials, strict=True):
        row.append(around_zero(sum((abs(value) for value in polynomial[BERNSTEIN:]), arb(0))))
    values = (_to_bernstein(ctx.prec) * arb_mat(body).transpose()).transpose().tolist()
    return [
        True if all(value > 0 for value in row) else _halved(polynomial, depth)
        for row, polynomial in zip(values, polynomials, strict=True)
    ]


def _halved(polynomial: Polynomial, depth: int) -> bool | None:
    """Give the same for one polynomial, from both halves of the interval."""
    whole = arb_poly(polynomial)
    if whole(arb(0)) < 0 or whole(arb(1)) < 0:
        return False
    if depth == MOST_HALVINGS:
        return None
    for start in (0, 1):
        half = whole(arb_poly([arb(start) / 2, arb(1) / 2]))
        (sign,) = signs([[half[k] for k in range(len(polynomial))]], depth + 1)
        if sign is not True:
            return sign
    return True


def _refuse(test: Test, place: int, stretch: int, parts: list[Part], *, violated: bool) -> NoReturn:
    """Raise what an inequality that is not proven stands for."""
    where = f"{test}, stretch {stretch + 1}, direction {test.side:+d}"
    if not violated:
        raise NotProven(f"Coulomb's law is undecided: {where}")
    raise Violation(f"Coulomb's law is violated: {where}", test, stretch, _negative(parts, place))


def _negative(parts: list[Part], place: int) -> tuple[float, float]:
    """Give about where the inequality of this place is violated first, from the roots of its polynomials."""
    pieces: list[tuple[float, float, bool]] = []
    cuts: list[float] = []
    for part in parts:
        coefficients = np.array([float(value.mid()) for value in part.tests[place][:ROOTS_OF]])
        step = float(part.step.mid())
        roots = np.roots(coefficients[::-1])
        inside = roots[(np.abs(roots.imag) < 1e-12) & (roots.real > 0) & (roots.real < 1)].real
        borders = sorted([0.0, *inside.tolist(), 1.0])
        for low, high in pairwise(borders):
            negative = np.polynomial.polynomial.polyval((low + high) / 2, coefficients) < 0
            first, last = sorted((part.origin + step * low, part.origin + step * high))
            pieces.append((first, last, bool(negative)))
    for low, high, negative in sorted(pieces):
        if not negative:
            if cuts:
                break
            continue
        cuts += [low, high]
    return (min(cuts), max(cuts)) if cuts else (parts[0].origin, parts[0].origin)
