"""The chain as a linear system while every contact keeps its mode, and the series that solves it.

Between two changes of mode the chain is linear. With its state x = (u, v, u̇, v̇) and the drive's (sin ωt, cos ωt) in one
vector z, and the forces p without friction, every mass is accelerated at a rate that depends on which contacts stick:

- a slipping contact: m_o ü = p_o − λ_T, m_i v̈ = p_i + λ_T, with λ_T constant;
- a sticking one: ü = v̈ = (p_o + p_i) / (m_o + m_i), and λ_T = m_i v̈ − p_i.

The solution is taken as its power series over at most one `span`: exact to round-off, also where the system is
defective, and with motion and friction force as polynomials, whose first root can be found with certainty.
"""

import dataclasses
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numba
import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.drives import Drive, HarmonicBase, HarmonicForce, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

SERIES_ORDER = 20
"""Highest power of the series. Over one span the terms fall as k / k!: what is left out is below 1e-17."""

LEFT_OUT = 1e-18
"""Largest size of a term of a propagator, over that of the first, that is left out: a hundredth of round-off."""

WIDTH = 8
"""Columns of a table that are differentiated at once: numbers of float64 in the widest vector register."""

U, V, DU, DV, FRICTION, PULL, LOAD = range(0, 7 * WIDTH, WIDTH)
"""Where a row of a table, one a cell, has u, v, u̇, v̇, λ_T, and the force of the chain element at the left of the cell;
the first row has the load of the drive."""

ROW = 7 * WIDTH

PER_OUTER, PER_INNER, PER_BOTH, INNER_SHARE = range(4)
CHAIN_STIFFNESS, CHAIN_DAMPING, INNER_STIFFNESS, INNER_DAMPING, BOUND = range(4, 9)
"""Columns of `PiecewiseLinearChain.cells`: 1 / m_o, 1 / m_i, 1 / (m_o + m_i), m_i / (m_o + m_i), k_c, c_c, k_i, c_i and
μ λ_N."""


class PiecewiseLinearChain(NamedTuple):
    """Numbers of a chain under a harmonic or still drive, as compiled loops read them."""

    cells: FloatArray
    """One row a cell."""
    load: tuple[float, float]
    """Parts of the force on cell 1 along sin ωt and cos ωt [N]."""
    angular_frequency: float
    """ω of the drive [rad/s]."""
    rate: float
    """Bound on the speed of any motion [1/s]: ω_max + ‖M^-½ C M^-½‖, which no constraint raises, and ω."""
    drive_velocity: float
    """ω times the drive's displacement scale [m/s]."""

    @classmethod
    def of(cls, chain: Chain, drive: Drive) -> Self:
        """Read a chain and its drive."""
        omega, load = harmonic_load(chain, drive)
        weights = 1 / np.sqrt(np.diag(chain.mass_matrix))
        damping = np.linalg.norm(weights[:, None] * chain.damping_matrix * weights, 2)
        rate = max(chain.highest_natural_frequency + float(damping), omega)
        both = chain.outer_mass + chain.inner_mass
        masses = 1 / chain.outer_mass, 1 / chain.inner_mass, 1 / both, chain.inner_mass / both
        springs = chain.chain_stiffness, chain.chain_damping, chain.inner_stiffness, chain.inner_damping
        cells = np.stack([*masses, *springs, chain.friction_bound], axis=1)
        return cls(cells, load, omega, rate, omega * drive.displacement_scale(chain))

    @property
    def span(self) -> float:
        """Time over which one series is used [s]: one over the rate."""
        return 1 / self.rate


_called = numba.njit(cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)


