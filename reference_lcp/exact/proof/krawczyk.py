"""That the equations of a steady state have one solution, by Krawczyk's test.

Unknowns y: the state at t0, and the times of the events. Equations, for z_j = exp(A_j (τ_j − τ_{j−1})) z_{j−1}:

- where a slip of cell i ends, ġ_i(z_j) = 0;
- where a stick ends in the direction s, F_i + s λ_i = 0;
- x(t0 + L) = ± x(t0), with minus for half a period.

With Y an approximate inverse and J(B) an enclosure of the Jacobian on a box B, x ↦ x − Y F(x) has the Lipschitz
constant κ = ‖1 − Y J(B)‖ on B in the largest norm. If κ < 1, a ball of radius ρ about ỹ lies in B, and
‖Y F(ỹ)‖ + κ ρ <= ρ, then that ball holds exactly one solution (Banach), which is within ‖Y F(ỹ)‖ / (1 − κ) of ỹ.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from flint import arb, arb_mat, ctx

from reference_lcp.errors import NotProven
from reference_lcp.exact.proof.candidate import Candidate
from reference_lcp.exact.proof.dynamics import Dynamics, Flow, Row, Rows, around_zero, identity, largest
from reference_lcp.watching import tell

RADII = (1e-10, 1e-14, 1e-19, 1e-24, 1e-30)
"""Radii of the box on which the Jacobian is enclosed: the first is far above the error of floating point."""

MOST_JACOBIANS = 25
"""Most Jacobians of Newton's method; from floating point one suffices, near a grazing it takes some."""

MOST_STEPS = 12
"""Most steps with one Jacobian."""

CONTRACTION = 0.5
"""Largest κ that is taken: the solution is then within twice ‖Y F(ỹ)‖."""

SHRINKS = 0.1
"""Part of the step before below which a step of Newton's method counts as progress."""

SPARE_BITS = 30
"""Bits beyond those of the unknowns with which is computed: balls grow by some 1e8 over a period."""

ILL_CONDITIONED = 1e9
"""Condition number from which on an inverse is computed in balls."""


@dataclass(frozen=True)
class Solution:
    """The one solution near a candidate: enclosures."""

    candidate: Candidate
    """Its numbers are balls."""
    radius: float
    """Of all of them."""
    ends: list[Rows]
    """z at the end of each stretch, rows of one entry."""
    jacobian: arb_mat
    """Of the equations: those of events first, columns of the state first."""
    flows: list[Flow]


class Equations:
    """The equations of one candidate."""

    def __init__(self, dynamics: Dynamics, candidate: Candidate):
        self.dynamics, self.candidate = dynamics, candidate
        self.unknown, self.events = candidate.unknown, candidate.events
        self.patterns = [dynamics.pattern(modes) for modes in candidate.modes]
        self.rows = [self._row(place) for place in range(len(self.events))]

    def _row(self, place: int) -> Row:
        """Give the row that vanishes at an event."""
        (cell, new), modes = self.events[place], self.candidate.modes[place]
        if modes[cell] == 0:
            return self.dynamics.distance(cell, -new)
        row = self.dynamics.zero()
        row[3 * self.dynamics.cells + cell] = arb(1)
        return row

    def durations(self, y: list[arb]) -> list[arb]:
        """Lengths of all stretches."""
        times = boundaries(self.dynamics, self.candidate.moved_to(y))
        return [later - earlier for earlier, later in pairwise(times)]

    def flows(self, y: list[arb]) -> list[Flow]:
        """Exponentials of all stretches of these times."""
        flows = []
        for pattern, time in zip(self.patterns, self.durations(y), strict=True):
            tell()
            flows.append(Flow(pattern, time.mid()))
        return flows

    def shoot(self, y: list[arb], flows: list[Flow], *, gradients: bool = False) -> tuple[Rows, list[Rows]]:
        """Residuals, and z at the end of each stretch; with `gradients` each row goes on with its derivatives by y."""
        begin, size = state_at_start(self.dynamics, self.candidate.moved_to(y)), len(self.unknown)
        rows = begin
        if gradients:
            width = len(y)
            rows = [[*row, *[arb(0)] * width] for row in rows]
            for column, k in enumerate(self.unknown):
                rows[k][1 + column] = arb(1)
        residuals, ends = [], []
        for j, (flow, time) in enumerate(zip(flows, self.durations(y), strict=True)):
            tell()
            rows = flow.advanced(rows, time)
            if gradients:
                self._move_ends(rows, j, size)
            ends.append(rows)
            if j < len(self.events):
                residuals.append(_product(self.rows[j], rows))
        sign = self.dynamics.sign
        for column, k in enumerate(self.unknown):
            closing = list(rows[k])
            closing[0] -= sign * begin[k][0]
            if gradients:
                closing[1 + column] -= sign
            residuals.append(closing)
        return residuals, ends

    def _move_ends(self, rows: Rows, place: int, size: int) -> None:
        """Add what later ends of a stretch do, in place, and take away what later starts do."""
        pattern = self.patterns[place]
        rates = (pattern.rates * arb_mat([[rows[k][0]] for k in pattern.active])).entries()
        for k, rate in zip(pattern.active, rates, strict=True):
            if place < len(self.events):
                rows[k][1 + size + place] += rate
            if place:
                rows[k][size + place] -= rate


