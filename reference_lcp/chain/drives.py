"""What sets the chain in motion: a moving base, or a force on cell 1."""

from abc import ABC, abstractmethod
from dataclasses import Field, dataclass, fields
from typing import Any, ClassVar, Protocol, Self

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

    def parameters(self) -> dict[str, Any]:
        """Give the kind and the parameters, ready for JSON."""
        ...


class _Parametric:
    """A dataclass whose fields are all that a drive consists of."""

    kind: ClassVar[str]
    """As `parameters` names it."""
    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    def parameters(self) -> dict[str, Any]:
        """Give the kind and the parameters, ready for JSON."""
        return {"kind": self.kind} | {field.name: getattr(self, field.name) for field in fields(self)}


class MovingBase(_Parametric, ABC):
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
class _Harmonic(_Parametric):
    """What repeats as a sine."""

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

    def load(self, chain: Chain, time: FloatArray) -> FloatArray:
        """P0 sin ωt [N]."""
        return self.amplitude * np.sin(self.angular_frequency * time)

    def displacement_scale(self, chain: Chain) -> float:
        """P0 / k_c [m], the static elongation of the first chain spring."""
        return float(self.amplitude / chain.chain_stiffness[0])


@dataclass(frozen=True)
class StillBase(_Parametric):
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


@dataclass(frozen=True)
class ShakingForce(HarmonicForce):
    """The force P0 sin ωt shakes a first cell that is all but free: no spring says how far."""

    kind: ClassVar[str] = "shaking force"
    length: float
    """The displacement scale [m], > 0; it enters no equation of motion."""

    def __post_init__(self) -> None:
        super().__post_init__()
        checked_scalar("length", self.length, "> 0")

    def displacement_scale(self, chain: Chain) -> float:
        """Give the length [m] that was chosen."""
        return self.length
