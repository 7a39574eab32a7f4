"""A normal force that swings with the drive: friction that follows it, and contacts that open and land.

An actuator presses the masses of every cell together with N(t) = N0 (1 + a sin Ωt), Ω a multiple of the drive's ω.
Across the row nothing else acts, so that λ_N(t) does not depend on the motion along it: friction stays monotone, and
the steady state is unique. For a < 1 contacts stay closed, and every formulation with a variable bound can follow.
For a > 1 they open: the inner mass flies, lands without rebound, and its impact rubs.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import ClassVar

from engines.interface.variant import Variant
from reference_lcp.chain.preload import Flight
from reference_lcp.observables.stick_slip import TimedTransition
from reference_lcp.steady.richardson import amplitude_in_db
from scenarios.catalogue.base import Scenario
from scenarios.catalogue.descriptions import DESCRIPTIONS
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.parameters import Modulation
from scenarios.runs.result import Result
from scenarios.runs.task import Recorded, SteadyStateTask
from scenarios.verdicts.finding import (
    PHASE,
    TRANSMITTANCE,
    Comparison,
    Finding,
    Metric,
    Tolerance,
    amplitude_in_degrees,
    phase_reader,
)
from scenarios.verdicts.judge import Steps, decide, judge, missing
from scenarios.verdicts.steady_case import amplification
from scenarios.verdicts.stick_slip_comparison import matched_errors

CASE_STEPS = (400, 800, 1600)
"""Steps a period of the three results of every case; those with 800 are compared.

An impact falls anywhere in a step, so that the difference of two steps may vanish where the error does not: it takes
a third one, see `reference_lcp.steady.richardson`.
"""

FRICTION_RATIO = 0.3
"""Of the mean normal force: where contacts of figure 3 stick and slip most."""

STUCK = Metric("stuck fraction", "", "part of the period that a contact sticks, of the cell that is furthest off")
UNMATCHED = Metric("unmatched transitions", "", "transitions between stick and slip that only one of the two has")
TIMES = Metric("transition time error", "", "largest distance of matching transitions over the period")
OPEN_FRACTION = Metric(
    "time in the air", "", "part of the period that a contact is open, of the cell that is furthest off"
)
LARGEST_GAP = Metric("largest gap", "U0", "highest point of an inner mass's flight, of the cell that is furthest off")


@dataclass(frozen=True)
class ModulatedCase:
    """A preload and a drive."""

    modulation: float
    multiple: int
    """a and Ω / ω."""
    frequency_ratio: float
    """ω / ω_r."""

    def __str__(self) -> str:
        return f"a = {self.modulation:g}, Ω = {self.multiple} ω, η_r = {self.frequency_ratio:g}"

    def task(self, variant: Variant, steps: int) -> SteadyStateTask:
        """Give the task of a variant."""
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
        lane, _ = self.task(variant, CASE_STEPS[1]).lane()
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

    name = "modulated-normal-force"
    question, expects = DESCRIPTIONS[name]
    source: ClassVar[str] = "equation (7) with a given preload, Sethi, Banerjee and Manna; the flight in closed form"
    metrics: ClassVar[tuple[Metric, ...]] = (TRANSMITTANCE, PHASE, STUCK, UNMATCHED, TIMES, OPEN_FRACTION, LARGEST_GAP)

    def period_tasks(self, variant: Variant) -> Mapping[str, SteadyStateTask]:
        """Compare a period in every case, with the steps that are judged."""
        return {str(case): case.task(variant, CASE_STEPS[1]).recording(Recorded.LAW) for case in CASES}

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Run every case with every variant; see `Scenario.run`."""
        reference = Variant("reference")
        tasks = [
            case.task(variant, steps) for variant in (reference, *variants) for case in CASES for steps in CASE_STEPS
        ]
        results = dict(zip(tasks, evaluator.evaluate(tasks), strict=True))
        findings = []
        for variant in variants:
            for case in CASES:
                own = [results[case.task(variant, steps)] for steps in CASE_STEPS]
                expected = [results[case.task(reference, steps)] for steps in CASE_STEPS]
                findings += _findings(variant, case, own, expected)
        return findings


def _findings(variant: Variant, case: ModulatedCase, own: list[Result], expected: list[Result]) -> list[Finding]:
    """Compare the results of one variant in one case with the reference's."""
    flights = [] if case.modulation <= 1 else [OPEN_FRACTION, LARGEST_GAP]
    metrics = [TRANSMITTANCE, PHASE, STUCK, UNMATCHED, TIMES, *flights]
    gap = _missing("engine", own) or _missing("reference", expected)
    if gap is not None:
        return Finding.without_numbers(variant, str(case), metrics, gap)
    amplified = amplification(expected[1])
    judged = [
        *_response(own, expected, amplified), _stuck_fraction(own, expected), _unmatched(own, expected),
        _transition_times(own, expected), *_flights(case.flight(variant), case.multiple, own),
    ]  # fmt: skip
    return [
        Finding(variant, str(case), metric, value, right, comparison)
        for metric, (value, right, comparison) in zip(metrics, judged, strict=True)
    ]