@_called
def _differentiate(cells: Any, modes: Any, table: Any, columns: int, factor: float) -> None:
    """Replace (u, v, u̇, v̇) of every column by `factor` times its rate; λ_T is filled in where contacts stick."""
    for j in range(columns):
        pull = cells[0, CHAIN_STIFFNESS] * table[U + j] + cells[0, CHAIN_DAMPING] * table[DU + j]
        table[PULL + j] = pull - table[LOAD + j]
    for i in range(modes.size):
        here, after = i * ROW, (i + 1) * ROW
        stiffness = cells[i + 1, CHAIN_STIFFNESS] if i + 1 < modes.size else 0.0
        damping = cells[i + 1, CHAIN_DAMPING] if i + 1 < modes.size else 0.0
        inner_stiffness, inner_damping, share = (
            cells[i, INNER_STIFFNESS],
            cells[i, INNER_DAMPING],
            cells[i, INNER_SHARE],
        )
        sticks, per_both = modes[i] == 0, cells[i, PER_BOTH]
        per_outer, per_inner = cells[i, PER_OUTER], cells[i, PER_INNER]
        for j in range(columns):
            u, v, du, dv = table[here + U + j], table[here + V + j], table[here + DU + j], table[here + DV + j]
            following = stiffness * (table[after + U + j] - u) + damping * (table[after + DU + j] - du)
            inner = inner_stiffness * (v - u) + inner_damping * (dv - du)
            row = following - table[here + PULL + j]
            friction = share * row + inner if sticks else table[here + FRICTION + j]
            table[here + U + j] = factor * du
            table[here + V + j] = factor * dv
            table[here + DU + j] = factor * (per_both * row if sticks else per_outer * (row + inner - friction))
            table[here + DV + j] = factor * (per_both * row if sticks else per_inner * (friction - inner))
            table[here + FRICTION + j] = friction
            table[after + PULL + j] = following


@_called
def continue_series(chain: Any, modes: Any, coefficients: Any, friction: Any) -> None:
    """Fill z and λ_T in powers of s = τ / span from z, and the λ_T of slipping contacts, at s = 0."""
    n, omega = modes.size, chain.angular_frequency
    table = np.zeros((n + 1) * ROW)
    for i in range(n):
        table[i * ROW + FRICTION] = friction[0, i]
        for field in range(4):
            table[i * ROW + field * WIDTH] = coefficients[0, field * n + i]
    for k in range(SERIES_ORDER + 1):
        factor, sine, cosine = 1 / (chain.rate * (k + 1)), coefficients[k, 4 * n], coefficients[k, 4 * n + 1]
        table[LOAD] = chain.load[0] * sine + chain.load[1] * cosine
        _differentiate(chain.cells, modes, table, 1, factor)
        for i in range(n):
            friction[k, i], table[i * ROW + FRICTION] = table[i * ROW + FRICTION], 0.0
            if k < SERIES_ORDER:
                for field in range(4):
                    coefficients[k + 1, field * n + i] = table[i * ROW + field * WIDTH]
        if k < SERIES_ORDER:
            coefficients[k + 1, 4 * n], coefficients[k + 1, 4 * n + 1] = factor * omega * cosine, -factor * omega * sine


@_called
def _propagate(chain: Any, modes: Any, duration: float, directions: Any) -> None:
    """Lead small distances in (u, v, u̇, v̇), (m, 4n), through `duration` [s] <= one span, in place."""
    n = modes.size
    for first in range(0, directions.shape[0], WIDTH):
        columns = min(WIDTH, directions.shape[0] - first)
        table, total, size = np.zeros((n + 1) * ROW), np.zeros((n + 1) * ROW), 1.0
        for j in range(columns):
            for field in range(4):
                for i in range(n):
                    table[i * ROW + field * WIDTH + j] = directions[first + j, field * n + i]
        for k in range(1, SERIES_ORDER + 1):
            for place in range(table.size):
                total[place] += table[place]
            _differentiate(chain.cells, modes, table, WIDTH, duration / k)
            size *= duration * chain.rate / k
            if size < LEFT_OUT:
                break
        for j in range(columns):
            for field in range(4):
                for i in range(n):
                    place = i * ROW + field * WIDTH + j
                    directions[first + j, field * n + i] = total[place] + table[place]


@numba.njit(cache=True, error_model="numpy")
def monodromy(chain: Any, duration: Any, coefficients: Any, modes: Any) -> Any:
    """Transposed Jacobian (4n, 4n) of the end of segments to their start; see `exact_orbit.monodromy_matrix`."""
    n = modes.shape[1]
    directions = np.zeros((4 * n, 4 * n))
    for i in range(4 * n):
        directions[i, i] = 1.0
    for i in range(n):
        if modes[0, i] == 0:
            for mass in (2 * n + i, 3 * n + i):
                directions[2 * n + i, mass] = 1 - chain.cells[i, INNER_SHARE]
                directions[3 * n + i, mass] = chain.cells[i, INNER_SHARE]
    for row in range(duration.size):
        for i in range(n):
            if row > 0 and modes[row - 1, i] != 0 and modes[row, i] != modes[row - 1, i]:
                s = duration[row - 1] * chain.rate
                _stop(coefficients[row - 1], s, coefficients[row], 2 * n + i, 3 * n + i, directions)
        _propagate(chain, modes[row], duration[row], directions)
    return directions


