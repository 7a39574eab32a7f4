"""What sets the chain in motion: a moving base, or a force on cell 1."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Protocol, Self

import numpy as np

from reference_lcp import defaults
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.validation import LARGEST_PARAMETER, LARGEST_UNIT, FloatArray, checked_scalar


class Drive(Protocol):
    """Anything that loads the outer mass of cell 1: a moving base acts through spring and dashpot of cell 1 alone."""

    def load(self, chain: Chain, time: FloatArray) -> FloatArray:
        """Force on the outer mass of cell 1 [N] at `time` [s], of the same shape."""
        ...

    def displacement_scale(self, chain: Chain) -> float:
        """Length [m] by which displacements are made non-dimensional."""
        ...


class MovingBase(ABC):
    """A base that moves in a known way; a `Drive`."""

    amplitude: float
    """Displacement scale [m]."""

    @abstractmethod
    def displacement(self, time: FloatArray) -> FloatArray:
        """Displacement of the base [m] at `time` [s], of the same shape."""

    @abstractmethod
    def velocity(self, time: FloatArray) -> FloatArray:
        """Velocity of the base [m/s] at `time` [s], of the same shape."""

    def load(self, chain: Chain, time: FloatArray) -> FloatArray:
        """k_c u_0 + c_c u̇_0 [N]: what the moving base adds to the force on cell 1."""
        force: FloatArray = chain.chain_stiffness[0] * self.displacement(time)
        if chain.chain_damping[0] > 0:
            force = force + chain.chain_damping[0] * self.velocity(time)
        return force

    def displacement_scale(self, chain: Chain) -> float:
        """Give the amplitude [m]."""
        return self.amplitude


@dataclass(frozen=True)
class _Harmonic:
    """What repeats as a sine."""

    kind: ClassVar[str]
    amplitude: float
    """Of the base U0 [m], of the force P0 [N]; > 0."""
    angular_frequency: float
    """ω [rad/s], > 0."""

    def __post_init__(self) -> None:
        checked_scalar(f"{self.kind.split()[-1]} amplitude", self.amplitude, "> 0", LARGEST_UNIT)
        checked_scalar("angular_frequency", self.angular_frequency, "> 0")

    @property
    def period(self) -> float:
        """2π / ω [s]."""
        return 2 * np.pi / self.angular_frequency


@dataclass(frozen=True)
class HarmonicBase(_Harmonic, MovingBase):
    """The base moves as U0 sin ωt."""

    kind: ClassVar[str] = "harmonic base"

    @classmethod
    def from_ratio(cls, chain: Chain, frequency_ratio: float, amplitude: float = defaults.BASE_AMPLITUDE) -> Self:
        """Drive `chain` at η_r = ω / ω_r, with ω_r of its first cell.

        Raises
        ------
        ParameterError
            If `frequency_ratio` or `amplitude` is not > 0.
        """
        ratio = checked_scalar("frequency_ratio", frequency_ratio, "> 0", LARGEST_PARAMETER)
        length = checked_scalar("base_amplitude", amplitude, "> 0", LARGEST_UNIT)
        return cls(length, ratio * chain.resonator_frequency)

    def displacement(self, time: FloatArray) -> FloatArray:
        """Displacement of the base [m]."""
        return self.amplitude * np.sin(self.angular_frequency * time)

    def velocity(self, time: FloatArray) -> FloatArray:
        """Velocity of the base [m/s]."""
        return self.amplitude * self.angular_frequency * np.cos(self.angular_frequency * time)


@dataclass(frozen=True)
class HarmonicForce(_Harmonic):
    """The force P0 sin ωt acts on the outer mass of cell 1; the base stands still."""

    kind: ClassVar[str] = "harmonic force"
    length: float | None = None
    """The displacement scale [m], > 0, which enters no equation of motion; P0 / k_c without it."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.length is not None:
            checked_scalar("length", self.length, "> 0")

    def load(self, chain: Chain, time: FloatArray) -> FloatArray:
        """P0 sin ωt [N]."""
        return self.amplitude * np.sin(self.angular_frequency * time)

    def displacement_scale(self, chain: Chain) -> float:
        """P0 / k_c [m], the static elongation of the first chain spring, or the length that was chosen."""
        return float(self.amplitude / chain.chain_stiffness[0]) if self.length is None else self.length


@dataclass(frozen=True)
class StillBase:
    """Nothing drives the chain: free motion from its initial state."""

    kind: ClassVar[str] = "still base"
    length: float = 1.0
    """The displacement scale [m], > 0; it enters no equation of motion."""

    def __post_init__(self) -> None:
        checked_scalar("length", self.length, "> 0")

    def load(self, chain: Chain, time: FloatArray) -> FloatArray:
        """Zero [N]."""
        return np.zeros_like(np.asarray(time, dtype=np.float64))

    def displacement_scale(self, chain: Chain) -> float:
        """Give the length [m] that was chosen."""
        return self.length


PeriodicDrive = HarmonicBase | HarmonicForce
