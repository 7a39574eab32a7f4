"""Metrics, and findings: one number of one variant with its verdict."""

import dataclasses
import math
from collections.abc import Iterable
from dataclasses import dataclass

from engines.interface.variant import Variant
from scenarios.verdicts.verdict import BY_FAR, Comparison

FLOOR_DB = -60.0
"""Below this transmittance differences are those of amplitudes, as large in dB as they are at the floor.

A thousandth of the base's motion is where creep of regularised friction and bristle oscillations,
both proportional to the friction bound and not to the response, become as large as the response.
"""


@dataclass(frozen=True)
class Metric:
    """A number that is compared.

    Parameters
    ----------
    name
        As tables print it.
    unit
        Of its values; empty for a pure number.
    meaning
        What it is, in a sentence.
    floor_db
        Of a metric in dB: below it, differences are those of amplitudes.
    """

    name: str
    unit: str
    meaning: str
    floor_db: float = -math.inf

    def scaled(self, value: float) -> float:
        """Give a value on the scale on which differences are taken.

        That is the value itself, but below the floor f [dB], where it is f + 20 / ln 10 (A / A_f − 1) of the amplitude
        A = 10^(value / 20): linear in the amplitude, with the slope that dB have at the floor.
        """
        if not value < self.floor_db:
            return value
        return self.floor_db + 20 / math.log(10) * (10 ** ((value - self.floor_db) / 20) - 1)


TRANSMITTANCE = Metric(
    "transmittance", "dB", "20 log10 of the last outer mass's fundamental amplitude over the base's", FLOOR_DB
)


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """What the law of an engine says of a number, and how near the engine is to its law.

    Parameters
    ----------
    value
        The number, of the law's own motion.
    difference
        Engine less law, on the scale of the metric.
    allowed
        Largest difference that both leave open.
    distance
        Largest difference of positions over a period from the same state, over the displacement scale.
    period_bound
        Largest one that the law allows.
    certified
        Whether the steady state of the law is certified.
    reason
        Why no motion was compared with the law's, or why the law does not claim to hold; empty elsewhere.
    """

    value: float
    difference: float
    allowed: float
    distance: float
    period_bound: float
    certified: bool = True
    reason: str = ""

    def __str__(self) -> str:
        if not self.certified:
            return f"its law has no certified steady state either; {self._period}"
        return (
            f"its law gives {self.value:.4g}, {self.difference:+.2g} left, allowed {self.allowed:.2g}; {self._period}"
        )

    @property
    def _period(self) -> str:
        if math.isnan(self.distance) and self.reason:
            return f"its motion is not compared with the law's: {self.reason}"
        known = f" ({self.reason})" if self.reason else ""
        return f"after a period {self.distance:.2g} U0 from its law, allowed {self.period_bound:.2g}{known}"

    @property
    def holds(self) -> bool:
        """Whether the engine does what its law says."""
        return abs(self.difference) <= self.allowed and self.distance <= self.period_bound


@dataclass(frozen=True)
class Finding:
    """One number of one variant, and whether it is what it should be.

    Parameters
    ----------
    variant
        Whose number it is.
    case
        The parameters that distinguish this case from the others of the scenario, as tables print them.
    metric
        What was compared.
    value, expected
        The variant's number, and what it is compared with; NaN where there is none.
    comparison
        The verdict with its reason.
    prediction
        What the law of the variant says of a disagreement; ``None`` where it has none, or the number agrees.
    """

    variant: Variant
    case: str
    metric: Metric
    value: float
    expected: float
    comparison: Comparison
    prediction: Prediction | None = None

    @property
    def as_predicted(self) -> bool:
        """Whether the law of the variant predicts a disagreement."""
        return self.prediction is not None and self.prediction.holds

    def uncertified(self) -> "Finding":
        """Give the same of a steady state that is not certified."""
        return dataclasses.replace(self, comparison=dataclasses.replace(self.comparison, certified=False))

    @property
    def by_far(self) -> bool:
        """Whether the difference is so large that no better estimate of the error of steps would mend it."""
        return self.comparison.excess > BY_FAR

    @classmethod
    def without_numbers(
        cls, variant: Variant, case: str, metrics: Iterable[Metric], comparison: Comparison
    ) -> list["Finding"]:
        """Give a finding a metric where nothing could be compared, with the reason."""
        return [cls(variant, case, metric, math.nan, math.nan, comparison) for metric in metrics]
