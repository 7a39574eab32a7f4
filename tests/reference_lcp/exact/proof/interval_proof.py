"""A second proof of a steady state, which shares nothing with the first.

Intervals of mpmath instead of balls of FLINT; the state (u, v, u̇, v̇, sin ωt, cos ωt, 1) over a whole period instead
of relative motion over half of one; small steps of a Taylor series, whose variational equation gives the Jacobian;
signs by the range of Taylor polynomials on small intervals. Only Krawczyk's theorem and what is to be proven are the
same. The chain is uniform: unit masses and springs, a base of unit amplitude.
"""

from dataclasses import dataclass
from math import factorial

import numpy as np
from mpmath import iv
from scipy.linalg import expm

iv.dps = 60
DEGREE = 42
"""Of Taylor series over a step with ‖A‖ h < 1: what is left out is below 1e-50."""

EITHER_SIGN = iv.mpf([-1, 1])
HALF = iv.mpf(1) / 2

BOX = iv.mpf(10) ** -32
"""Radius of the box of Krawczyk's test: steps widen it by some 1e20 over a period."""


@dataclass
class Orbit:
    """What is to be proven: modes at t = 0, (cell, new mode) of each event, and numbers near the solution."""

    first: tuple
    events: list
    times: list
    state: list
    friction: object
    frequency: object
    damping: object

    @property
    def cells(self):
        return len(self.first)

    @property
    def modes(self):
        modes = [list(self.first)]
        for cell, new in self.events:
            modes.append([*modes[-1]])
            modes[-1][cell] = new
        return modes


class Rates:
    """Sparse rows {column: number} of ż = A z, and of the force λ that keeps each contact at rest."""

    def __init__(self, orbit, modes):
        n, c = orbit.cells, 2 * orbit.damping
        one, outer, inner = 4 * n + 2, [], []
        for i in range(n):
            force = {4 * n: iv.mpf(1), 4 * n + 1: c * orbit.frequency} if i == 0 else {}
            for other, sign in ((i, -1), (i - 1, 1), (i, -1 if i + 1 < n else 0), (i + 1, 1 if i + 1 < n else 0)):
                if 0 <= other < n and sign:
                    force[other] = force.get(other, 0) + sign * iv.mpf(1)
                    force[2 * n + other] = force.get(2 * n + other, 0) + sign * c
            force[i] = force.get(i, 0) - 1
            force[n + i] = iv.mpf(1)
            outer.append(force)
            inner.append({i: iv.mpf(1), n + i: iv.mpf(-1)})
        self.rows, self.held = [{2 * n + k: iv.mpf(1)} for k in range(2 * n)] + [{} for _ in range(2 * n)], []
        for i, mode in enumerate(modes):
            places = set(outer[i]) | set(inner[i])
            mean = {k: (outer[i].get(k, 0) + inner[i].get(k, 0)) / iv.mpf(2) for k in places}
            self.held.append({k: mean[k] - inner[i].get(k, 0) for k in places})
            a, b = dict(mean), dict(mean)
            if mode:
                a, b = dict(outer[i]), dict(inner[i])
                a[one] = a.get(one, 0) + mode * orbit.friction
                b[one] = b.get(one, 0) - mode * orbit.friction
            self.rows[2 * n + i], self.rows[3 * n + i] = a, b
        self.rows += [{4 * n + 1: orbit.frequency}, {4 * n: -orbit.frequency}, {}]
        self.norm = max(1.000001 * float(sum(abs(x) for x in row.values()).b) for row in self.rows if row)

    def times(self, vector):
        return [sum((x * vector[k] for k, x in row.items()), iv.mpf(0)) for row in self.rows]

    def series(self, vector, h):
        """Taylor coefficients over the step h, the last with the remainder."""
        coefficients = [vector]
        for k in range(1, DEGREE + 1):
            coefficients.append([x * h / k for x in self.times(coefficients[-1])])
        size, q = max(abs(x).b for x in vector), self.norm * abs(h).b
        left = 2 * size * q ** (DEGREE + 1) / factorial(DEGREE + 1)
        coefficients[-1] = [x + left * EITHER_SIGN for x in coefficients[-1]]
        return coefficients


def row_times(row, vector):
    return sum((x * vector[k] for k, x in row.items()), iv.mpf(0))


