"""Base motions that are not harmonic, from rest: a Ricker pulse, a swept sine, filtered noise, a record."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.drives import MovingBase
from reference_lcp.errors import ParameterError, checked_choice
from reference_lcp.validation import FloatArray, checked_count, checked_scalar

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

QUIET = 10.0
"""Least delay of a Ricker pulse times its peak frequency: before time zero it is below 1e-9 of its amplitude."""

BLOCK = 4096
"""Times at which a sum of sines is evaluated together: the powers stay in the second-level cache."""

FEWEST_SAMPLES = 4
"""What a cubic spline needs."""


@dataclass(frozen=True)
class RickerPulse(MovingBase):
    """The base moves as A (1 − ω_p²τ²/2) exp(−ω_p²τ²/4), with τ = t − delay: one pulse, and still again.

    Its spectrum ω² exp(−ω²/ω_p²) is largest at ω_p (N. Ricker, Geophysics 18, 1953) and zero at ω = 0.
    """

    kind: ClassVar[str] = "Ricker pulse"
    amplitude: float
    """A [m], > 0, reached at t = delay."""
    peak_frequency: float
    """ω_p [rad/s], > 0."""
    delay: float
    """When the pulse is highest [s], at least `QUIET` / ω_p."""

    def __post_init__(self) -> None:
        checked_scalar("pulse amplitude", self.amplitude, "> 0")
        checked_scalar("peak_frequency", self.peak_frequency, "> 0")
        least = QUIET / self.peak_frequency
        if checked_scalar("delay", self.delay, "> 0") < least * (1 - 1e-12):
            raise ParameterError(
                f"delay = {self.delay:g} s cuts off the beginning of the pulse; allowed: >= {least:g} s, "
                f"{QUIET:g} / peak_frequency"
            )

    def displacement(self, time: FloatArray) -> FloatArray:
        """Displacement of the base [m]."""
        square = (self.peak_frequency * (np.asarray(time, dtype=np.float64) - self.delay)) ** 2
        return self.amplitude * (1 - square / 2) * np.exp(-square / 4)

    def velocity(self, time: FloatArray) -> FloatArray:
        """Velocity of the base [m/s]."""
        phase = self.peak_frequency * (np.asarray(time, dtype=np.float64) - self.delay)
        shape = phase * (phase**2 / 4 - 3 / 2) * np.exp(-(phase**2) / 4)
        return self.amplitude * self.peak_frequency * shape


@dataclass(frozen=True)
class SweptSine(MovingBase):
    """The base moves as A w(t) sin φ(t), with φ̇ from one frequency to another; it is still afterwards.

    A linear sweep has φ̇ = ω_1 + (ω_2 − ω_1) t / T, a logarithmic one φ̇ = ω_1 (ω_2 / ω_1)^(t/T). The window
    w rises from 0 to 1 and falls again by half a cosine, in a part of T each.
    """

    kind: ClassVar[str] = "swept sine"
    amplitude: float
    """A [m], > 0."""
    first_frequency: float
    """ω_1 [rad/s], > 0."""
    last_frequency: float
    """ω_2 [rad/s], > 0 and another; the sweep may go down."""
    duration: float
    """T [s], > 0."""
    sweep: str = "logarithmic"
    """``"linear"`` or ``"logarithmic"``."""
    taper: float = 0.05
    """Part of T that the rise takes, and the fall, in (0, 1/2]."""

    def __post_init__(self) -> None:
        checked_scalar("sweep amplitude", self.amplitude, "> 0")
        checked_scalar("first_frequency", self.first_frequency, "> 0")
        checked_scalar("last_frequency", self.last_frequency, "> 0")
        checked_scalar("duration", self.duration, "> 0")
        checked_choice("sweep", self.sweep, ["linear", "logarithmic"])
        if self.first_frequency == self.last_frequency:
            raise ParameterError(f"last_frequency = {self.last_frequency:g}; allowed: other than first_frequency")
        if not 0 < checked_scalar("taper", self.taper, "> 0") <= 0.5:
            raise ParameterError(f"taper = {self.taper:g} is outside its range; allowed: > 0, <= 0.5")

    def displacement(self, time: FloatArray) -> FloatArray:
        """Displacement of the base [m]."""
        phase, _ = self._phase(time)
        window, _ = self._window(time)
        return self.amplitude * window * np.sin(phase)

    def velocity(self, time: FloatArray) -> FloatArray:
        """Velocity of the base [m/s]."""
        phase, frequency = self._phase(time)
        window, rate = self._window(time)
        return self.amplitude * (rate * np.sin(phase) + window * frequency * np.cos(phase))

    def _phase(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give φ [rad] and φ̇ [rad/s]."""
        t = np.clip(np.asarray(time, dtype=np.float64), 0.0, self.duration)
        first, last = self.first_frequency, self.last_frequency
        if self.sweep == "linear":
            growth = (last - first) / self.duration
            return first * t + growth * t**2 / 2, first + growth * t
        exponent = np.log(last / first) / self.duration
        return first * np.expm1(exponent * t) / exponent, first * np.exp(exponent * t)

    def _window(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give w and ẇ [1/s]."""
        rise = self.taper * self.duration
        t = np.asarray(time, dtype=np.float64)
        up, rate_up = cosine_rise(t, rise)
        down, rate_down = cosine_rise(self.duration - t, rise)
        return up * down, rate_up * down - up * rate_down


@dataclass(frozen=True)
class FilteredNoise(MovingBase):
    """The base moves as noise of a flat spectrum between two frequencies: a sum of sines of random phase.

    Sines of equal amplitude at the multiples of 2π / repetition within the band; their phases are drawn evenly
    (M. Shinozuka and C.-M. Jan, J. Sound Vib. 25, 1972). It begins at rest, by half a cosine.
    """

    kind: ClassVar[str] = "filtered noise"
    amplitude: float
    """√2 times the root mean square [m], > 0: that of a harmonic motion of the same power."""
    lowest_frequency: float
    """Lower end of the band [rad/s], > 0."""
    highest_frequency: float
    """Upper end of the band [rad/s]."""
    repetition: float
    """Time after which the noise repeats [s]; at least ten multiples of 2π / repetition lie in the band."""
    rise: float
    """Time in which it comes up [s], > 0."""
    seed: int = 0
    """Of the phases, >= 0."""

    def __post_init__(self) -> None:
        checked_scalar("noise amplitude", self.amplitude, "> 0")
        checked_scalar("rise", self.rise, "> 0")
        checked_scalar("repetition", self.repetition, "> 0")
        checked_count("seed", self.seed, 0)
        lowest = checked_scalar("lowest_frequency", self.lowest_frequency, "> 0")
        if checked_scalar("highest_frequency", self.highest_frequency, "> 0") <= lowest:
            raise ParameterError(f"highest_frequency = {self.highest_frequency:g}; allowed: > {lowest:g}, the lowest")
        if self._lines.size < 10:
            raise ParameterError(
                f"repetition = {self.repetition:g} s gives {self._lines.size} sines in the band; allowed: at least 10, "
                f"from {22 * np.pi / (self.highest_frequency - lowest):.4g} s on"
            )

    def displacement(self, time: FloatArray) -> FloatArray:
        """Displacement of the base [m]."""
        t = np.asarray(time, dtype=np.float64)
        return cosine_rise(t, self.rise)[0] * self._sum(self._phasors, t)

    def velocity(self, time: FloatArray) -> FloatArray:
        """Velocity of the base [m/s]."""
        t = np.asarray(time, dtype=np.float64)
        window, rate = cosine_rise(t, self.rise)
        rates = 1j * self._lines * self._spacing * self._phasors
        return rate * self._sum(self._phasors, t) + window * self._sum(rates, t)

    @property
    def _spacing(self) -> float:
        """Distance of neighbouring frequencies [rad/s]."""
        return 2 * np.pi / self.repetition

    @cached_property
    def _lines(self) -> NDArray[np.intp]:
        """Multiples of the spacing that lie in the band."""
        first, last = self.lowest_frequency / self._spacing, self.highest_frequency / self._spacing
        return np.arange(np.ceil(first), np.floor(last) + 1, dtype=np.intp)

    @cached_property
    def _phasors(self) -> NDArray[np.complex128]:
        """Complex amplitude of each sine [m]."""
        # the stream of a named bit generator does not change between versions of NumPy
        turns = np.random.Generator(np.random.PCG64(self.seed)).random(self._lines.size)
        return self.amplitude / np.sqrt(self._lines.size) * np.exp(2j * np.pi * turns)

    def _sum(self, phasors: NDArray[np.complex128], time: FloatArray) -> FloatArray:
        """Im Σ_k p_k z^k with z = exp(iΔω t), by Horner's rule: |z| = 1, so that no rounding grows."""
        flat = np.ravel(time)
        values = np.empty(flat.size)
        for first in range(0, flat.size, BLOCK):
            t = flat[first : first + BLOCK]
            z = np.exp(1j * self._spacing * np.remainder(t, self.repetition))
            total = np.full(t.size, phasors[-1])
            for phasor in phasors[-2::-1]:
                total *= z
                total += phasor
            values[first : first + BLOCK] = np.imag(total * z ** self._lines[0])
        return values.reshape(np.shape(time))


def cosine_rise(time: FloatArray, rise: float) -> tuple[FloatArray, FloatArray]:
    """Half a cosine from 0 at time 0 to 1 at time `rise` [s], and its rate of change [1/s]; constant outside."""
    phase = np.pi * np.clip(time / rise, 0.0, 1.0)
    return (1 - np.cos(phase)) / 2, np.pi / (2 * rise) * np.sin(phase)


@dataclass(frozen=True)
class RecordedBase(MovingBase):
    """The base moves along the cubic spline through samples; displacement and velocity are continuous.

    The spline begins and ends at rest; before the first sample and after the last one the base stands still.
    The chain is undeformed at the first sample: displacements count from there, and times too.
    """

    kind: ClassVar[str] = "recorded base"
    times: tuple[float, ...]
    """When samples were taken [s], ascending, at least four."""
    displacements: tuple[float, ...]
    """The samples [m], as many."""

    def __post_init__(self) -> None:
        if len(self.times) != len(self.displacements) or len(self.times) < FEWEST_SAMPLES:
            raise ParameterError(
                f"the record has {len(self.times)} times and {len(self.displacements)} displacements; "
                f"allowed: as many of each, at least {FEWEST_SAMPLES}"
            )
        for name, values in (("time", self.times), ("displacement", self.displacements)):
            for row, value in enumerate(values, start=1):
                checked_scalar(f"{name} in sample {row} of the record", value)
        for row, (before, after) in enumerate(zip(self.times, self.times[1:], strict=False), start=2):
            if after <= before:
                raise ParameterError(f"time = {after:g} s in sample {row} of the record; allowed: > {before:g} s")
        if self.amplitude == 0:
            raise ParameterError(f"displacement = {self.displacements[0]:g} m throughout; allowed: a base that moves")

    @cached_property
    def amplitude(self) -> float:  # type: ignore[override]
        """Largest distance from the first sample [m]."""
        return max(abs(value - self.displacements[0]) for value in self.displacements)

    @property
    def duration(self) -> float:
        """Time from the first sample to the last one [s]."""
        return self.times[-1] - self.times[0]

    def displacement(self, time: FloatArray) -> FloatArray:
        """Displacement of the base [m]."""
        return self._spline(self._inside(time))

    def velocity(self, time: FloatArray) -> FloatArray:
        """Velocity of the base [m/s]."""
        return self._spline(self._inside(time), 1)

    @cached_property
    def _spline(self) -> "CubicSpline":
        from scipy.interpolate import CubicSpline  # SciPy is imported once the base moves

        times, displacements = np.array(self.times), np.array(self.displacements)
        return CubicSpline(times - times[0], displacements - displacements[0], bc_type="clamped")

    def _inside(self, time: FloatArray) -> FloatArray:
        return np.clip(np.asarray(time, dtype=np.float64), 0.0, self.duration)
