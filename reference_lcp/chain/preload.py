"""A preload that changes in time: what presses the masses of a cell together, and when they part.

An actuator in every cell presses the inner mass on the outer one, across the row, with

    N_i(t) = N0_i (1 + a sin(Ω t + φ)),

N0_i being the chain's `normal_force`. With faces along the row nothing couples the normal direction to the motion along
it: λ_N(t) is known before the row moves. For a <= 1 the contact stays closed, and λ_N = N. For a > 1 the actuator pulls
the inner mass off for a part of each cycle; it flies, falls back, and lands without rebound.
"""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from reference_lcp.chain.drives import PeriodicDrive
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray, checked_scalar

LARGEST_PERIODIC_MODULATION = math.sqrt(1 + math.pi**2)
"""Up to this a, about 3.3, a flight ends before the actuator pulls again; beyond, flights need not repeat."""


@dataclass(frozen=True, kw_only=True)
class Preload:
    """How the force that presses the masses of every cell together changes, as a factor on its mean."""

    modulation: float
    """a >= 0."""
    angular_frequency: float
    """Ω [rad/s], > 0."""
    phase: float = 0.0
    """φ [rad]."""

    def __post_init__(self) -> None:
        checked_scalar("modulation", self.modulation, ">= 0")
        checked_scalar("modulation_frequency", self.angular_frequency, "> 0")
        checked_scalar("modulation_phase", self.phase)

    @classmethod
    def at_multiple(cls, drive: PeriodicDrive, modulation: float, multiple: float = 1.0, phase: float = 0.0) -> Self:
        """Modulate at Ω = `multiple` ω, with ω of the drive; a `ParameterError` outside the range."""
        ratio = checked_scalar("modulation_multiple", multiple, "> 0")
        return cls(modulation=modulation, angular_frequency=ratio * drive.angular_frequency, phase=phase)

    @property
    def opens(self) -> bool:
        """Whether the actuator pulls for a part of each cycle, so that contacts open."""
        return self.modulation > 1

    def factor(self, time: FloatArray) -> FloatArray:
        """N(t) / N0, negative where the actuator pulls; shape of `time` [s]."""
        return 1 + self.modulation * np.sin(self.angular_frequency * time + self.phase)


CONSTANT = Preload(modulation=0.0, angular_frequency=1.0)
"""A constant force that presses a contact whose masses are free to part, as a body rests on the ground."""


@dataclass(frozen=True)
class Flight:
    """The exact flight of an inner mass under a preload that opens its contact, once in a cycle of the preload."""

    lift_off: float
    """Phase Ω t + φ [rad] of the preload, in (π, 3π/2)."""
    landing: float
    """The same, < `lift_off` + 2π."""
    highest: float
    """Largest gap over N0 / (m Ω²), m being the mass that flies."""

    @classmethod
    def of(cls, preload: Preload) -> Self:
        """Integrate N(t) twice, and find the roots; refused unless contacts open, and land before they open again."""
        a = preload.modulation
        if not 1 < a < LARGEST_PERIODIC_MODULATION:
            raise ParameterError(f"modulation = {a:g}; allowed for a flight a cycle: (1, √(1 + π²) = 3.3)")
        start = math.pi + math.asin(1 / a)

        def gap(phase: float) -> float:
            flown = phase - start
            return a * (math.sin(phase) - math.sin(start) - flown * math.cos(start)) - flown**2 / 2

        def speed(phase: float) -> float:
            return a * (math.cos(phase) - math.cos(start)) - (phase - start)

        from scipy.optimize import brentq  # SciPy is imported once something flies

        # It rises while it is pulled, falls after its highest point, and is below ground when a cycle is over.
        pulled_until = 3 * math.pi - start
        top = brentq(speed, pulled_until, start + 2 * math.pi)
        landing = brentq(gap, top, start + 2 * math.pi)
        return cls(start, landing, gap(top))

    @property
    def open_fraction(self) -> float:
        """Part of the cycle that the contact is open."""
        return (self.landing - self.lift_off) / (2 * math.pi)


@dataclass(frozen=True)
class NormalMotion:
    """The normal direction of contacts over consecutive steps; row k belongs to the end of step k."""

    normal_force: FloatArray
    """λ_N >= 0 [N] during the step, shape (steps, ...)."""
    gap: FloatArray
    """g_N [m], same shape."""
    speed: FloatArray
    """Rate of the gap at the end of the last step [m/s], shape (...)."""


def normal_motion(
    normal_load: FloatArray, mass: FloatArray, time_step: FloatArray | float, gap: FloatArray, speed: FloatArray
) -> NormalMotion:
    """Advance the normal direction alone, by equation (7): 0 <= Λ_N ⟂ g_N + Δt ġ_N⁺ >= 0 with m Δġ_N = Λ_N − N Δt.

    `normal_load` is N at the start of each step [N], negative where the actuator pulls, shape (steps, ...); `gap` >= 0
    [m] and its rate `speed` [m/s] have shape (...), with which `mass` [kg] and `time_step` [s] broadcast.
    """
    from reference_lcp.chain.kernels import advance_normal

    steps, shape = normal_load.shape[0], normal_load.shape[1:]
    flat = [np.broadcast_to(part, shape).ravel() for part in (mass, time_step, gap, speed)]
    rows, gaps, rate = advance_normal(np.ascontiguousarray(normal_load).reshape(steps, -1), *flat)
    return NormalMotion(rows.reshape(normal_load.shape), gaps.reshape(normal_load.shape), rate.reshape(shape))
