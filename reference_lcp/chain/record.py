"""A base that moves as recorded: samples of time and displacement, from a CSV file."""

import csv
import hashlib
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from reference_lcp.chain.drives import MovingBase
from reference_lcp.errors import ParameterError, checked_path
from reference_lcp.validation import FloatArray, checked_scalar

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

FEWEST_SAMPLES = 4
"""What a cubic spline needs."""

SAMPLES_PER_PERIOD = 2
"""Nyquist: a record holds no frequencies with fewer samples a period."""


@dataclass(frozen=True)
class RecordedBase(MovingBase):
    """The base moves along the cubic spline through samples; displacement and velocity are continuous.

    The spline begins and ends at rest; before the first sample and after the last one the base stands still.
    The chain is undeformed at the first sample: displacements count from there, and times too.

    Raises
    ------
    ParameterError
        If the samples are too few, not finite, not ascending in time, or all equal.
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

    @classmethod
    def from_csv(cls, file: Path, scale: float = 1.0) -> Self:
        """Read a table of time [s] and displacement [m], separated by a comma, one sample a line.

        A first line of words is a heading; empty lines and lines that begin with # are skipped.

        Parameters
        ----------
        file
            The table.
        scale
            By which displacements are multiplied, > 0.

        Raises
        ------
        ParameterError
            If the file cannot be read, or a line is not a sample; the message names file and line.
        """
        factor = checked_scalar("record scale", scale, "> 0")
        samples = _samples(file)
        if len(samples) < FEWEST_SAMPLES:
            raise ParameterError(f"record {file} has {len(samples)} samples; allowed: at least {FEWEST_SAMPLES}")
        times, displacements = zip(*samples, strict=True)
        try:
            return cls(times, tuple(factor * value for value in displacements))
        except ParameterError as problem:
            raise ParameterError(f"record {file}: {problem}") from None

    @cached_property
    def amplitude(self) -> float:  # type: ignore[override]
        """Largest distance from the first sample [m]."""
        return max(abs(value - self.displacements[0]) for value in self.displacements)

    @property
    def duration(self) -> float:
        """Time from the first sample to the last one [s]."""
        return self.times[-1] - self.times[0]

    @property
    def spacing(self) -> float:
        """Longest time between neighbouring samples [s]."""
        return float(np.max(np.diff(self.times)))

    @property
    def shortest_spacing(self) -> float:
        """Shortest time between neighbouring samples [s]."""
        return float(np.min(np.diff(self.times)))

    def check_resolves(self, angular_frequency: float) -> None:
        """Raise a `ParameterError` unless motions of this frequency [rad/s] are in the record: Nyquist's limit."""
        longest = 2 * np.pi / (SAMPLES_PER_PERIOD * checked_scalar("angular_frequency", angular_frequency, "> 0"))
        if self.spacing > longest * (1 + 1e-9):
            raise ParameterError(
                f"the record is too coarse: samples are up to {self.spacing:g} s apart; allowed: <= {longest:.4g} s, "
                f"half a period of {angular_frequency:g} rad/s"
            )

    def check_time_step(self, time_step: float) -> None:
        """Raise a `ParameterError` unless every sample is met: no step [s] is longer than the shortest spacing."""
        shortest = self.shortest_spacing
        if checked_scalar("time_step", time_step, "> 0") > shortest * (1 + 1e-9):
            raise ParameterError(
                f"time_step = {time_step:g} s would leave out samples of the record; allowed: <= {shortest:g} s, "
                "the shortest time between two of them"
            )

    def displacement(self, time: FloatArray) -> FloatArray:
        """Displacement of the base [m]."""
        return self._spline(self._inside(time))

    def velocity(self, time: FloatArray) -> FloatArray:
        """Velocity of the base [m/s]."""
        return self._spline(self._inside(time), 1)

    def parameters(self) -> dict[str, Any]:
        """Give the kind, how many samples there are, and their hash, ready for JSON."""
        samples = np.array([self.times, self.displacements])
        return {
            "kind": self.kind,
            "amplitude": self.amplitude,
            "duration": self.duration,
            "samples": len(self.times),
            "sha256": hashlib.sha256(samples.astype("<f8").tobytes()).hexdigest(),
        }

    @cached_property
    def _spline(self) -> "CubicSpline":
        from scipy.interpolate import CubicSpline  # SciPy is imported once the base moves

        times, displacements = np.array(self.times), np.array(self.displacements)
        return CubicSpline(times - times[0], displacements - displacements[0], bc_type="clamped")

    def _inside(self, time: FloatArray) -> FloatArray:
        return np.clip(np.asarray(time, dtype=np.float64), 0.0, self.duration)


def _samples(file: Path) -> list[tuple[float, float]]:
    """Read the lines of a table."""
    try:
        with checked_path("record", file).open(newline="", encoding="utf-8") as opened:
            lines = list(csv.reader(opened))
    except (OSError, UnicodeDecodeError, csv.Error) as problem:
        reason = problem.strerror if isinstance(problem, OSError) else problem
        raise ParameterError(f"record {file} cannot be read: {reason}") from None
    samples = [(number, line) for number, line in enumerate(lines, start=1) if not _skipped(line)]
    if samples and len(samples[0][1]) == 2 and not any(_is_number(cell) for cell in samples[0][1]):
        samples = samples[1:]
    return [_sample(file, number, line) for number, line in samples]


def _skipped(line: list[str]) -> bool:
    return not any(cell.strip() for cell in line) or line[0].lstrip().startswith("#")


def _sample(file: Path, number: int, line: list[str]) -> tuple[float, float]:
    """Read one line, or say what is wrong with it."""
    where = f"line {number} of record {file}"
    if len(line) != 2:
        raise ParameterError(f"{where} has {len(line)} columns; allowed: 2, time [s] and displacement [m]")
    for cell in line:
        if not _is_number(cell) or not math.isfinite(float(cell)):
            raise ParameterError(f"{cell.strip()!r} in {where} is not a number; allowed: finite numbers")
    return float(line[0]), float(line[1])


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
