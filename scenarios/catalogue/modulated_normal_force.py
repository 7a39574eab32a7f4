"""A normal force that swings with the drive: friction that follows it, and contacts that open and land.

An actuator presses the masses of every cell together with N(t) = N0 (1 + a sin Ωt), Ω a multiple of the drive's ω.
Across the row nothing else acts, so that λ_N(t) does not depend on the motion along it: friction stays monotone, and
the steady state is unique. For a < 1 contacts stay closed, and every formulation can follow whose bound may change.
For a > 1 they open: the inner mass flies, lands without rebound, and its impact rubs.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import ClassVar

from engines.interface.variant import Variant
from reference_lcp.chain.preload import Flight
from reference_lcp.observables.transition_matching import match_transitions
from scenarios.catalogue.base import Scenario
from scenarios.execution.evaluator import Evaluator
from scenarios.tasks.parameters import Modulation
from scenarios.tasks.result import Result
from scenarios.tasks.task import SteadyStateTask
from scenarios.verdicts.finding import Finding, Metric
from scenarios.verdicts.verdict import SAFETY, Comparison, Tolerance, Verdict, compare, missing_steady_state, scheme_bar

STEPS = (400, 800, 1600)
"""Steps a period of three answers to every case; compared are those with 800.

An impact falls anywhere in a step, so that the difference of two steps may vanish where the error does not: it takes
a third one, as in `reference_lcp.accuracy.error_bar`.
"""

FRICTION_RATIO = 0.3
"""Of the mean normal force: where contacts of figure 3 stick and slip most."""

TRANSMITTANCE = Metric("transmittance", "dB", "20 log10 of the last outer mass's amplitude over the base's")
STUCK = Metric("stuck fraction", "", "part of the period that a contact sticks, of the cell that is furthest off")
UNMATCHED = Metric("unmatched transitions", "", "transitions between stick and slip that only one of the two has")
TIMES = Metric("transition time error", "", "largest distance of matching transitions over the period")
AIR = Metric("time in the air", "", "part of the period that a contact is open, of the cell that is furthest off")
GAP = Metric("largest gap", "U0", "highest point of an inner mass's flight, of the cell that is furthest off")


@dataclass(frozen=True)
class ModulatedCase:
    """A preload and a drive.

    Parameters
    ----------
    modulation, multiple
        a and Ω / ω.
    frequency_ratio
        ω / ω_r.
    """

    modulation: float
    multiple: int
    frequency_ratio: float

    def __str__(self) -> str:
        return f"a = {self.modulation:g}, Ω = {self.multiple} ω, η_r = {self.frequency_ratio:g}"

    def question(self, variant: Variant, steps: int) -> SteadyStateTask:
        """Ask a variant."""
        return SteadyStateTask(
            variant=variant,
            friction_ratio=FRICTION_RATIO,
            frequency_ratio=self.frequency_ratio,
            steps_per_period=steps,
            modulation=Modulation(modulation=self.modulation, multiple=self.multiple),
        )

    def flight(self, variant: Variant) -> tuple[float, float, float] | None:
        """Give the exact part of the period in the air, the largest gap, and how far that falls in a step, over U0.

        ``None`` where contacts stay closed.
        """
        if self.modulation <= 1:
            return None
        lane, _ = self.question(variant, STEPS[1]).lane()
        assert lane.preload is not None
        flight, chain = Flight.of(lane.preload), lane.chain
        length = float(chain.normal_force[0] / chain.inner_mass[0]) / lane.drive.displacement_scale(chain)
        highest = flight.highest * length / lane.preload.angular_frequency**2
        return flight.open_fraction, highest, length * lane.time_step**2


CASES = tuple(
    ModulatedCase(modulation, multiple, frequency)
    for modulation in (0.5, 1.5)
    for multiple in (1, 2)
    for frequency in (0.5, 0.7)
)
"""Below and above lift-off, at the drive's frequency and at twice it; in the pass band, where the error bar is small.

At (1.5, 2 ω, 0.9), deep in the stop band, responses cancel to −37 dB, and 800 steps leave an error bar of 8 dB.
"""


class ModulatedNormalForce(Scenario):
    """The canonical chain under a normal force that swings by a half, and by one and a half, of its mean."""

    name: ClassVar[str] = "modulated-normal-force"
    question: ClassVar[str] = "Does friction follow a normal force that changes in time, until contacts open and land?"
    source: ClassVar[str] = "equation (7) with a given preload, Sethi, Banerjee and Manna; the flight in closed form"
    expects: ClassVar[str] = "the reference at the same step with its error bar; of flights the closed form"
    metrics: ClassVar[tuple[Metric, ...]] = (TRANSMITTANCE, STUCK, UNMATCHED, TIMES, AIR, GAP)

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Put every case to every variant; see `Scenario.run`."""
        reference = Variant("reference")
        asked = [case.question(one, steps) for one in (reference, *variants) for case in CASES for steps in STEPS]
        answers = dict(zip(asked, evaluator.evaluate(asked), strict=True))
        findings = []
        for variant in variants:
            for case in CASES:
                own = [answers[case.question(variant, steps)] for steps in STEPS]
                expected = [answers[case.question(reference, steps)] for steps in STEPS]
                findings += _findings(variant, case, own, expected)
        return findings


