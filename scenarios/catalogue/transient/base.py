"""Broadband and transient base motions: what of them arrives at the end of the chain, by spectra.

Two motions under one drive never drift apart while the normal force is given (friction is monotone), so that
errors of the steps before do not grow, and time series are compared as they are, over the whole motion.
"""

import dataclasses
import math
from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, TypeVar

import numpy as np

from engines.interface.registry import law_of
from engines.interface.variant import Variant
from reference_lcp.chain.drives import MovingBase
from reference_lcp.observables.transmittance import Transmissibility, decibel, transient_transmissibility
from reference_lcp.steady.error_bar import REFINEMENTS
from reference_lcp.validation import FloatArray
from scenarios.catalogue.base import Scenario
from scenarios.catalogue.descriptions import REFERENCE_REFINEMENT, TRANSIENT_EXPECTS
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.parameters import ChainRatios
from scenarios.runs.result import NamedNumbers
from scenarios.runs.task import Recorded, SteadyStateTask
from scenarios.runs.transient_task import TransientTask
from scenarios.verdicts.finding import Comparison, Finding, Metric, Verdict
from scenarios.verdicts.judge import Number, Steps, judge, missing
from scenarios.verdicts.steady_case import REFERENCE

RATIOS = ChainRatios(damping_ratio=0.05, inner_damping_ratio=0.02)
"""The canonical chain with dashpots that let a transient die out: to 1 % of its peak in 300 periods 2π / ω_r."""

RESONATOR_FREQUENCY = RATIOS.chain(0.0).resonator_frequency
"""ω_r [rad/s], whatever the friction."""

PERIOD = 2 * math.pi / RESONATOR_FREQUENCY
"""2π / ω_r [s]."""

BROADBAND_STEPS = 50
"""Coarsest steps to a period 2π / ω_r; the finest of the three step sizes takes four times as many."""

ROWS_PER_PERIOD = 10
"""Rows kept to a period 2π / ω_r: spectra reach five times ω_r, where the chain lets nothing pass any more."""

STEP_REFINEMENT = 2
"""A variant that disagrees, and not by far for a law of its own, is simulated again with so many times as many steps.

Where events fall between the steps is chance, and so is part of an error: three steps may show less of it than there
is. Finer ones then show a smaller error; an engine that is wrong is as wrong with them, and is allowed less.
"""

HARMONIC_FREQUENCY = 0.6
"""η_r of the period in which engine and law are compared: in the pass band, where contacts stick and slip."""

BANDS = {
    "0.3–0.6": (0.3, 0.6),
    "0.65–0.82": (0.65, 0.82),
    "0.9–1.35": (0.9, 1.35),
    "1.5–2": (1.5, 2.0),
}
"""Bands of η_r in which transmissibility is read.

Without friction, and with the dashpots of figure 3, the band of attenuation is 0.853 to 1.414: the third band lies
within, the first and the last outside; the second is where friction widens the attenuation to, or takes it back. The
dashpots of this chain round the edges off, and leave the third band below −35 dB.
"""

BAND_METRICS = {
    name: Metric(f"η_r {name}", "dB", "Root of the last cell's power over the base's, in this band of η_r.")
    for name in BANDS
}
RMS = Metric("rms", "", "Root mean square of the last outer mass over that of the base.")
PEAK = Metric("peak", "", "Largest displacement of the last outer mass over the base's scale.")
DIFFERENCE = Metric(
    "series", "", "Largest difference of the last outer mass from the reference's at any time, over the base's scale."
)


@dataclass(frozen=True)
class TransientCase:
    """One base motion under one friction."""

    friction_ratio: float
    """μ λ_N / (k_c U0): friction for this amplitude, or one over the amplitude for a given friction."""
    base: MovingBase
    periods: int
    """Length of the motion in periods 2π / ω_r of the resonator."""
    steps_per_period: int = BROADBAND_STEPS
    """Coarsest steps to such a period, a multiple of `ROWS_PER_PERIOD`."""

    def task(self, variant: Variant) -> TransientTask:
        """Give the task of a variant, with its coarsest step."""
        return TransientTask(
            variant=variant,
            ratios=RATIOS,
            friction_ratio=self.friction_ratio,
            base=self.base,
            time_step=PERIOD / self.steps_per_period,
            steps=self.periods * self.steps_per_period,
            every=self.steps_per_period // ROWS_PER_PERIOD,
        )

    def base_rows(self) -> FloatArray:
        """Displacement of the base at the rows of every motion, over its scale, shape (rows,)."""
        return self.base.displacement(self.task(REFERENCE).row_times()) / self.base.amplitude

    @property
    def title(self) -> str:
        """As tables print it."""
        return f"μλ_N/(k_c U0) = {self.friction_ratio:g}"


