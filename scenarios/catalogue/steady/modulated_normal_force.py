"""A normal force that swings with the drive: friction that follows it, and contacts that open and land.

An actuator presses the masses of every cell together with N(t) = N0 (1 + a sin Ωt), Ω a multiple of the drive's ω.
Across the row nothing else acts, so that λ_N(t) does not depend on the motion along it: friction stays monotone, and
the steady state is unique. For a < 1 contacts stay closed, and every formulation with a variable bound can follow.
For a > 1 they open: the inner mass flies, lands without rebound, and its impact rubs.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import NamedTuple

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.base import Scenario
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.parameters import Modulation
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.task import Recorded, SteadyStateTask
from multibody_xval.scenarios.verdicts.finding import (
    PHASE,
    TRANSMITTANCE,
    Comparison,
    Finding,
    Metric,
    Tolerance,
    amplitude_in_degrees,
)
from multibody_xval.scenarios.verdicts.judge import Steps, decide, friction_effect, judge, missing, response_readers
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE, amplification
from multibody_xval.scenarios.verdicts.stick_slip_comparison import QUARTER_PERIOD, WHOLE_PERIOD
from reference_lcp.chain.preload import Flight
from reference_lcp.observables.stick_slip import TimedTransition
from reference_lcp.steady.richardson import amplitude_in_db

CASE_STEPS = (400, 800, 1600)
"""Steps a period of the three results of every case; those with 800 are compared.

An impact falls anywhere in a step, so that the difference of two steps may vanish where the error does not: it takes
a third one, see `reference_lcp.steady.richardson`.
"""

FRICTION_RATIO = 0.3
"""Of the mean normal force: where contacts of figure 3 stick and slip most."""

STUCK = Metric(
    "stuck fraction",
    "",
    "part of the period that a contact sticks, of the cell that is furthest off",
    effect=WHOLE_PERIOD,
)
UNMATCHED = Metric("unmatched transitions", "", "transitions between stick and slip that only one of the two has")
TIMES = Metric(
    "transition time error", "", "largest distance of matching transitions over the period", effect=QUARTER_PERIOD
)
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
    source = "equation (7) with a given preload, Sethi, Banerjee and Manna; the flight in closed form"
    metrics = (TRANSMITTANCE, PHASE, STUCK, UNMATCHED, TIMES, OPEN_FRACTION, LARGEST_GAP)

    def period_tasks(self, variant: Variant) -> Mapping[str, SteadyStateTask]:
        """Compare a period in every case, with the steps that are judged."""
        return {str(case): case.task(variant, CASE_STEPS[1]).recording(Recorded.LAW) for case in CASES}

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Run every case with every variant; see `Scenario.run`."""
        places = [(variant, case) for variant in (REFERENCE, *variants) for case in CASES]
        tasks = [case.task(variant, steps) for variant, case in places for steps in CASE_STEPS]
        results = dict(zip(tasks, evaluator.evaluate(tasks), strict=True))
        by_steps = {(variant, case): [results[case.task(variant, steps)] for steps in CASE_STEPS]
                    for variant, case in places}  # fmt: skip
        return [
            finding
            for variant, case in places[len(CASES) :]
            for finding in _Motions(variant, case, by_steps[variant, case], by_steps[REFERENCE, case]).findings()
        ]


