"""The chain between two events as a linear system in ball arithmetic, and its exponential with a proven remainder.

With g = v − u, z = (u, g, u̇, ġ, sin ωt, cos ωt, 1, sin(Ωt + φ), cos(Ωt + φ)), the last two only where normal forces
change. While the modes s of the contacts last, ż = A z:

- a contact that slips: λ = −s F(t), m_o ü = p_o − λ, m_i v̈ = p_i + λ;
- one that sticks: ü = v̈ = (p_o + p_i) / (m_o + m_i), and λ = m_i v̈ − p_i is a row times z.

g and ġ of contacts that stick do not change, and are no rows of A.
"""

from fractions import Fraction
from functools import cached_property

from flint import arb, arb_mat, ctx, fmpq

from reference_lcp.errors import NotProven
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.watching import tell

Row = list[arb]
Rows = list[Row]
Modes = tuple[int, ...]
"""−1 backward slip, 0 stick, 1 forward slip, one a cell."""

REACH = 4.0
"""Largest ‖A‖ h of a part of a stretch: its series has some 45 terms at 128 bits."""

LARGEST_REACH = 1e4
"""Largest ‖A‖ t of a stretch that is tried: 2,500 parts."""

MOST_TERMS = 2000
"""Most terms of a series; numbers that are not finite would otherwise ask for more and more."""


def ball(value: Fraction) -> arb:
    """Give a rational number at the working precision."""
    return arb(fmpq(value.numerator, value.denominator))


def around_zero(radius: arb) -> arb:
    """Give the ball of this radius, an upper bound, about zero."""
    return arb(0, radius.upper())