_Transient = TypeVar("_Transient", bound=TransientTask)

Readings = Mapping[Metric, Steps]
"""What is compared, by step size."""


class Broadband(Scenario):
    """A base motion that holds many frequencies, at several amplitudes."""

    source = (
        "Spectra: Bendat and Piersol, Random Data, chapters 6 and 9; chain: figure 3 of Sethi, Banerjee and Manna "
        "with ζ = 0.05, and 0.02 of the resonators."
    )
    expects = TRANSIENT_EXPECTS
    metrics = (*BAND_METRICS.values(), RMS, PEAK, DIFFERENCE)
    friction_ratios: ClassVar[tuple[float, ...]]
    """Cases; zero is the linear chain."""

    @abstractmethod
    def case(self, friction_ratio: float) -> TransientCase:
        """Give the base motion, and how long it is followed."""

    def spectrum(self, base: FloatArray, response: FloatArray, time_step: float) -> Transmissibility:
        """Read the transmissibility of rows that are `time_step` [s] apart: Fourier transforms, unless overridden."""
        return transient_transmissibility(base, response, time_step)

    def parameters(self) -> list[str]:
        """Give chain, base and step sizes; see `Scenario.parameters`."""
        case = self.case(self.friction_ratios[0])
        base = ", ".join(f"{name} {value}" for name, value in case.base.parameters().items())
        steps = ", ".join(str(case.steps_per_period * factor) for factor in REFINEMENTS)
        return [
            f"chain: {', '.join(f'{name} {value}' for name, value in RATIOS.as_data().items())}",
            f"base (SI): {base}",
            f"{case.periods} periods 2π / ω_r, in {steps} steps each",
        ]

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Run every case with every variant; see `Scenario.run`."""
        evaluator.evaluate(self.tasks(variants))
        cases = [self.case(ratio) for ratio in self.friction_ratios]
        exact = {case: self._read(case, self.baseline_task(case), evaluator) for case in cases}
        scheme = {case: self._read(case, case.task(REFERENCE), evaluator) for case in cases}
        findings = []
        for variant in variants:
            for case in cases:
                own = self._read(case, case.task(variant), evaluator)
                judged = self._findings(variant, case, own, exact[case], scheme[case])
                if needs_step_refinement(judged):
                    judged = self._with_refined_steps(variant, case, exact[case], evaluator) or judged
                findings += judged
        return findings

    def _with_refined_steps(
        self, variant: Variant, case: TransientCase, exact: Readings | Comparison, evaluator: Evaluator
    ) -> list[Finding]:
        """Compare with finer steps; nothing where there is no result with them."""
        finer = (case.task(simulated).refined(STEP_REFINEMENT) for simulated in (variant, REFERENCE))
        own, scheme = (self._read(case, task, evaluator) for task in finer)
        if isinstance(own, Comparison):
            return []
        return [_annotated(finding) for finding in self._findings(variant, case, own, exact, scheme)]

    def tasks(self, variants: Sequence[Variant]) -> list[TransientTask]:
        """Give all tasks of `run`."""
        cases = [self.case(ratio) for ratio in self.friction_ratios]
        coarse = [self.baseline_task(case) for case in cases]
        coarse += [case.task(variant) for variant in dict.fromkeys((REFERENCE, *variants)) for case in cases]
        return [task for coarsest in coarse for task in with_refined_steps(coarsest)]

    def period_tasks(self, variant: Variant) -> Mapping[str, SteadyStateTask]:
        """Compare a period of a harmonic motion of the same chain."""
        cases = [self.case(ratio) for ratio in self.friction_ratios]
        return {case.title: harmonic_period(variant, RATIOS, case.friction_ratio) for case in cases}

    def baseline_task(self, case: TransientCase) -> TransientTask:
        """Give the task of the reference, with the coarsest of its three steps."""
        return case.task(REFERENCE).refined(REFERENCE_REFINEMENT)

    def numbers(self, case: TransientCase, response: FloatArray) -> dict[Metric, float]:
        """Read what is compared, but for the series itself, from the rows of a response."""
        base = case.base_rows()
        spectrum = self.spectrum(base, response, PERIOD / ROWS_PER_PERIOD)
        bands = {
            metric: decibel(spectrum.in_band(*(RESONATOR_FREQUENCY * edge for edge in BANDS[name])))
            for name, metric in BAND_METRICS.items()
        }
        rms = float(np.sqrt(np.mean(response**2) / np.mean(base**2)))
        return {**bands, RMS: rms, PEAK: float(np.max(np.abs(response)))}

    def _read(self, case: TransientCase, coarsest: TransientTask, evaluator: Evaluator) -> Readings | Comparison:
        """Read a motion with three step sizes; the response, over the base's scale, is under `DIFFERENCE`."""

        def numbers(series: NamedNumbers) -> dict[Metric, Number]:
            response = np.array(series["response"])
            return {**self.numbers(case, response), DIFFERENCE: response}

        source = "reference" if coarsest.variant.engine == REFERENCE.engine else ""
        return read_refined(coarsest, evaluator, numbers, source)

    def _findings(
        self,
        variant: Variant,
        case: TransientCase,
        own: Readings | Comparison,
        exact: Readings | Comparison,
        scheme: Readings | Comparison,
    ) -> list[Finding]:
        """Compare a variant's reading with the reference's, in finer steps and in the same ones."""
        if isinstance(own, Comparison) or isinstance(exact, Comparison) or isinstance(scheme, Comparison):
            gap = next(reading for reading in (own, exact, scheme) if isinstance(reading, Comparison))
            return Finding.without_numbers(variant, case.title, self.metrics, gap)
        findings = []
        for metric in self.metrics:
            expected = exact[metric]
            comparison = judge(metric, own[metric], expected.judged, bar=expected.error(metric), scheme=scheme[metric])
            numbers = (own[metric].judged, expected.judged)
            value, right = (
                (comparison.difference, 0.0) if metric is DIFFERENCE else (float(number) for number in numbers)
            )
            findings.append(Finding(variant, case.title, metric, value, right, comparison))
        return findings


