"""Findings: one number of one variant with its verdict, and which of them fail a run.

What fails are disagreements that no law predicts, and presets about which too little is known. A finding *says nothing*
where the engine fails, where there is no certified steady state, or where the own step is too coarse. Without a limit
on them, an engine that is never certified, or always crashes, would pass every comparison. Not counted are findings of
which the law of the preset says the same, and steps that are too coarse for the reference's scheme as well, which the
preset shares.
"""

import dataclasses
import math
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result
from reference_lcp.errors import shortened

BY_FAR = 2.0
"""A difference of more than so many times what is allowed is not mended by a better estimate of what is allowed."""


class Verdict(StrEnum):
    """The outcome of a comparison."""

    AGREE = "agree"
    DISAGREE = "disagree"
    TOO_COARSE = "own step too coarse"
    """The number is within what is allowed, but errors of steps leave open a large part of what friction changes of it,
    or of its size."""
    INCONCLUSIVE = "inconclusive"
    BLOCKED = "blocked"


@dataclass(frozen=True, kw_only=True)
class Tolerance:
    """How far a number may be from what is expected, part by part; each in the number's unit, >= 0.

    The difference of two step sizes may vanish by chance where the error does not. The error of the step is therefore
    taken to be no smaller than that of the reference at the same step: no engine has to be better than the scheme.
    """

    reference: float = 0.0
    """Error bar of the expected value; zero for a closed form."""
    engine: float = 0.0
    """Estimated error of the engine's value, from its own step sizes."""
    scheme: float = 0.0
    """The same of the reference at the step of the engine."""
    resolution: float = 0.0
    """What neither can resolve: a step of time, the residual of a steady state, creep, round-off."""
    given: float = 0.0
    """A tolerance that is given instead of one that is derived."""

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
    """A verdict with its reason and its numbers."""

    verdict: Verdict
    reason: str
    """What was compared with what, or why it could not be."""
    difference: float = math.nan
    """Engine less reference, in the unit of what is compared; NaN where there is none."""
    tolerance: float = math.nan
    resolution: float = 0.0
    """Part of it that is not an error of the time step."""
    per_amplitude: float = 1.0
    """What a change of amplitudes makes of the number, per displacement scale; not of numbers in dB, whose changes are
    not in proportion."""
    certified: bool = True
    """Whether every steady state behind it is certified; true where none was searched for."""
    failed: bool = False
    """Whether the engine was run and gave nothing: a crash, the time limit, numbers that are not finite."""

    @property
    def excess(self) -> float:
        """|Difference| over what is allowed; infinite where nothing is, NaN where there is no number."""
        difference, allowed = abs(self.difference), self.tolerance
        if math.isnan(difference) or math.isnan(allowed):
            return math.nan
        if allowed == 0:
            return 0.0 if difference == 0 else math.inf
        return difference / allowed


FLOOR_DB = -60.0
"""Below this transmittance differences are those of amplitudes, as large in dB as they are at the floor.

A thousandth of the base's motion is where creep of regularised friction and bristle oscillations,
both proportional to the friction bound and not to the response, become as large as the response.
"""


@dataclass(frozen=True)
class Metric:
    """A number that is compared."""

    name: str
    unit: str
    """Of its values; empty for a pure number."""
    meaning: str
    floor_db: float = -math.inf
    """Of a metric in dB: below it, differences are those of amplitudes."""
    effect: float | None = None
    """How much friction changes it at all, in its unit, where that is the same in every case; without it, the size of
    what is expected counts."""

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
    """What the law of an engine says of a number, and how near the engine is to its law."""

    value: float
    difference: float
    allowed: float
    distance: float
    """Largest difference of positions over a period from the same state, over the displacement scale."""
    period_bound: float
    certified: bool = True
    """Whether the steady state of the law is certified."""
    reason: str = ""
    """Why no motion was compared with the law's, or why the law does not claim to hold; empty elsewhere."""

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
    """One number of one variant, and whether it is what it should be."""

    variant: Variant
    case: str
    """The parameters that distinguish this case from the others of the scenario, as tables print them."""
    metric: Metric
    value: float
    expected: float
    """The variant's number, and what it is compared with; NaN where there is none."""
    comparison: Comparison
    prediction: Prediction | None = None
    """What the law of the variant says of a disagreement; ``None`` where it has none, or the number agrees."""

    @property
    def excess(self) -> float:
        """The difference over what is allowed; −1 where there is none."""
        return -1.0 if math.isnan(self.comparison.excess) else self.comparison.excess

    @property
    def modelled(self) -> bool:
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


PHASE = Metric("phase", "°", "by which the fundamental of the last outer mass is ahead of the drive's sine")