class Dynamics:
    """Matrices of a chain for every pattern of modes, at the working precision at which it is made."""

    def __init__(self, exact: ExactChain):
        n = exact.cells
        self.exact, self.cells = exact, n
        self.sine, self.one = 4 * n, 4 * n + 2
        self.size = 4 * n + (3 if exact.modulation is None else 5)
        self.omega = ball(exact.frequency_squared).sqrt()
        self.length = arb.pi() / self.omega * (1 if exact.half else 2 * exact.cycle)
        """Length of the map whose fixed point is searched: half a period, or the cycle of drive and normal force."""
        self.sign = -1 if exact.half else 1
        self.friction = [ball(bound) for bound in exact.friction]
        self.rubbing = [i for i, bound in enumerate(exact.friction) if bound]
        self._inner_mass = [ball(mass) for mass in exact.inner_mass]
        self._outer_mass = [ball(mass) for mass in exact.outer_mass]
        self._patterns: dict[Modes, Pattern] = {}

    def zero(self) -> Row:
        """Give a row of zeros."""
        return [arb(0)] * self.size

    def given(self, time: arb) -> list[arb]:
        """Entries of z that time alone determines."""
        phase = self.omega * time
        values = [phase.sin(), phase.cos(), arb(1)]
        if self.exact.modulation is not None:
            pressed = self.exact.modulation
            phase = phase * ball(pressed.multiple) + ball(pressed.phase)
            values += [phase.sin(), phase.cos()]
        return values

    @cached_property
    def forces(self) -> tuple[Rows, Rows]:
        """Rows that give p_o and p_i, the forces on outer and inner masses but for friction."""
        exact, n = self.exact, self.cells
        springs, inner_springs = list(map(ball, exact.chain_stiffness)), list(map(ball, exact.inner_stiffness))
        dashpots = [ball(square).sqrt() for square in exact.chain_damping_squared]
        inner_dashpots = [ball(square).sqrt() for square in exact.inner_damping_squared]
        outer, inner = [self.zero() for _ in range(n)], [self.zero() for _ in range(n)]
        for i, (k, c) in enumerate(zip(springs, dashpots, strict=True)):
            for place, factor in ((i, k), (2 * n + i, c)):  # the spring at the left of the cell, and its dashpot
                outer[i][place] -= factor
                if i:
                    outer[i][place - 1] += factor
                    outer[i - 1][place - 1] -= factor
                    outer[i - 1][place] += factor
            for place, factor in ((n + i, inner_springs[i]), (3 * n + i, inner_dashpots[i])):
                outer[i][place] += factor
                inner[i][place] -= factor
        outer[0][self.sine] += springs[0]  # times the displacement scale, one
        if exact.moving_base:
            outer[0][self.sine + 1] += dashpots[0] * self.omega
        return outer, inner

    def bound(self, cell: int) -> Row:
        """Give the row of the bound F(t) of a contact."""
        row = self.zero()
        row[self.one] = self.friction[cell]
        if self.exact.modulation is not None:
            row[self.one + 1] = self.friction[cell] * ball(self.exact.modulation.depth)
        return row

    @cached_property
    def held(self) -> Rows:
        """Rows that give the force λ which keeps each contact at rest."""
        rows = []
        for i, (p_o, p_i) in enumerate(zip(*self.forces, strict=True)):
            share = self._inner_mass[i] / (self._outer_mass[i] + self._inner_mass[i])
            rows.append([share * (a + b) - b for a, b in zip(p_o, p_i, strict=True)])
        return rows

    def distance(self, cell: int, side: int) -> Row:
        """Row that gives F − `side` λ of a contact at rest: zero where it leaves in the direction −`side`."""
        return [bound - side * force for bound, force in zip(self.bound(cell), self.held[cell], strict=True)]

    def pattern(self, modes: Modes) -> "Pattern":
        """Give the matrices of these modes."""
        if modes not in self._patterns:
            self._patterns[modes] = Pattern(self, modes)
        return self._patterns[modes]

    def accelerations(self, modes: Modes) -> tuple[Rows, Rows]:
        """Give the rows of ü and of g̈."""
        outer, relative = [], []
        for i, (p_o, p_i) in enumerate(zip(*self.forces, strict=True)):
            m_o, m_i = self._outer_mass[i], self._inner_mass[i]
            if modes[i] == 0:
                outer.append([(a + b) / (m_o + m_i) for a, b in zip(p_o, p_i, strict=True)])
                relative.append(self.zero())
                continue
            friction = [modes[i] * bound for bound in self.bound(i)]
            u = [(a + f) / m_o for a, f in zip(p_o, friction, strict=True)]
            v = [(b - f) / m_i for b, f in zip(p_i, friction, strict=True)]
            outer.append(u)
            relative.append([b - a for a, b in zip(u, v, strict=True)])
        return outer, relative