def harmonic_period(variant: Variant, ratios: ChainRatios, friction_ratio: float) -> SteadyStateTask:
    """Compare a period of a chain, driven where it responds most, with its law's."""
    return SteadyStateTask(
        recorded=Recorded.LAW,
        variant=variant,
        ratios=ratios,
        friction_ratio=friction_ratio,
        frequency_ratio=HARMONIC_FREQUENCY,
    )


def _annotated(finding: Finding) -> Finding:
    """Add to the reason that the steps are refined."""
    reason = f"{finding.comparison.reason}; with {STEP_REFINEMENT} times the default steps"
    return dataclasses.replace(finding, comparison=dataclasses.replace(finding.comparison, reason=reason))


def needs_step_refinement(findings: Sequence[Finding]) -> bool:
    """Whether there is a disagreement that may be chance: without a law that predicts it, or not by far."""
    wrong = [finding for finding in findings if finding.comparison.verdict is Verdict.DISAGREE]
    return any(law_of(finding.variant.preset) is None or not finding.by_far for finding in wrong)


def with_refined_steps(coarsest: _Transient) -> list[_Transient]:
    """Give the tasks of a motion with three step sizes, its own first."""
    return [coarsest.refined(factor) for factor in REFINEMENTS]


def read_refined(
    coarsest: TransientTask,
    evaluator: Evaluator,
    numbers: Callable[[NamedNumbers], Mapping[Metric, Number]],
    source: str = "",
) -> Readings | Comparison:
    """Read `numbers` of a motion with three step sizes; or why there are none, a reason that begins with `source`."""
    tasks = with_refined_steps(coarsest)
    results = evaluator.evaluate(tasks)
    gap = missing(source, results)
    if gap is not None:
        return gap
    read = {task.steps: numbers(result.series) for task, result in zip(tasks, results, strict=True)}
    metrics = next(iter(read.values()))
    return {metric: Steps({steps: values[metric] for steps, values in read.items()}) for metric in metrics}
