"""The friction oscillator under a harmonic force while it never stops: Den Hartog's closed form.

J. P. Den Hartog, "Forced vibrations with combined Coulomb and viscous friction", Trans. ASME 53 (1931):
m ẍ + k x + F sgn ẋ = P0 cos(ωt + φ), with a turn at x = x0 at t = 0. With r = ω / √(k / m) and
V = 1 / (1 − r²), U = sin(π/r) / (r (1 + cos(π/r))),

x0 = (P0 / k) √(V² − (F/P0)² U²),    tan φ = −(F/P0) U / (x0 k / P0),

as long as F/P0 is below a limit from which on the mass stops at its turns.
"""

import cmath
import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.optimize import minimize_scalar

from reference_lcp.errors import ParameterError
from reference_lcp.validation import checked_scalar

TURN_SEARCH_POINTS = 2001
"""Points between two turns at which the limit of sliding is looked for before the best one is refined."""


@dataclass(frozen=True)
class SlidingMotion:
    """The periodic motion of a friction oscillator that slides without a stop."""

    frequency_ratio: float
    """r = ω / √(k / m)."""
    force_ratio: float
    """F / P0, friction over the amplitude of the force."""
    amplitude: float
    """x0 k / P0, the displacement at the turns over the static one."""
    phase: float
    """φ [rad]: at the turn at +x0 the force is P0 cos φ."""

    @classmethod
    def of(cls, frequency_ratio: float, force_ratio: float) -> Self:
        """Find the motion; refused where there is none (r = 1, 1/2, 1/3, …), or the mass stops."""
        limit = largest_sliding_force_ratio(frequency_ratio)
        if not 0 <= checked_scalar("force_ratio", force_ratio) < limit:
            raise ParameterError(
                f"force_ratio = {force_ratio:g} at frequency_ratio = {frequency_ratio:g}; allowed: [0, {limit:.4g}), "
                "beyond it the mass stops"
            )
        v, u = _factors(frequency_ratio)
        amplitude = math.sqrt(v**2 - (force_ratio * u) ** 2)
        return cls(frequency_ratio, force_ratio, amplitude, math.atan2(-force_ratio * u / v, amplitude / v))

    @property
    def fundamental(self) -> complex:
        """Complex amplitude of the fundamental harmonic over P0 / k: Re(X exp(iωt)) with t from the turn at +x0."""
        # Friction is a square wave whose fundamental has the amplitude 4F/π and acts forward after the turn.
        force = complex(math.cos(self.phase), math.sin(self.phase)) - 4j / math.pi * self.force_ratio
        return force / (1 - self.frequency_ratio**2)

    @property
    def response(self) -> complex:
        """Complex amplitude of the fundamental over P0 / k under the force P0 sin ωt; A exp(iφ) is A sin(ωt + φ)."""
        return 1j * self.fundamental * cmath.exp(-2j * math.pi * self.turn)

    @property
    def turn(self) -> float:
        """Part of the period from where P0 sin ωt begins to the turn at +x0, in [0, 1)."""
        # the force at the turn is P0 cos φ = P0 sin(φ + π/2)
        return (self.phase / (2 * math.pi) + 0.25) % 1.0


def largest_sliding_force_ratio(frequency_ratio: float) -> float:
    """F/P0 from which on the mass stops at its turns: √(V² / (U² + (S/r²)²)).

    S is the maximum of [r sin τ + U r² (cos rτ − cos τ)] / sin rτ over 0 < τ < π/r, from turn to turn.
    """
    r = checked_scalar("frequency_ratio", frequency_ratio, "> 0")
    v, u = _factors(r)

    def lag(tau: float) -> float:
        return -float((r * np.sin(tau) + u * r**2 * (np.cos(r * tau) - np.cos(tau))) / np.sin(r * tau))

    grid = np.linspace(0, np.pi / r, TURN_SEARCH_POINTS)[1:-1]
    best = int(np.argmin([lag(tau) for tau in grid]))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]
    refined = minimize_scalar(lag, bounds=(low, high), method="bounded", options={"xatol": 1e-10 * grid[-1]})
    s = -min(lag(grid[best]), float(refined.fun))
    return math.sqrt(v**2 / (u**2 + (s / r**2) ** 2))


def _factors(r: float) -> tuple[float, float]:
    checked_scalar("frequency_ratio", r, "> 0")
    if math.isclose(1 / r, round(1 / r), rel_tol=1e-9):
        raise ParameterError(f"frequency_ratio = {r:g}; allowed: > 0, but neither 1 nor 1/2, 1/3, …")
    return 1 / (1 - r**2), math.sin(math.pi / r) / (r * (1 + math.cos(math.pi / r)))
