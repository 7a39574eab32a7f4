"""The outcome of a comparison, and what is allowed of it."""

import dataclasses
import math
from dataclasses import dataclass
from enum import StrEnum

BY_FAR = 2.0
"""A difference of more than so many times what is allowed is not mended by a better estimate of what is allowed."""


class Verdict(StrEnum):
    """The outcome of a comparison."""

    AGREE = "agree"
    DISAGREE = "disagree"
    TOO_COARSE = "own step too coarse"
    """The number is within what is allowed, but its own step leaves open a large part of what friction changes."""
    INCONCLUSIVE = "inconclusive"
    BLOCKED = "blocked"


@dataclass(frozen=True, kw_only=True)
class Tolerance:
    """How far a number may be from what is expected, part by part; each in the number's unit, >= 0.

    The difference of two step sizes may vanish by chance where the error does not. The error of the step is therefore
    taken to be no smaller than that of the reference at the same step: no engine has to be better than the scheme.

    Parameters
    ----------
    reference
        Error bar of the expected value; zero for a closed form.
    engine
        Estimated error of the engine's value, from its own step sizes.
    scheme
        The same of the reference at the step of the engine.
    resolution
        What neither can resolve: a step of time, the residual of a steady state, creep, round-off.
    given
        A tolerance that is given instead of one that is derived.
    """

    reference: float = 0.0
    engine: float = 0.0
    scheme: float = 0.0
    resolution: float = 0.0
    given: float = 0.0

    @property
    def allowed(self) -> float:
        """Largest difference that counts as agreement."""
        return self.reference + self.step + self.resolution + self.given

    @property
    def step(self) -> float:
        """Part of it that is an error of the time step."""
        return max(self.engine, self.scheme)

    def over(self, slope: float) -> "Tolerance":
        """Give the same of a place on a curve of this slope, every part over its size."""
        return Tolerance(**{part: size / abs(slope) for part, size in dataclasses.asdict(self).items()})

    def __str__(self) -> str:
        parts = {
            "the reference's error bar": self.reference,
            "the engine's own step": self.engine,
            "the error of the reference's scheme at this step": self.scheme,
            "resolution": self.resolution,
            "the tolerance that is given": self.given,
        }
        largest = max(parts, key=lambda what: parts[what])
        return f"{self.allowed:.2g}, mostly {largest} ({parts[largest]:.2g})"


@dataclass(frozen=True)
class Comparison:
    """A verdict with its reason and its numbers.

    Parameters
    ----------
    verdict
        The outcome.
    reason
        What was compared with what, or why it could not be.
    difference
        Engine less reference, in the unit of what is compared; NaN where there is none.
    tolerance
        Largest difference allowed.
    resolution
        Part of it that is not an error of the time step.
    per_amplitude
        What a change of amplitudes makes of the number, per displacement scale; not of numbers in dB, whose changes
        are not in proportion.
    certified
        Whether every steady state behind it is certified; true where none was searched for.
    """

    verdict: Verdict
    reason: str
    difference: float = math.nan
    tolerance: float = math.nan
    resolution: float = 0.0
    per_amplitude: float = 1.0
    certified: bool = True

    @property
    def excess(self) -> float:
        """|Difference| over what is allowed; infinite where nothing is, NaN where there is no number."""
        difference, allowed = abs(self.difference), self.tolerance
        if math.isnan(difference) or math.isnan(allowed):
            return math.nan
        if allowed == 0:
            return 0.0 if difference == 0 else math.inf
        return difference / allowed