class Equations:
    """Residuals F(y) of y = (unknown entries of x(0), times of events)."""

    def __init__(self, orbit):
        n, self.orbit = orbit.cells, orbit
        self.rates = [Rates(orbit, modes) for modes in orbit.modes]
        self.period = 2 * iv.pi / orbit.frequency
        at_rest = [k for k, mode in enumerate(orbit.first) if mode == 0]
        never = [k for k in at_rest if k not in {cell for cell, _ in orbit.events}]
        # v and v̇ of a contact that rests at t = 0 follow from u̇, v of one that never slips from u too.
        self.unknown = [k for k in range(4 * n) if k not in {n + k for k in never} | {3 * n + k for k in at_rest}]
        self.follows = {n + k: k for k in never} | {3 * n + k: 2 * n + k for k in at_rest}

    def start(self, y):
        n = self.orbit.cells
        z = [iv.mpf(0)] * (4 * n) + [iv.mpf(0), iv.mpf(1), iv.mpf(1)]
        for k, value in zip(self.unknown, y, strict=False):
            z[k] = iv.mpf(value)
        for k, other in self.follows.items():
            z[k] = z[other]
        return z

    def boundaries(self, y):
        return [iv.mpf(0), *y[len(self.unknown) :], self.period]

    def condition(self, j):
        """Row and constant of what vanishes at event j."""
        (cell, new), n = self.orbit.events[j], self.orbit.cells
        if self.orbit.modes[j][cell]:
            return {3 * n + cell: iv.mpf(1), 2 * n + cell: iv.mpf(-1)}, iv.mpf(0)
        return self.rates[j].held[cell], new * self.orbit.friction

    def steps(self, j, duration):
        return int(self.rates[j].norm * float(duration.b) / 0.9) + 1

    def shoot(self, y, gradients=False):
        """Residuals, z at the ends of stretches, and the Jacobian as columns."""
        times, z, size = self.boundaries(y), self.start(y), len(self.unknown)
        columns = [[iv.mpf(0)] * len(z) for _ in y] if gradients else []
        for column, k in zip(columns, self.unknown, strict=False):
            column[k] = iv.mpf(1)
            for follower, other in self.follows.items():
                column[follower] += int(other == k)
        residuals, gradient, ends = [], [], []
        for j, rates in enumerate(self.rates):
            duration = times[j + 1] - times[j]
            count = self.steps(j, duration)
            for _ in range(count):
                z, *columns = (self.stepped(rates, each, duration / count) for each in (z, *columns))
            if gradients:
                slope = rates.times(z)
                for place, sign in ((size + j, 1), (size + j - 1, -1)):
                    if size <= place < len(y) and (sign > 0 or j):
                        columns[place] = [x + sign * s for x, s in zip(columns[place], slope, strict=True)]
            ends.append(z)
            if j < len(self.orbit.events):
                row, constant = self.condition(j)
                residuals.append(row_times(row, z) + constant)
                gradient.append([row_times(row, column) for column in columns])
        residuals += [z[k] - value for k, value in zip(self.unknown, y, strict=False)]
        gradient += [[column[k] - int(c == r) for c, column in enumerate(columns)] for r, k in enumerate(self.unknown)]
        return residuals, ends, gradient

    @staticmethod
    def stepped(rates, vector, h):
        coefficients = rates.series(vector, h)
        return [sum(each, iv.mpf(0)) for each in zip(*coefficients, strict=True)]


def middle(x):
    return iv.mpf(x.mid)


def floating_jacobian(equations, y):
    """Approximate Jacobian; nothing is proven of it."""
    size, values = len(equations.unknown), [iv.mpf(float(x)) for x in y]
    z = np.array([float(x.mid) for x in equations.start(values)])
    columns = [np.array([float(x.mid) for x in equations.start(unit)]) for unit in np.eye(len(y), size).tolist()]
    still = np.array([float(x.mid) for x in equations.start([0.0] * size)])
    X, rows = np.array(columns).T - still[:, None], []
    times = [float(x.mid) for x in equations.boundaries(values)]
    for j, rates in enumerate(equations.rates):
        A = np.array([dense(row, z.size) for row in rates.rows])
        flow = expm(A * (times[j + 1] - times[j]))
        z, X = flow @ z, flow @ X
        if j < len(equations.orbit.events):
            X[:, size + j] += A @ z
        if j:
            X[:, size + j - 1] -= A @ z
        if j < len(equations.orbit.events):
            rows.append(dense(equations.condition(j)[0], z.size) @ X)
    return np.array(rows + [X[k] - np.eye(len(y))[r] for r, k in enumerate(equations.unknown)])


def dense(row, size):
    return np.array([float(iv.mpf(row.get(k, 0)).mid) for k in range(size)])


