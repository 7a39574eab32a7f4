"""The chain as a linear system while every contact keeps its mode, and the series that solves it.

Between two changes of mode the chain is linear. With its state x = (u, v, u̇, v̇), the drive's
(sin ωt, cos ωt) and the constant forces of slipping contacts in one vector z, it obeys ż = A z, with
an A that depends on which contacts stick and not on the direction in which the others slip:

- a slipping contact: m_o ü = p_o − λ_T, m_i v̈ = p_i + λ_T, with λ_T an entry of z, constant;
- a sticking one: ü = v̈ = (p_o + p_i) / (m_o + m_i), and λ_T = m_i v̈ − p_i.

The solution exp(A τ) z is taken as its power series over at most one `span`: exact to round-off also where A is
defective, and with motion and friction force as polynomials, whose first root can be found with certainty.
"""

import dataclasses
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from reference_lcp.chain.drives import Drive, HarmonicBase, HarmonicForce, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

SERIES_ORDER = 20
"""Highest power of the series. Over one span the terms fall as k / k!: what is left out is below 1e-17."""

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class _Matrices:
    """A of ż = A z times the span, shape (d, d), and the rows that give λ_T = R z, shape (n, d)."""

    scaled_rates: FloatArray
    friction: FloatArray

    @cached_property
    def sparse_rates(self) -> csr_array:
        """A row of A has a few entries, of the mass and its neighbours, however long the chain is."""
        return csr_array(self.scaled_rates)


@numba.njit(cache=True, error_model="numpy")
def _series(entries: Any, columns: Any, starts: Any, z: Any) -> Any:
    """Coefficients of exp(A s) z in powers of s, A in compressed rows; written out, since BLAS uses threads for it."""
    coefficients = np.empty((SERIES_ORDER + 1, z.size))
    for row in range(z.size):
        coefficients[0, row] = z[row]
    for k in range(1, SERIES_ORDER + 1):
        for row in range(z.size):
            total = 0.0
            for entry in range(starts[row], starts[row + 1]):
                total += entries[entry] * coefficients[k - 1, columns[entry]]
            coefficients[k, row] = total / k
    return coefficients


@numba.njit(cache=True, error_model="numpy")
def _exponential(entries: Any, columns: Any, starts: Any, size: int) -> Any:
    """exp(A) of a square matrix in compressed rows, as 1 + A (1 + A/2 (1 + A/3 …))."""
    matrix = np.eye(size)
    for k in range(SERIES_ORDER, 0, -1):
        following = np.eye(size)
        for row in range(size):
            for entry in range(starts[row], starts[row + 1]):
                following[row] += entries[entry] / k * matrix[columns[entry]]
        matrix = following
    return matrix


