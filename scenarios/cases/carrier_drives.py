"""Motions of the base on which a block's carrier stands: one that breaks it away, and one that shakes it."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference_lcp.chain.drives import MovingBase
from reference_lcp.validation import LARGEST_UNIT, FloatArray, checked_scalar


@dataclass(frozen=True)
class GrowingAcceleration(MovingBase):
    """The base moves as A (t / T)³, with the acceleration 6 A t / T³."""

    kind: ClassVar[str] = "growing acceleration"
    amplitude: float
    """A [m], > 0."""
    duration: float
    """T [s], > 0."""

    def __post_init__(self) -> None:
        checked_scalar("base amplitude", self.amplitude, "> 0", LARGEST_UNIT)
        checked_scalar("duration", self.duration, "> 0")

    @property
    def jerk(self) -> float:
        """By how much the acceleration grows [m/s³]."""
        return 6 * self.amplitude / self.duration**3

    def displacement(self, time: FloatArray) -> FloatArray:
        """Displacement of the base [m]."""
        return self.amplitude * (np.asarray(time, dtype=np.float64) / self.duration) ** 3

    def velocity(self, time: FloatArray) -> FloatArray:
        """Velocity of the base [m/s]."""
        return self.jerk / 2 * np.asarray(time, dtype=np.float64) ** 2


@dataclass(frozen=True)
class Vibration(MovingBase):
    """The base moves as A (1 − cos ωt), from rest."""

    kind: ClassVar[str] = "vibration"
    amplitude: float
    """The displacement scale [m] of what rests on the base, > 0; it enters no equation of motion."""
    swing: float
    """A [m], > 0."""
    angular_frequency: float
    """ω [rad/s], > 0."""

    def __post_init__(self) -> None:
        checked_scalar("displacement scale", self.amplitude, "> 0", LARGEST_UNIT)
        checked_scalar("swing", self.swing, "> 0", LARGEST_UNIT)
        checked_scalar("angular_frequency", self.angular_frequency, "> 0")

    def displacement(self, time: FloatArray) -> FloatArray:
        """Displacement of the base [m]."""
        return self.swing * (1 - np.cos(self.angular_frequency * np.asarray(time, dtype=np.float64)))

    def velocity(self, time: FloatArray) -> FloatArray:
        """Velocity of the base [m/s]."""
        phase = self.angular_frequency * np.asarray(time, dtype=np.float64)
        return self.swing * self.angular_frequency * np.sin(phase)