def proven_orbit(orbit):
    """Enclose the solution by Krawczyk's test; fails with an AssertionError."""
    equations = Equations(orbit)
    y = [iv.mpf(value) for value in (*(orbit.state[k] for k in equations.unknown), *orbit.times)]
    inverse = [[iv.mpf(x) for x in row] for row in np.linalg.inv(floating_jacobian(equations, y)).tolist()]
    for _ in range(8):
        residual = equations.shoot(y)[0]
        step = [sum((a * middle(b) for a, b in zip(row, residual, strict=True)), iv.mpf(0)) for row in inverse]
        if max(abs(x).b for x in step) < BOX / 1000:
            break
        y = [middle(a - b) for a, b in zip(y, step, strict=True)]
    box = [x + BOX * EITHER_SIGN for x in y]
    _, ends, gradient = equations.shoot(box, gradients=True)
    for place, row in enumerate(inverse):
        image = y[place] - sum((a * b for a, b in zip(row, residual, strict=True)), iv.mpf(0))
        for column in range(len(y)):
            product = sum((a * line[column] for a, line in zip(row, gradient, strict=True)), iv.mpf(0))
            image += (int(column == place) - product) * (box[column] - y[column])
        assert box[place].a < image.a
        assert image.b < box[place].b
    return equations, box, ends


def coulomb(equations, box, ends):
    """Prove Coulomb's law between events, and enclose the transmittance."""
    orbit, times, total = equations.orbit, equations.boundaries(box), [iv.mpf(0), iv.mpf(0)]
    n, modes = orbit.cells, orbit.modes
    assert modes[-1] == modes[0]
    for j, rates in enumerate(equations.rates):
        assert times[j].b < times[j + 1].a
        duration = times[j + 1] - times[j]
        count, z = 4 * equations.steps(j, duration), equations.start(box) if j == 0 else ends[j - 1]
        for part in range(count):
            coefficients = rates.series(z, duration / count)
            for cell, mode in enumerate(modes[j]):
                begun = j > 0 and part == 0 and orbit.events[j - 1][0] == cell
                ended = j < len(orbit.events) and part == count - 1 and orbit.events[j][0] == cell
                if mode:
                    values = [mode * (c[3 * n + cell] - c[2 * n + cell]) for c in coefficients]
                    order = 0 if not begun else 1 if modes[j - 1][cell] else 2
                    assert positive(values, order, ended)
                    continue
                for side in (1, -1):
                    values = [-side * row_times(rates.held[cell], c) for c in coefficients]
                    values[0] += orbit.friction
                    assert positive(values, 0, ended and orbit.events[j][1] == -side)
            for k in range(2):
                total[k] += duration / count * integral(coefficients, n - 1, 4 * n + k)
            z = [sum(each, iv.mpf(0)) for each in zip(*coefficients, strict=True)]
    real, imaginary = (2 * x / equations.period for x in total)
    return 10 * iv.log(real**2 + imaginary**2) / iv.log(10), imaginary / real


def ranged(values, low, high):
    """Range of a polynomial on [low, high], by Horner's scheme from its left end."""
    s, shifted = (high - low) * iv.mpf([0, 1]), values
    for k in range(len(values)):  # Taylor's shift to `low`
        for i in range(len(values) - 2, k - 1, -1):
            shifted = [*shifted[:i], shifted[i] + low * shifted[i + 1], *shifted[i + 1 :]] if low != 0 else shifted
    total = iv.mpf(0)
    for value in reversed(shifted):
        total = total * s + value
    return total


def positive(values, order, falls_to_zero):
    """Whether a polynomial is positive inside (0, 1), with a zero of this order at 0, or a simple one at 1."""
    values = values[order:]  # s^order is positive, and the lower coefficients are zero by the equations
    if falls_to_zero:  # positive before a simple zero at 1 if it falls on all of [1/2, 1]
        slope = [k * value for k, value in enumerate(values)][1:]
        return above_zero([-x for x in slope], HALF, iv.mpf(1)) and above_zero(values, iv.mpf(0), HALF)
    return above_zero(values, iv.mpf(0), iv.mpf(1))


def above_zero(values, low, high, depth=0):
    if ranged(values, low, high).a > 0:
        return True
    if depth == 12:
        return False
    half = (low + high) / 2
    return above_zero(values, low, half, depth + 1) and above_zero(values, half, high, depth + 1)


def integral(coefficients, first, second):
    total = iv.mpf(0)
    for i, a in enumerate(coefficients):
        for k, b in enumerate(coefficients):
            total += a[first] * b[second] / (i + k + 1)
    return total