def phase_reader(expected: float, transmittance_db: float) -> Callable[[Result], float]:
    """Give what reads the phase of a result [°], within half a turn of the expected one [rad].

    Below the floor of `TRANSMITTANCE` differences are those of amplitudes, as there: a phase counts less and less.
    """
    weight = 10 ** (min(0.0, transmittance_db - FLOOR_DB) / 20)

    def read(result: Result) -> float:
        return math.degrees(expected + weight * math.remainder(result.phase - expected, 2 * math.pi))

    return read


def amplitude_in_degrees(amplitude: float, transmittance_db: float) -> float:
    """What a change of the amplitude, over U0, makes of the phase at this transmittance [°]; at most half a turn."""
    return min(180.0, math.degrees(amplitude * 10 ** (-max(transmittance_db, FLOOR_DB) / 20)))


LONGEST_LIST = 200
"""Characters in which the cases are named in which an engine fails."""

MOST_SILENT = 0.25
"""Largest share of a preset's findings that may say nothing: a case of the four that most scenarios have."""


def unmodelled(findings: Sequence[Finding]) -> list[Finding]:
    """Give the disagreements that no law predicts; so is a step that is too coarse, and not as the law has it."""
    return [finding for finding in findings if _deviates(finding) and not finding.modelled]


def silent(findings: Sequence[Finding]) -> list[Finding]:
    """Give the findings that say nothing."""
    return [finding for finding in findings if _says_nothing(finding)]


def failing(findings: Sequence[Finding]) -> list[Finding]:
    """Give the findings of a scenario why it fails: unmodelled ones, and silent ones of a preset with many."""
    fails = {id(finding) for finding in unmodelled(findings)}
    for variant in dict.fromkeys(finding.variant for finding in findings):
        fails |= {id(finding) for finding in _too_silent([own for own in findings if own.variant == variant])}
    return [finding for finding in findings if id(finding) in fails]


def failures(findings: Sequence[Finding]) -> list[str]:
    """Say in a line each why the findings of a scenario are a failure; none where they are not."""
    lines = []
    wrong = unmodelled(findings)
    if wrong:
        what = "disagreement" if len(wrong) == 1 else "disagreements"
        names = ", ".join(dict.fromkeys(str(finding.variant) for finding in wrong))
        lines.append(f"unmodelled: {len(wrong)} {what}, of {names}")
    for variant in dict.fromkeys(finding.variant for finding in findings):
        own = [finding for finding in findings if finding.variant == variant]
        nothing = len(_too_silent(own))
        if nothing:
            lines.append(
                f"{variant}: {nothing} of {len(_asked(own))} numbers without a certified steady state, with too coarse "
                f"a step, or of an engine that fails; allowed: {MOST_SILENT:.0%}"
            )
    return lines


def engine_failures(findings: Sequence[Finding]) -> list[str]:
    """Say in a line each, by variant and reason without its numbers, where an engine fails, be it once."""
    groups: dict[tuple[Variant, str], list[Finding]] = {}
    for finding in findings:
        if finding.comparison.failed:
            kind = re.sub(r"\S*\d\S*", "", finding.comparison.reason)
            groups.setdefault((finding.variant, kind), []).append(finding)
    lines = []
    for (variant, _), own in groups.items():
        numbers = "1 number" if len(own) == 1 else f"{len(own)} numbers"
        cases = "; ".join(dict.fromkeys(finding.case for finding in own))
        lines.append(f"{variant} fails at {numbers} of {shortened(cases, LONGEST_LIST)}: {own[0].comparison.reason}")
    return lines


def _too_silent(own: Sequence[Finding]) -> list[Finding]:
    """Give the findings of a preset that say nothing, where they are more than `MOST_SILENT` of all; none otherwise."""
    nothing = silent(own)
    return nothing if len(nothing) > MOST_SILENT * len(_asked(own)) else []


def _asked(own: Sequence[Finding]) -> list[Finding]:
    """Give the findings but for those of which the engine says that it cannot, or is not there."""
    return [each for each in own if each.comparison.verdict is not Verdict.BLOCKED or each.comparison.failed]


def _deviates(finding: Finding) -> bool:
    verdict = finding.comparison.verdict
    return verdict is Verdict.DISAGREE or (verdict is Verdict.TOO_COARSE and finding.prediction is not None)


def _says_nothing(finding: Finding) -> bool:
    prediction = finding.prediction
    if finding.comparison.failed:
        return True
    if not finding.comparison.certified:
        return prediction is None or prediction.certified or not prediction.holds
    if finding.comparison.verdict is not Verdict.TOO_COARSE or finding.variant.preset.shares_scheme:
        return False
    return prediction is None