Judged = tuple[float, float, Comparison]
"""A number, its expected value, and their comparison."""


def _missing(source: str, results: Sequence[Result]) -> Comparison | None:
    """Give the verdict where a result is missing; ``None`` where all are there."""
    gaps = (
        missing(f"{source} at {steps} steps a period", [result])
        for steps, result in zip(CASE_STEPS, results, strict=True)
    )
    return next((gap for gap in gaps if gap is not None), None)


def _steps(values: Iterable[float]) -> Steps:
    """Give numbers of the three steps; the middle one's is judged."""
    return Steps(dict(zip(CASE_STEPS, values, strict=True)), CASE_STEPS[1])


def _judged_beside(metric: Metric, own: Iterable[float], expected: Iterable[float], resolution: float) -> Judged:
    """Judge a number beside the reference's at the same step, whose error bar is its own."""
    steps, right = _steps(own), _steps(expected)
    value, wanted = float(steps.judged), float(right.judged)
    return value, wanted, judge(metric, steps, wanted, bar=right.error(metric), resolution=resolution)


def _response(own: list[Result], expected: list[Result], amplified: float) -> tuple[Judged, Judged]:
    """Judge transmittance and phase; either amplitude is known to the residual of its steady state, amplified."""
    resolution, level = amplified * (own[1].residual + expected[1].residual), expected[1].transmittance_db
    values, wanted = ([result.transmittance_db for result in results] for results in (own, expected))
    size = _judged_beside(TRANSMITTANCE, values, wanted, amplitude_in_db(resolution, level))
    read = phase_reader(expected[1].phase, level)
    value, right, comparison = _judged_beside(
        PHASE, map(read, own), map(read, expected), amplitude_in_degrees(resolution, level)
    )
    return size, (value, right, replace(comparison, per_amplitude=amplitude_in_degrees(1.0, level)))


def _stuck_fraction(own: list[Result], expected: list[Result]) -> Judged:
    judged = []
    for cell in range(len(own[1].stuck_fraction)):
        values, wanted = ([result.stuck_fraction[cell] for result in results] for results in (own, expected))
        # A stick begins and ends to a step.
        changes = sum(number == cell + 1 for number, _, _ in expected[1].transitions)
        judged.append(_judged_beside(STUCK, values, wanted, (changes + 1) / CASE_STEPS[1]))
    return _worst(judged)


def _unmatched(own: list[Result], expected: list[Result]) -> Judged:
    """Judge transitions that only one has; allowed is what either loses or gains from step to step."""
    reference, engine = (max(_apart(*pair) for pair in pairwise(results)) for results in (expected, own))
    count = _apart(own[1], expected[1])
    return count, 0.0, decide(UNMATCHED, count, 0.0, Tolerance(reference=reference, engine=engine))


def _apart(first: Result, second: Result) -> int:
    """Count the transitions that only one of two results has."""
    match = first.matched(second)
    return len(match.missed) + len(match.spurious)


def _transition_times(own: list[Result], expected: list[Result]) -> Judged:
    """Judge the largest distance of matching transitions; its error is the largest of theirs."""
    baseline = expected[1].transitions
    times, scheme = ([matched_errors(result, baseline) for result in results] for results in (own, expected))
    size = max(map(abs, times[1].values()), default=0.0)
    engine, reference = (_largest_error(errors) for errors in (times, scheme))
    tolerance = Tolerance(reference=reference, engine=engine, resolution=1 / CASE_STEPS[1])
    return size, 0.0, decide(TIMES, size, 0.0, tolerance)


def _largest_error(errors: Sequence[Mapping[TimedTransition, float]]) -> float:
    """Largest error of the step over the transitions that all three steps have."""
    common = [transition for transition in errors[1] if all(transition in own for own in errors)]
    return max((_steps(own[transition] for own in errors).error(TIMES) for transition in common), default=0.0)


def _flights(flight: tuple[float, float, float] | None, multiple: int, own: Sequence[Result]) -> list[Judged]:
    """Compare time in the air and largest gap with the exact flight, which is that of every cell."""
    if flight is None:
        return []
    air, highest, fall = flight
    # Lift-off and landing are each met to a step, in every cycle of the preload.
    parts = [(OPEN_FRACTION, [result.open_fraction for result in own], air, 2 * multiple / CASE_STEPS[1]),
             (LARGEST_GAP, [result.largest_gap for result in own], highest, fall)]  # fmt: skip
    return [
        _worst([
            (values[1], exact, judge(metric, _steps(values), exact, resolution=resolution))
            for values in zip(*cells, strict=True)
        ])
        for metric, cells, exact, resolution in parts
    ]  # fmt: skip


def _worst(judged: Sequence[Judged]) -> Judged:
    """Give the one with the largest difference over what is allowed."""
    return max(judged, key=lambda judged_number: judged_number[2].excess)
