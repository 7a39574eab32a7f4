"""Steady states of masses and springs with one dry contact that slides without a stop: a closed form.

Den Hartog (1931) gave it for one mass. For chains it is that of L. Marino and A. Cicirello, "Dynamic response of
multi-degree-of-freedom systems with a Coulomb friction contact under harmonic excitation", Nonlinear Dynamics 106
(2021); it is derived anew here, with dashpots. While the contact slides without a stop, its friction is a square wave,

    M ẍ + C ẋ + K x = Im(f exp(iωt)) − F w s(t − t0),        s(τ) = 1 for 0 < τ < T/2, s(τ + T/2) = −s(τ),

and the motion the sum of two: that without friction, Im(X exp(iωt)), and F g(t − t0). As g changes its sign after half
a period, with z = (x, ẋ), ż = A z + a constant, A = V Λ V⁻¹ and the rest z_c = (−K⁻¹ w, 0),

    (g, ġ)(τ) = z_c − 2 V exp(Λτ) (1 + exp(Λ T/2))⁻¹ V⁻¹ z_c,        0 <= τ < T/2.

The contact turns at t0, which leaves one equation for t0. With Y = wᵀ X = |Y| exp(iα), h = wᵀ g and θ = ω t0 + α,

    ω |Y| cos θ + F ḣ(0) = 0,    sin θ < 0.

The motion exists as long as the slip keeps its sign for half a period, which bounds F, see `largest_sliding_friction`.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar

from reference_lcp.chain.drives import PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError
from reference_lcp.exact.event_driven_system import system_of_lane
from reference_lcp.exact.one_contact import OneContact
from reference_lcp.lcp.systems import MassSpringSystem
from reference_lcp.validation import FloatArray, checked_array

SAMPLES_PER_MODE = 64
"""Points in a period of the fastest mode between which a largest slip is looked for, before it is refined."""

FEWEST_SAMPLES = 512
"""Points in half a period of the drive, at the least."""

NO_RESPONSE = 1e-9
"""Distance |1 + exp(Λ T/2)| from resonance with an odd harmonic of friction below which half the digits are lost."""


class SquareWaveResponse:
    """The response g to friction of 1 N that changes its sign every half period, 1 being against forward slip."""

    def __init__(self, system: OneContact):
        self._omega, self._direction = system.angular_frequency, system.direction
        self.half_period = math.pi / self._omega
        f = system.freedoms
        # in units of √m and 1/ω the matrix is nearly normal, and its eigenvectors are well conditioned
        root = 1 / np.sqrt(np.diag(system.mass_matrix))
        stiffness = root[:, None] * system.stiffness_matrix * root / self._omega**2
        damping = root[:, None] * system.damping_matrix * root / self._omega
        rates = np.block([[np.zeros((f, f)), np.eye(f)], [-stiffness, -damping]])
        self._rates, modes = np.linalg.eig(rates)
        self._rest = -np.linalg.solve(system.stiffness_matrix, system.direction)
        parts = np.linalg.solve(modes, np.concatenate([self._rest / root, np.zeros(f)]))
        turned = 1 + np.exp(math.pi * self._rates)
        nearest = int(np.argmin(np.abs(turned)))
        if abs(turned[nearest]) < NO_RESPONSE:
            natural = abs(self._rates[nearest].imag) * self._omega
            raise ParameterError(
                f"angular_frequency = {self._omega:g} rad/s, in resonance with an undamped mode; "
                f"allowed: neither {natural:g} rad/s nor a third, a fifth, … of it"
            )
        self._modes = root[:, None] * modes[:f] * (2 * parts / turned)

    def __call__(self, tau: FloatArray, derivative: int = 0) -> FloatArray:
        """Give g [m/N], or its derivatives by time, just behind τ [s], shape (times, f)."""
        halves = np.floor(tau / self.half_period)
        powers = np.exp(np.multiply.outer(self._omega * (tau - halves * self.half_period), self._rates))
        rest = self._rest if derivative == 0 else 0.0
        moved = np.real(powers * (self._omega * self._rates) ** derivative @ self._modes.T)
        return np.asarray((1 - 2 * (halves % 2))[:, None] * (rest - moved))

    def of_contact(self, tau: ArrayLike, derivative: int = 0) -> FloatArray:
        """Give h = wᵀ g, or its derivatives, for 0 <= τ < T/2, shape (times,)."""
        return self(np.atleast_1d(np.asarray(tau, dtype=np.float64)), derivative) @ self._direction

    @cached_property
    def turn(self) -> float:
        """ḣ(0) / ω [m/N]: the part of Y that friction of 1 N takes at a turn."""
        return float(self.of_contact(0.0, 1)[0]) / self._omega

    @cached_property
    def hindrance(self) -> float:
        """S: max (ḣ(0) cos ωτ − ḣ(τ)) / (ω sin ωτ) over 0 <= τ <= T/2 [m/N]."""
        omega, half = self._omega, self.half_period
        fastest = max(1.0, float(np.max(np.abs(self._rates))))
        tau = np.linspace(0, half, max(FEWEST_SAMPLES, math.ceil(SAMPLES_PER_MODE * fastest)) + 1)

        def hindered(tau: FloatArray) -> FloatArray:
            slip = self.of_contact(tau, 1) / omega
            return np.asarray((self.turn * np.cos(omega * tau) - slip) / np.sin(omega * tau))

        values = hindered(tau[1:-1])
        # the accelerations behind one turn and before the next
        ends = [-self.of_contact(0.0, 2)[0], self.of_contact(half * (1 - 2.0**-52), 2)[0]]
        largest = max(*np.array(ends) / omega**2, float(np.max(values)))
        peaks = 1 + np.flatnonzero((values[1:-1] >= values[:-2]) & (values[1:-1] >= values[2:]))
        for peak in peaks.tolist():
            refined = minimize_scalar(
                lambda t: -float(hindered(np.array([t]))[0]), bounds=(tau[peak], tau[peak + 2]), method="bounded",
                options={"xatol": 1e-10 * half},
            )  # fmt: skip
            largest = max(largest, -float(refined.fun))
        return largest


@dataclass(frozen=True)
class SlidingMotion:
    """The steady state of a system whose one contact slides without a stop."""

    system: OneContact
    square_wave: SquareWaveResponse
    turn: float
    """t0 / T in [0, 1): the part of a period from where sin ωt begins to where the contact begins to slide forward."""

    @classmethod
    def of(cls, system: MassSpringSystem) -> Self:
        """Find the motion.

        Raises
        ------
        ParameterError
            If the contact stops, the message has the friction from which on it does; if the drive is in resonance; or
            if the system is none of those of `OneContact`.
        """
        own = OneContact.of(system)
        wave = SquareWaveResponse(own)
        limit = _limit(own, wave)
        if not own.friction < limit:
            raise ParameterError(
                f"friction = {own.friction:g} N at angular_frequency = {own.angular_frequency:g} rad/s; "
                f"allowed: below {limit:.4g} N, from there on the contact stops"
            )
        slip = own.relative_response
        theta = -math.acos(-own.friction * wave.turn / abs(slip))
        turn = (theta - float(np.angle(slip))) / (2 * math.pi) % 1.0
        return cls(own, wave, turn)

    @classmethod
    def of_chain(cls, chain: Chain, drive: PeriodicDrive) -> Self:
        """Find the motion of a chain with friction in one cell, outer masses first; errors as of `of`."""
        return cls.of(system_of_lane(Lane.periodic(chain, drive, MINIMUM_STEPS_PER_PERIOD)))

    def positions(self, times: ArrayLike) -> FloatArray:
        """Give x [m] at times [s], shape (times, f)."""
        return self._motion(times, 0)

    def velocities(self, times: ArrayLike) -> FloatArray:
        """Give ẋ [m/s] at times [s], shape (times, f)."""
        return self._motion(times, 1)

    @property
    def fundamental(self) -> NDArray[np.complex128]:
        """Complex amplitudes [m] of the fundamental harmonic, shape (f,): Im(X exp(iωt))."""
        turned = np.exp(-2j * math.pi * self.turn)
        return self.system.response - 4 / math.pi * self.system.friction * turned * self.system.friction_response

    @property
    def contact_amplitude(self) -> float:
        """Largest displacement of the contact from its middle [m], at its turns: √(|Y|² − (F ḣ(0)/ω)²) + F h(0)."""
        turn = self.turn * 2 * math.pi / self.system.angular_frequency
        return abs(float((self.positions([turn]) @ self.system.direction)[0]))

    def _motion(self, times: ArrayLike, derivative: int) -> FloatArray:
        system, t = self.system, np.atleast_1d(checked_array("times", times))
        omega = system.angular_frequency
        linear = np.exp(1j * omega * t)[:, None] * (1j * omega) ** derivative * system.response
        friction = system.friction * self.square_wave(t - self.turn * 2 * math.pi / omega, derivative)
        return np.asarray(np.imag(linear) + friction)


def largest_sliding_friction(system: MassSpringSystem) -> float:
    """Friction [N] below which the contact slides without a stop: |Y| / √((ḣ(0)/ω)² + max(S, 0)²).

    The slip ω |Y| |sin θ| sin ωτ + F (ḣ(τ) − ḣ(0) cos ωτ) keeps its sign as long as |Y| |sin θ| > F S, with the largest
    S = (ḣ(0) cos ωτ − ḣ(τ)) / (ω sin ωτ). Den Hartog's limit is this one for one mass. The friction that the contact
    has does not count. Raises as `SlidingMotion.of`.
    """
    own = OneContact.of(system)
    return _limit(own, SquareWaveResponse(own))


def _limit(system: OneContact, wave: SquareWaveResponse) -> float:
    return abs(system.relative_response) / math.hypot(wave.turn, max(wave.hindrance, 0.0))