def boundaries(dynamics: Dynamics, candidate: Candidate) -> list[arb]:
    """Give the times at which stretches begin and end."""
    start = arb(candidate.start)
    return [start, *map(arb, candidate.times), start + dynamics.length]


def state_at_start(dynamics: Dynamics, candidate: Candidate) -> Rows:
    """Give z at t0, rows of one entry."""
    return [[arb(value)] for value in (*candidate.state, *dynamics.given(arb(candidate.start)))]


def _product(row: Row, rows: Rows) -> Row:
    """Row times matrix; most entries of the row are zero."""
    entries = [(value, rows[k]) for k, value in enumerate(row) if value != 0]
    total = [entries[0][0] * value for value in entries[0][1]]
    for factor, other in entries[1:]:
        total = [a + factor * b for a, b in zip(total, other, strict=True)]
    return total


def solve(dynamics: Dynamics, candidate: Candidate) -> Solution:
    """Prove that there is one solution near a candidate; raises `NotProven`."""
    equations = Equations(dynamics, candidate)
    values = [candidate.state[k] for k in equations.unknown] + list(candidate.times)
    y, radii, goal = [arb(value).mid() for value in values], list(RADII), arb(2) ** -(ctx.prec - SPARE_BITS)
    for _ in range(MOST_JACOBIANS):
        flows = equations.flows(y)
        box = [value + arb(0, radii[0]) for value in y]
        residuals, ends = equations.shoot(box, flows, gradients=True)
        jacobian = arb_mat([row[1:] for row in residuals])
        inverse = _inverse(jacobian)
        nearer, step, points = _newton(equations, y, flows, inverse, goal)
        distance = largest([abs(a - b) for a, b in zip(nearer, y, strict=True)])
        kappa = _norm(identity(len(y)) - inverse * jacobian)
        if kappa < CONTRACTION and distance + 2 * step < radii[0]:
            return _enclosed(equations, (nearer, points), step / (1 - kappa), ends, jacobian, flows)
        if not kappa < CONTRACTION and distance < radii[0]:
            if len(radii) == 1:
                raise NotProven(f"Krawczyk's test fails: |1 - YJ| <= {float(kappa):.2g} on a box of {radii[0]:g}")
            radii = radii[1:]
        y = nearer
    raise NotProven("Newton's method does not settle")


def _newton(
    equations: Equations, y: list[arb], flows: list[Flow], inverse: arb_mat, goal: arb
) -> tuple[list[arb], arb, list[Rows]]:
    """Take steps with one inverse while they become smaller, until they are below the goal.

    Gives where they end, an upper bound of ‖Y F(y)‖ there, and z at the ends of all stretches.
    """
    previous = arb("inf")
    for step in range(MOST_STEPS):
        residuals, ends = equations.shoot(y, flows)
        steps = (inverse * arb_mat(residuals)).entries()
        size = largest([abs(change) for change in steps])
        if not size.is_finite():
            raise NotProven("Newton's method leaves all bounds")
        if size < goal or not size < SHRINKS * previous or step == MOST_STEPS - 1:
            break
        y = [(value - change).mid() for value, change in zip(y, steps, strict=True)]
        previous = size
    return y, size, ends


def _enclosed(
    equations: Equations,
    found: tuple[list[arb], list[Rows]],
    error: arb,
    widest: list[Rows],
    jacobian: arb_mat,
    flows: list[Flow],
) -> Solution:
    """Enclose the solution, and z at the ends of all stretches by the mean value theorem."""
    (middle, points), spread = found, around_zero(error)
    ends = []
    for point, wide in zip(points, widest, strict=True):
        sizes = [sum((abs(entry) for entry in row[1:]), arb(0)) for row in wide]
        ends.append([[row[0] + spread * size] for row, size in zip(point, sizes, strict=True)])
    y = [value + spread for value in middle]
    return Solution(equations.candidate.moved_to(y), float(error.upper()), ends, jacobian, flows)


def _inverse(jacobian: arb_mat) -> arb_mat:
    """Approximate inverse of the mid-point; nothing is proven of it."""
    try:
        middle = np.array([[float(entry.mid()) for entry in row] for row in jacobian.tolist()])
        if np.linalg.cond(middle) < ILL_CONDITIONED:
            return arb_mat(np.linalg.inv(middle).tolist())
        return jacobian.mid().inv().mid()
    except (ZeroDivisionError, np.linalg.LinAlgError):
        raise NotProven(
            "the equations are singular: two events at one instant, or a motion that is not isolated"
        ) from None


def _norm(matrix: arb_mat) -> arb:
    """Upper bound of the largest row sum."""
    return largest([sum((abs(entry) for entry in row), arb(0)) for row in matrix.tolist()])