@_called
def _stop(before: Any, s: float, after: Any, outer: int, inner: int, directions: Any) -> None:
    """Apply the saltation matrix of a contact that stops or turns round after s spans, in place."""
    outer_rate = inner_rate = 0.0
    for k in range(SERIES_ORDER, 0, -1):
        outer_rate = outer_rate * s + k * before[k, outer]
        inner_rate = inner_rate * s + k * before[k, inner]
    outer_jump = (after[1, outer] - outer_rate) / (inner_rate - outer_rate)
    inner_jump = (after[1, inner] - inner_rate) / (inner_rate - outer_rate)
    for k in range(directions.shape[0]):
        parted = directions[k, inner] - directions[k, outer]
        directions[k, outer] += outer_jump * parted
        directions[k, inner] += inner_jump * parted


def harmonic_load(chain: Chain, drive: Drive) -> tuple[float, tuple[float, float]]:
    """ω [rad/s], and the parts of the force on cell 1 along sin ωt and cos ωt [N]."""
    if isinstance(drive, HarmonicBase):
        stiffness, damping = float(chain.chain_stiffness[0]), float(chain.chain_damping[0])
        omega = drive.angular_frequency
        return omega, (stiffness * drive.amplitude, damping * drive.amplitude * omega)
    if isinstance(drive, HarmonicForce):
        return drive.angular_frequency, (drive.amplitude, 0.0)
    if isinstance(drive, StillBase):
        return 0.0, (0.0, 0.0)
    allowed = "HarmonicBase, HarmonicForce, StillBase"
    raise ParameterError(f"{type(drive).__name__} has no event-driven solution; allowed: {allowed}")


@_called
def evaluate(coefficients: Any, s: float, z: Any) -> None:
    """Read a series in powers of s, (SERIES_ORDER + 1, d), into z by Horner's rule."""
    for place in range(z.size):
        z[place] = 0.0
    for k in range(SERIES_ORDER, -1, -1):
        for place in range(z.size):
            z[place] = z[place] * s + coefficients[k, place]


@numba.njit(cache=True, error_model="numpy")
def values(series: Any, rows: Any, s: Any) -> Any:
    """Read series in powers of s, (segments, SERIES_ORDER + 1, d), of the segments `rows` at places s; (rows, d)."""
    result = np.empty((s.size, series.shape[2]))
    for row in range(s.size):
        evaluate(series[rows[row]], s[row], result[row])
    return result


@dataclass(frozen=True)
class Stretch:
    """A stretch of motion in which no contact changes its mode; series are in powers of s = (t − start) / span.

    They have the shape (SERIES_ORDER + 1, width).
    """

    start: float
    """[s]"""
    duration: float
    """[s]"""
    span: float
    """[s]"""
    coefficients: FloatArray = dataclasses.field(repr=False)
    """Displacements and velocities; of a chain the drive's sine and cosine behind them."""
    friction: FloatArray = dataclasses.field(repr=False)
    """λ_T [N] of every contact."""
    modes: NDArray[np.int8]
    """−1 backward slip, 0 stick, +1 forward slip, shape (c,); without friction, the direction of the slip."""

    @property
    def end(self) -> float:
        """End [s]."""
        return self.start + self.duration

    def states(self, elapsed: FloatArray) -> FloatArray:
        """Displacements and velocities at times after the start [s], shape (times,), as rows."""
        return self.powers(elapsed) @ self.coefficients

    def powers(self, elapsed: FloatArray) -> FloatArray:
        """Powers of s at times after the start [s], shape (times, SERIES_ORDER + 1)."""
        return np.vander(np.asarray(elapsed) / self.span, SERIES_ORDER + 1, increasing=True)


class Segment(Stretch):
    """A stretch of the motion of a chain, at most one span long."""

    @property
    def slipped(self) -> FloatArray:
        """Change of the relative displacement of every contact [m], shape (n,)."""
        n, s = self.modes.size, np.array([self.duration / self.span])
        change = values(self.coefficients[None], np.zeros(1, dtype=np.intp), s)[0] - self.coefficients[0]
        return change[n : 2 * n] - change[:n]

    def states(self, elapsed: FloatArray) -> FloatArray:
        """(u, v, u̇, v̇) at times after the start [s], shape (times,); the result has (times, 4n)."""
        n, stuck = self.modes.size, np.flatnonzero(self.modes == 0)
        states: FloatArray = self.powers(elapsed) @ self.coefficients[:, : 4 * n]
        states[:, 3 * n + stuck] = states[:, 2 * n + stuck]
        return states
