"""Harmonic balance with several harmonics, as it is usually written: a peer that the benchmark compares with.

The slip of every contact is a sum of odd harmonics of the drive. Friction is taken in time, from the slip velocity at
equidistant phases, and brought back (T. M. Cameron and J. H. Griffin, J. Appl. Mech. 56, 1989). Coulomb's law is
smoothed, λ = −μ λ_N ẇ / √(ẇ² + ε²), and Newton's method follows the solution while ε falls.
"""

from dataclasses import dataclass

import numpy as np

from reference_lcp.chain.linear_response import frictionless_response
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

HARMONICS = 8
"""Odd harmonics, 1 to 15."""

SAMPLES = 128
"""Phases of a period at which friction is taken."""

SMOOTHING = 1e-4
"""ε over ω times the displacement scale; it begins at one."""

FACTOR = 3.0
"""By which ε falls from stage to stage; its square root from the first stage on in which Newton's method fails."""

LEAST_FACTOR = 1.05
"""Factor at which the point is given up."""

MOST_ITERATIONS = 40
"""Newton steps of a stage."""

BALANCED = 1e-8
"""Largest residual of the slip, over the displacement scale, that ends a stage."""

SHORTEST_STEP = 1e-3
"""Part of a Newton step below which a stage is given up."""


@dataclass(frozen=True)
class _Balance:
    """The equation w = a + G λ(w) for the Fourier coefficients w of all slips, shape (2H, n).

    The first H rows are real parts c', the other ones imaginary parts c" of Σ Re(c exp(ihωt)). `influence` is G, shape
    (2H, n, 2H, n), `free` is a, `basis` takes coefficients to samples, and `rates` those of the slip to samples of its
    velocity.
    """

    free: FloatArray
    influence: FloatArray
    basis: FloatArray
    rates: FloatArray
    bound: FloatArray

    @classmethod
    def of(cls, lane: Lane, omega: float) -> "_Balance":
        chain, orders = lane.chain, np.arange(1, 2 * HARMONICS, 2)
        w = chain.contact_directions
        dynamic = [
            chain.stiffness_matrix + 1j * h * omega * chain.damping_matrix - (h * omega) ** 2 * chain.mass_matrix
            for h in orders
        ]
        compliance = np.array([w.T @ np.linalg.solve(matrix, w) for matrix in dynamic])
        influence = np.zeros((2 * HARMONICS, chain.cells, 2 * HARMONICS, chain.cells))
        for h, block in enumerate(compliance):
            influence[h, :, h], influence[h, :, HARMONICS + h] = block.real, -block.imag
            influence[HARMONICS + h, :, h], influence[HARMONICS + h, :, HARMONICS + h] = block.imag, block.real
        free = np.zeros((2 * HARMONICS, chain.cells))
        slip = -1j * (w.T @ frictionless_response(chain, lane.drive))  # type: ignore[arg-type]
        free[0], free[HARMONICS] = slip.real, slip.imag
        phases = 2 * np.pi * np.arange(SAMPLES)[:, None] / SAMPLES * orders
        cosine, sine = np.cos(phases), np.sin(phases)
        rates = np.hstack([-sine, -cosine]) * np.tile(orders * omega, 2)
        return cls(free, influence, np.hstack([cosine, -sine]), rates, chain.friction_bound)

    def friction(self, slip: FloatArray, smoothing: float) -> tuple[FloatArray, FloatArray]:
        """Coefficients of friction, shape (2H, n), and its slope against the slip velocity, shape (samples, n)."""
        velocity = self.rates @ slip
        size = np.sqrt(velocity**2 + smoothing**2)
        force = self.basis.T @ (-self.bound * velocity / size) * (2 / SAMPLES)
        return force, -self.bound * smoothing**2 / size**3

    def residual(self, slip: FloatArray, smoothing: float) -> FloatArray:
        """W − a − G λ(w), shape (2H, n)."""
        force, _ = self.friction(slip, smoothing)
        residual: FloatArray = slip - self.free - np.tensordot(self.influence, force)
        return residual

    def newton_step(self, slip: FloatArray, residual: FloatArray, smoothing: float) -> FloatArray:
        """Change of w that solves the linearised equation."""
        _, slope = self.friction(slip, smoothing)
        jacobian = np.zeros(self.influence.shape)
        for cell, column in enumerate(slope.T):
            own = self.basis.T @ (column[:, None] * self.rates) * (2 / SAMPLES)
            jacobian[..., cell] = -self.influence[..., cell] @ own
        matrix = jacobian.reshape(slip.size, slip.size) + np.eye(slip.size)
        change = np.linalg.solve(matrix, -residual.ravel())
        return np.asarray(change.reshape(slip.shape), dtype=np.float64)

    def solved(self, slip: FloatArray, smoothing: float, tolerance: float) -> FloatArray | None:
        """Slip that solves the equation, by damped Newton steps from another one; ``None`` where they do not end."""
        residual = self.residual(slip, smoothing)
        for _ in range(MOST_ITERATIONS):
            if np.max(np.abs(residual)) <= tolerance:
                return slip
            step, part = self.newton_step(slip, residual, smoothing), 1.0
            while np.linalg.norm(after := self.residual(slip + part * step, smoothing)) >= np.linalg.norm(residual):
                part /= 2
                if part < SHORTEST_STEP:
                    return None
            slip, residual = slip + part * step, after
        return None

    def followed(self, velocity: float, tolerance: float) -> FloatArray | None:
        """Slip at the last ε, followed from ε = `velocity`; ``None`` where it is lost."""
        slip, smoothing, factor = self.solved(self.free, velocity, tolerance), 1.0, FACTOR
        while slip is not None and smoothing > SMOOTHING:
            smaller = max(smoothing / factor, SMOOTHING)
            following = self.solved(slip, smaller * velocity, tolerance)
            if following is not None:
                slip, smoothing = following, smaller
                continue
            factor **= 0.5
            if factor < LEAST_FACTOR:
                return None
        return slip


def balanced_transmittance(lane: Lane, steps_per_period: int) -> float:
    """Transmittance of a chain under a harmonic drive by harmonic balance; NaN where Newton's method fails.

    Parameters
    ----------
    lane
        The chain and its drive.
    steps_per_period
        Steps of one period, which give the frequency; nothing else depends on the time step.
    """
    omega, scale = 2 * np.pi / (lane.time_step * steps_per_period), lane.drive.displacement_scale(lane.chain)
    balance = _Balance.of(lane, omega)
    slip = balance.followed(omega * scale, BALANCED * scale)
    if slip is None:
        return float("nan")
    force, _ = balance.friction(slip, SMOOTHING * omega * scale)
    chain = lane.chain
    dynamic = chain.stiffness_matrix + 1j * omega * chain.damping_matrix - omega**2 * chain.mass_matrix
    first = chain.contact_directions @ (force[0] + 1j * force[HARMONICS])
    motion = -1j * frictionless_response(chain, lane.drive) + np.linalg.solve(dynamic, first)  # type: ignore[arg-type]
    return float(np.abs(motion[chain.cells - 1]) / scale)
