"""Given forces as functions of time: constants, sines, and pieces of both one after the other."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from reference_lcp.refusal import ParameterError
from reference_lcp.validation import checked_scalar

SAME_TIME = 4 * 2.0**-52
"""Part of a time within which it is that of a switch: k dt and the time that a user wrote differ by roundings."""


@dataclass(frozen=True)
class Harmonic:
    """The force F(t) = F_0 + A sin(ωt + φ).

    Parameters
    ----------
    mean
        F_0 [N].
    amplitude
        A [N].
    angular_frequency
        ω [rad/s], >= 0.
    phase
        φ [rad].

    Raises
    ------
    ParameterError
        If a parameter is outside its range.
    """

    mean: float = 0.0
    amplitude: float = 0.0
    angular_frequency: float = 0.0
    phase: float = 0.0

    def __post_init__(self) -> None:
        for name in ("mean", "amplitude", "phase"):
            checked_scalar(name, getattr(self, name))
        checked_scalar("angular_frequency", self.angular_frequency, ">= 0")

    @property
    def is_zero(self) -> bool:
        """Whether it is zero at all times."""
        return self.mean == 0 and self.amplitude == 0

    def value(self, time: float) -> float:
        """F(t) [N] at `time` [s]."""
        return self.mean + self.amplitude * math.sin(self.angular_frequency * time + self.phase)


@dataclass(frozen=True)
class Piecewise:
    """A force that switches from one function of time to the next.

    Parameters
    ----------
    pieces
        Each `Harmonic`, or constant [N], by the time [s] from which on it holds, in rising order; the first is that
        of all earlier times too. A piece keeps the time of the whole: φ is the phase at t = 0.

    Raises
    ------
    ParameterError
        If there is no piece, or times do not rise.
    """

    pieces: Mapping[float, Harmonic | float]

    def __post_init__(self) -> None:
        starts = [checked_scalar("start of a piece", start) for start in self.pieces]
        if not starts or starts != sorted(set(starts)):
            raise ParameterError(f"starts of pieces = {starts}; allowed: one or more, in rising order")
        object.__setattr__(self, "pieces", {t: _harmonic(piece) for t, piece in self.pieces.items()})

    @property
    def switches(self) -> tuple[float, ...]:
        """Times from which another piece holds [s], in rising order."""
        return tuple(self.pieces)[1:]

    def piece(self, time: float) -> Harmonic:
        """Give what holds at `time` [s], and just behind it."""
        begun = [piece for start, piece in self.pieces.items() if start <= time + SAME_TIME * abs(time)]
        return _harmonic(begun[-1] if begun else next(iter(self.pieces.values())))

    def value(self, time: float) -> float:
        """F(t) [N] at `time` [s], of the later piece where it switches."""
        return self.piece(time).value(time)


Signal = Piecewise | Harmonic | float
"""A force as a user may give it [N]."""


def piecewise(signal: Signal) -> Piecewise:
    """Give any signal as pieces."""
    return signal if isinstance(signal, Piecewise) else Piecewise({0.0: signal})


def _harmonic(piece: Harmonic | float) -> Harmonic:
    return piece if isinstance(piece, Harmonic) else Harmonic(mean=checked_scalar("force", piece))