class _Motions(NamedTuple):
    """The results of a variant in one case, beside the reference's with the same steps."""

    variant: Variant
    case: ModulatedCase
    own: list[Result]
    expected: list[Result]

    def findings(self) -> list[Finding]:
        """Compare everything; flights only where there are some."""
        gap = _missing("engine", self.own) or _missing("reference", self.expected)
        if gap is None:
            return [*self._response(), self._stuck_fraction(), self._unmatched(), self._times(), *self._flights()]
        metrics = ModulatedNormalForce.metrics[: None if self.case.modulation > 1 else -2]
        return Finding.without_numbers(self.variant, str(self.case), metrics, gap)

    def _finding(self, metric: Metric, value: float, expected: float, comparison: Comparison) -> Finding:
        return Finding(self.variant, str(self.case), metric, value, expected, comparison)

    def _beside(
        self, metric: Metric, read: Callable[[Result], float], resolution: float, effect: float | None = None
    ) -> Finding:
        """Judge a number beside the reference's at the same step, whose error bar is its own."""
        steps, right = _steps(map(read, self.own)), _steps(map(read, self.expected))
        expected = float(right.judged)
        comparison = judge(metric, steps, expected, bar=right.error(metric), resolution=resolution, effect=effect)
        return self._finding(metric, float(steps.judged), expected, comparison)

    def _response(self) -> tuple[Finding, Finding]:
        """Judge transmittance and phase; either amplitude is known to the residual of its steady state, amplified."""
        own, expected = self.own[1], self.expected[1]
        left, level = amplification(expected) * (own.residual + expected.residual), expected.transmittance_db
        effect = friction_effect(*self.case.task(REFERENCE, CASE_STEPS[1]).setting(), level, expected.phase)
        resolution = {TRANSMITTANCE: amplitude_in_db(left, level), PHASE: amplitude_in_degrees(left, level)}
        size, phase = (
            self._beside(metric, read, resolution[metric], effect[metric])
            for metric, read in response_readers(level, expected.phase).items()
        )
        comparison = replace(phase.comparison, per_amplitude=amplitude_in_degrees(1.0, level))
        return size, replace(phase, comparison=comparison)

    def _stuck_fraction(self) -> Finding:
        """Judge the worst contact; a stick begins and ends to a step."""
        changes = Counter(cell for cell, _, _ in self.expected[1].transitions)
        return _worst(
            self._beside(STUCK, partial(_stuck, cell), (changes[cell] + 1) / CASE_STEPS[1])
            for cell in range(1, len(self.own[1].stuck_fraction) + 1)
        )

    def _unmatched(self) -> Finding:
        """Judge transitions that only one has, of all that there are; what either has by its step alone is allowed."""
        reference, engine = (
            max(first.matched(second.transitions).unmatched for first, second in pairwise(results))
            for results in (self.expected, self.own)
        )
        transitions = self.expected[1].transitions
        count = self.own[1].matched(transitions).unmatched
        comparison = decide(UNMATCHED, count, 0.0, Tolerance(reference=reference, engine=engine), len(transitions))
        return self._finding(UNMATCHED, count, 0.0, comparison)

    def _times(self) -> Finding:
        """Judge the largest distance of matching transitions; its error is the largest of theirs."""
        own, expected = (
            [result.matched(self.expected[1].transitions).errors for result in results]
            for results in (self.own, self.expected)
        )
        size = max(map(abs, own[1].values()), default=0.0)
        tolerance = Tolerance(
            reference=_largest_error(expected), engine=_largest_error(own), resolution=1 / CASE_STEPS[1]
        )
        return self._finding(TIMES, size, 0.0, decide(TIMES, size, 0.0, tolerance))

    def _flights(self) -> list[Finding]:
        """Compare time in the air and largest gap with the exact flight, which is that of every cell."""
        flight = self.case.flight(self.variant)
        if flight is None:
            return []
        air, highest, fall = flight
        # Lift-off and landing are each met to a step, in every cycle of the preload.
        edges = 2 * self.case.multiple / CASE_STEPS[1]
        parts = [
            (OPEN_FRACTION, [result.open_fraction for result in self.own], air, edges),
            (LARGEST_GAP, [result.largest_gap for result in self.own], highest, fall),
        ]
        return [
            _worst(
                self._finding(metric, values[1], exact, judge(metric, _steps(values), exact, resolution=resolution))
                for values in zip(*cells, strict=True)
            )
            for metric, cells, exact, resolution in parts
        ]


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


def _stuck(cell: int, result: Result) -> float:
    return result.stuck_fraction[cell - 1]


def _largest_error(times: Sequence[Mapping[TimedTransition, float]]) -> float:
    """Give the largest error of the step over the transitions that all three steps have."""
    common = [change for change in times[1] if all(change in own for own in times)]
    return max((_steps(own[change] for own in times).error(TIMES) for change in common), default=0.0)


def _worst(findings: Iterable[Finding]) -> Finding:
    """Give the one with the largest difference over what is allowed."""
    return max(findings, key=lambda own: own.excess)