class Pattern:
    """A of ż = A z for one set of modes, of the entries that move."""

    def __init__(self, dynamics: Dynamics, modes: Modes):
        n, size = dynamics.cells, dynamics.size
        at_rest = {start + i for i, mode in enumerate(modes) if mode == 0 for start in (n, 3 * n)}
        self.active = [k for k in range(size) if k not in at_rest]
        rows = [dynamics.zero() for _ in range(size)]
        for i in range(2 * n):
            rows[i][2 * n + i] = arb(1)
        rows[2 * n : 3 * n], rows[3 * n : 4 * n] = dynamics.accelerations(modes)
        waves = [(dynamics.sine, dynamics.omega)]
        if dynamics.exact.modulation is not None:
            waves.append((dynamics.one + 1, dynamics.omega * ball(dynamics.exact.modulation.multiple)))
        for place, frequency in waves:
            rows[place][place + 1], rows[place + 1][place] = frequency, -frequency
        self.rates = arb_mat([[rows[r][c] for c in self.active] for r in self.active])
        self.norm = largest([sum((abs(rows[r][c]) for c in self.active), arb(0)) for r in self.active])
        """Upper bound of |A| in the largest norm."""

    def reach(self, time: arb) -> arb:
        """Upper bound of ‖A t‖; raises `NotProven` where it is beyond what is tried."""
        reach = (self.norm * abs(time)).upper()
        if not reach < LARGEST_REACH:
            raise NotProven("a stretch is too long for its series")
        return reach

    def parts(self, time: arb) -> int:
        """Into how many parts a stretch is cut: two at least, one from each end."""
        return max(2, int(float(self.reach(time)) / REACH) + 1)

    def moving(self, rows: Rows) -> arb_mat:
        """Give the rows of the entries that move."""
        return arb_mat([rows[k] for k in self.active])

    def with_moved(self, rows: Rows, moved: arb_mat) -> Rows:
        """Put rows of the entries that move back among those that rest."""
        rows = list(rows)
        for k, row in zip(self.active, moved.tolist(), strict=True):
            rows[k] = row
        return rows

    def series(self, start: arb_mat, time: arb) -> tuple[list[arb_mat], arb]:
        """Coefficients of exp(A t s) Z in powers of s, and a bound for 0 <= s <= 1 of what is left out, over s^k.

        k is the last power. The series ends where what is left out is below the working precision.
        """
        reach, size = self.reach(time), largest([abs(value) for value in start.entries()])
        coefficients, left, k = [start], size, 0
        while not (2 * reach < k and left < size * arb(2) ** -ctx.prec):
            k += 1
            tell()
            coefficients.append((self.rates * coefficients[-1]) * (time / k))
            left = (left * reach / k).upper()
            if not size > 0:
                break
            if k > MOST_TERMS:
                raise NotProven("a series does not end")
        # The tail after k is at most left · q/(k+1) · (1 + 1/2 + 1/4 + …) <= left, with q = reach < k/2.
        return coefficients, left

    def carried(self, start: arb_mat, time: arb) -> arb_mat:
        """Enclose exp(A t) Z."""
        coefficients, left = self.series(start, time)
        total = sum(coefficients[1:], coefficients[0])
        rows, columns = total.nrows(), total.ncols()
        return total + arb_mat(rows, columns, [around_zero(left)] * (rows * columns))


class Flow:
    """exp(A h) of a part of a stretch, and what follows from it for the whole one."""

    def __init__(self, pattern: Pattern, time: arb):
        self.pattern, self.time = pattern, time
        self.parts = pattern.parts(time)
        self.step = (time / self.parts).mid()
        size = len(pattern.active)
        self.powers = [pattern.carried(identity(size), self.step)]
        """exp(A h) to the powers 1, 2, 4, …"""

    def power(self, place: int) -> arb_mat:
        """Give exp(A h) to the power 2^`place`."""
        while len(self.powers) <= place:
            self.powers.append(self.powers[-1] * self.powers[-1])
        return self.powers[place]

    @cached_property
    def whole(self) -> arb_mat:
        """exp(A h) to the power of the number of parts."""
        factors = [self.power(place) for place in range(self.parts.bit_length()) if self.parts >> place & 1]
        product = factors[0]
        for factor in factors[1:]:
            product = product * factor
        return product

    def advanced(self, rows: Rows, time: arb) -> Rows:
        """Enclose exp(A t) Z for a time near that of the flow."""
        moving = self.pattern.moving(rows)
        moved = self.whole * self.pattern.carried(moving, time - self.step * self.parts)
        return self.pattern.with_moved(rows, moved)

    def starts(self, start: arb_mat) -> arb_mat:
        """Give z at the starts of all parts but the last, one a column."""
        columns, place = start.transpose().tolist(), 0
        while len(columns) < self.parts - 1:
            following = self.power(place) * arb_mat(columns).transpose()
            columns += following.transpose().tolist()
            place += 1
        return arb_mat(columns[: self.parts - 1]).transpose()


def identity(size: int) -> arb_mat:
    """Give the unit matrix."""
    return arb_mat(size, size, [int(row == column) for row in range(size) for column in range(size)])


def largest(values: list[arb]) -> arb:
    """Upper bound of balls that are not negative."""
    bound = arb(0)
    for value in values:
        bound = arb.max(bound, value.upper())
    return bound