class PiecewiseLinearChain:
    """A chain under a harmonic or still drive, as one linear system for each pattern of sticking contacts.

    The vector z has d = 5n + 2 entries: u, v, u̇, v̇ (n each), sin ωt, cos ωt, and λ_T of the contacts that slip (n).
    """

    def __init__(self, chain: Chain, drive: Drive):
        self.chain = chain
        self.angular_frequency, self._load = harmonic_load(chain, drive)
        self._patterns: dict[bytes, _Matrices] = {}

    @property
    def size(self) -> int:
        """Number d of entries of z."""
        return 5 * self.chain.cells + 2

    @cached_property
    def rate(self) -> float:
        """Bound on the speed of any motion [1/s]: ω_max + ‖M^-½ C M^-½‖, which no constraint raises, and ω."""
        weights = 1 / np.sqrt(np.diag(self.chain.mass_matrix))
        damping = np.linalg.norm(weights[:, None] * self.chain.damping_matrix * weights, 2)
        return max(self.chain.highest_natural_frequency + float(damping), self.angular_frequency)

    @property
    def span(self) -> float:
        """Time over which one series is used [s]: one over the rate."""
        return 1 / self.rate

    def phase(self, time: float) -> tuple[float, float]:
        """(sin ωt, cos ωt), two entries of z."""
        return float(np.sin(self.angular_frequency * time)), float(np.cos(self.angular_frequency * time))

    def series(self, z: FloatArray, stuck: BoolArray) -> FloatArray:
        """Coefficients of z(τ) in powers of s = τ / span, shape (SERIES_ORDER + 1, d)."""
        rates = self._matrices(stuck).sparse_rates
        return _series(rates.data, rates.indices, rates.indptr, z)

    def friction(self, vectors: FloatArray, stuck: BoolArray) -> FloatArray:
        """λ_T [N] of vectors z, or of coefficients of them, shape (..., d); the result has (..., n)."""
        return vectors @ self._matrices(stuck).friction.T

    def force_magnitude(self, coefficients: FloatArray) -> FloatArray:
        """Sum of the sizes of all forces on the two masses of each cell [N], shape (n,): what round-off scales with."""
        # Two terms of the series count, since forces may all pass zero at one instant.
        sizes = np.abs(self._forces_without_friction) @ (np.abs(coefficients[0]) + np.abs(coefficients[1]))
        outer, inner = np.split(sizes, 2)
        return outer + inner

    def rates(self, z: FloatArray, stuck: BoolArray) -> FloatArray:
        """ż of the vector z, shape (d,)."""
        return self._matrices(stuck).scaled_rates @ z * self.rate

    def propagator(self, stuck: BoolArray, duration: float) -> FloatArray:
        """Jacobian of the state after `duration` [s] <= one span of one pattern to the state before, shape (4n, 4n)."""
        motion = 4 * self.chain.cells
        rates = self._matrices(stuck).sparse_rates[:motion, :motion] * (duration * self.rate)
        return _exponential(rates.data, rates.indices, rates.indptr, motion)

    def _matrices(self, stuck: BoolArray) -> _Matrices:
        """Matrices of one pattern; the motion visits few of the 2ⁿ, and those are kept."""
        key = stuck.tobytes()
        if key in self._patterns:
            return self._patterns[key]
        chain, n = self.chain, self.chain.cells
        outer, inner, slipping_force = slice(0, n), slice(n, 2 * n), slice(4 * n + 2, 5 * n + 2)
        forces = self._forces_without_friction
        mean = (forces[outer] + forces[inner]) / (chain.outer_mass + chain.inner_mass)[:, None]
        held = chain.inner_mass[:, None] * mean - forces[inner]
        own = np.zeros((n, self.size))
        own[:, slipping_force] = np.eye(n)
        friction = np.where(stuck[:, None], held, own)
        slip_outer = (forces[outer] - own) / chain.outer_mass[:, None]
        slip_inner = (forces[inner] + own) / chain.inner_mass[:, None]
        rates = np.zeros((self.size, self.size))
        rates[: 2 * n, 2 * n : 4 * n] = np.eye(2 * n)
        rates[2 * n : 3 * n] = np.where(stuck[:, None], mean, slip_outer)
        rates[3 * n : 4 * n] = np.where(stuck[:, None], mean, slip_inner)
        rates[4 * n, 4 * n + 1] = self.angular_frequency
        rates[4 * n + 1, 4 * n] = -self.angular_frequency
        self._patterns[key] = _Matrices(rates * self.span, friction)
        return self._patterns[key]

    @cached_property
    def _forces_without_friction(self) -> FloatArray:
        """Rows that give f − K x − C q on every mass [N] from z, shape (2n, d)."""
        chain, n = self.chain, self.chain.cells
        rows = np.zeros((2 * n, self.size))
        rows[:, : 2 * n] = -chain.stiffness_matrix
        rows[:, 2 * n : 4 * n] = -chain.damping_matrix
        rows[0, 4 * n : 4 * n + 2] = self._load
        return rows


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


@dataclass(frozen=True)
class Stretch:
    """A stretch of motion in which no contact changes its mode; series are in powers of s = (t − start) / span."""

    start: float
    """[s]"""
    duration: float
    """[s]"""
    span: float
    """[s]"""

    @property
    def end(self) -> float:
        """End [s]."""
        return self.start + self.duration

    def powers(self, elapsed: FloatArray) -> FloatArray:
        """Powers of s at times after the start [s], shape (times, SERIES_ORDER + 1)."""
        return np.vander(np.asarray(elapsed) / self.span, SERIES_ORDER + 1, increasing=True)


@dataclass(frozen=True)
class Segment(Stretch):
    """A stretch of the motion of a chain, at most one span long."""

    coefficients: FloatArray = dataclasses.field(repr=False)
    """z in powers of s, shape (SERIES_ORDER + 1, d)."""
    friction: FloatArray = dataclasses.field(repr=False)
    """λ_T in powers of s [N], shape (SERIES_ORDER + 1, n)."""
    modes: NDArray[np.int8]
    """−1 backward slip, 0 stick, +1 forward slip; shape (n,)."""

    @property
    def cells(self) -> int:
        """Number of cells n."""
        return self.friction.shape[1]

    @property
    def end_vector(self) -> FloatArray:
        """The vector z at the end, shape (d,)."""
        return (self.powers(np.array([self.duration])) @ self.coefficients)[0]

    def states(self, elapsed: FloatArray) -> FloatArray:
        """(u, v, u̇, v̇) at times after the start [s], shape (times,); the result has (times, 4n)."""
        n = self.cells
        states: FloatArray = self.powers(elapsed) @ self.coefficients[:, : 4 * n]
        stuck = np.flatnonzero(self.modes == 0)
        states[:, 3 * n + stuck] = states[:, 2 * n + stuck]
        return states

    def friction_at(self, elapsed: FloatArray) -> FloatArray:
        """λ_T [N] at times after the start [s]; the result has shape (times, n)."""
        return self.powers(elapsed) @ self.friction
