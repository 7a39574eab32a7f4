"""What shakes a mass that rests on another: a base whose acceleration grows or that vibrates, and a force."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference_lcp.chain.harmonic import HarmonicForce, MovingBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.validation import LARGEST_UNIT, FloatArray, checked_scalar


@dataclass(frozen=True)
class GrowingAcceleration(MovingBase):
    """The base moves as A (t / T)³, with the acceleration 6 A t / T³.

    Parameters
    ----------
    amplitude
        A [m], > 0.
    duration
        T [s], > 0.

    Raises
    ------
    ParameterError
        If a parameter is outside its range.
    """

    kind: ClassVar[str] = "growing acceleration"
    amplitude: float
    duration: float

    def __post_init__(self) -> None:
        checked_scalar("base amplitude", self.amplitude, "> 0", LARGEST_UNIT)
        checked_scalar("duration", self.duration, "> 0")

    @property
    def jerk(self) -> float:
        """By how much the acceleration grows [m/s³]."""
        return 6 * self.amplitude / self.duration**3

    def displacement(self, time: FloatArray) -> FloatArray:
        """Displacement of the base [m]."""
        moved: FloatArray = self.amplitude * (np.asarray(time, dtype=np.float64) / self.duration) ** 3
        return moved

    def velocity(self, time: FloatArray) -> FloatArray:
        """Velocity of the base [m/s]."""
        rate: FloatArray = self.jerk / 2 * np.asarray(time, dtype=np.float64) ** 2
        return rate


@dataclass(frozen=True)
class Vibration(MovingBase):
    """The base moves as A (1 − cos ωt), from rest.

    Parameters
    ----------
    amplitude
        The displacement scale [m] of what rests on the base, > 0; it enters no equation of motion.
    swing
        A [m], > 0.
    angular_frequency
        ω [rad/s], > 0.

    Raises
    ------
    ParameterError
        If a parameter is outside its range.
    """

    kind: ClassVar[str] = "vibration"
    amplitude: float
    swing: float
    angular_frequency: float

    def __post_init__(self) -> None:
        checked_scalar("displacement scale", self.amplitude, "> 0", LARGEST_UNIT)
        checked_scalar("swing", self.swing, "> 0", LARGEST_UNIT)
        checked_scalar("angular_frequency", self.angular_frequency, "> 0")

    def displacement(self, time: FloatArray) -> FloatArray:
        """Displacement of the base [m]."""
        moved: FloatArray = self.swing * (1 - np.cos(self.angular_frequency * np.asarray(time, dtype=np.float64)))
        return moved

    def velocity(self, time: FloatArray) -> FloatArray:
        """Velocity of the base [m/s]."""
        phase = self.angular_frequency * np.asarray(time, dtype=np.float64)
        rate: FloatArray = self.swing * self.angular_frequency * np.sin(phase)
        return rate


@dataclass(frozen=True)
class ShakingForce(HarmonicForce):
    """The force P0 sin ωt shakes a first cell that is all but free: no spring says how far.

    Parameters
    ----------
    amplitude, angular_frequency
        P0 [N] and ω [rad/s], > 0.
    length
        The displacement scale [m], > 0; it enters no equation of motion.

    Raises
    ------
    ParameterError
        If a parameter is outside its range.
    """

    kind: ClassVar[str] = "shaking force"
    length: float

    def __post_init__(self) -> None:
        super().__post_init__()
        checked_scalar("length", self.length, "> 0")

    def displacement_scale(self, chain: Chain) -> float:
        """Give the length [m] that was chosen."""
        return self.length