def _findings(variant: Variant, case: ModulatedCase, own: list[Result], expected: list[Result]) -> list[Finding]:
    """Compare the answers of one variant to one case with the reference's."""
    found = []
    missing = _missing(own, expected)
    for metric, read in _readings(variant, case).items():
        if missing is not None:
            found.append(Finding(variant, str(case), metric, math.nan, math.nan, missing))
            continue
        reading = read(own, expected)
        comparison = _explained(compare(reading.value, reading.expected, reading.tolerance, metric.unit), variant)
        found.append(Finding(variant, str(case), metric, reading.value, reading.expected, comparison))
    return found


def _readings(variant: Variant, case: ModulatedCase) -> dict[Metric, Callable[[list[Result], list[Result]], "Reading"]]:
    """Say how each metric of a case is read from the answers of a variant and of the reference."""
    readings: dict[Metric, Callable[[list[Result], list[Result]], Reading]] = {
        TRANSMITTANCE: _transmittance,
        STUCK: _stuck_fraction,
        UNMATCHED: _unmatched,
        TIMES: _transition_times,
    }
    flight = case.flight(variant)
    if flight is not None:
        air, highest, fall = flight
        # Lift-off and landing are each met to a step, in every cycle of the preload.
        met = 2 * case.multiple / STEPS[1]
        readings[AIR] = lambda engine, _: _flown([answer.open_fraction for answer in engine], air, met)
        readings[GAP] = lambda engine, _: _flown([answer.largest_gap for answer in engine], highest, fall)
    return readings


@dataclass(frozen=True)
class Reading:
    """A number, what it should be, and how far they may be apart."""

    value: float
    expected: float
    tolerance: Tolerance


def _explained(comparison: Comparison, variant: Variant) -> Comparison:
    """Add the law by which a variant departs from Coulomb's to a disagreement."""
    known_deviation = variant.preset.known_deviation
    if comparison.verdict is not Verdict.DISAGREE or not known_deviation:
        return comparison
    return replace(comparison, reason=f"{comparison.reason}; {known_deviation}")


def _missing(own: list[Result], expected: list[Result]) -> Comparison | None:
    """Say what is missing for a comparison, if anything is."""
    for whose, answers in (("engine", own), ("reference", expected)):
        for steps, answer in zip(STEPS, answers, strict=True):
            gap = missing_steady_state(f"{whose} at {steps} steps a period", answer)
            if gap is not None:
                return gap
    return None


def _transmittance(own: list[Result], expected: list[Result]) -> Reading:
    values, baselines = [one.transmittance_db for one in own], [one.transmittance_db for one in expected]
    # Either amplitude is known to the residual of its steady state.
    residual = (own[1].residual + expected[1].residual) / 10 ** (expected[1].transmittance_db / 20)
    return Reading(values[1], baselines[1], _tolerance(values, baselines, 20 * math.log10(1 + residual)))


def _stuck_fraction(own: list[Result], expected: list[Result]) -> Reading:
    readings = []
    for cell in range(len(own[1].stuck_fraction)):
        values, baselines = ([one.stuck_fraction[cell] for one in answers] for answers in (own, expected))
        # A stick begins and ends to a step.
        changes = sum(number == cell + 1 for number, _, _ in expected[1].transitions)
        readings.append(Reading(values[1], baselines[1], _tolerance(values, baselines, (changes + 1) / STEPS[1])))
    return _worst(readings)


def _unmatched(own: list[Result], expected: list[Result]) -> Reading:
    """Those that only one has; the reference misses some of its own at another step, and so may an engine."""
    reference, engine = (max(_apart(*pair)[0] for pair in pairwise(answers)) for answers in (expected, own))
    return Reading(_apart(own[1], expected[1])[0], 0.0, Tolerance(reference, engine))


def _transition_times(own: list[Result], expected: list[Result]) -> Reading:
    # What the steps of 400 and 800 differ by is the error of the latter; what those of 800 and 1600 do, half of it.
    reference, engine = (
        SAFETY * max(_apart(*answers[:2])[1], 2 * _apart(*answers[1:])[1]) for answers in (expected, own)
    )
    return Reading(_apart(own[1], expected[1])[1], 0.0, Tolerance(reference, engine, 1 / STEPS[1]))


def _apart(one: Result, other: Result) -> tuple[int, float]:
    """Count the transitions that only one has, and give the largest distance of those that both have."""
    match = match_transitions(one.transitions, other.transitions, other.period)
    largest = max((abs(error) for error in match.time_errors), default=0.0)
    return len(match.missed) + len(match.spurious), largest


def _flown(values: list[tuple[float, ...]], exact: float, resolution: float) -> Reading:
    """Compare with the exact flight, which is that of every cell."""
    cells = zip(*values, strict=True)
    return _worst([Reading(one[1], exact, Tolerance(0.0, scheme_bar(*one), resolution)) for one in cells])


def _tolerance(own: Sequence[float], expected: Sequence[float], resolution: float) -> Tolerance:
    """Derive it from three steps of either."""
    return Tolerance(scheme_bar(*expected), scheme_bar(*own), resolution)


def _worst(readings: list[Reading]) -> Reading:
    """Give the one that is furthest off for its tolerance."""
    return max(readings, key=lambda one: abs(one.value - one.expected) / one.tolerance.allowed)
