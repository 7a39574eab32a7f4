"""Broadband and transient base motions: what of them arrives at the end of the chain, by spectra.

Two motions under one drive never drift apart while the normal force is given (friction is monotone), so that
errors of the steps before do not grow, and time series are compared as they are, over the whole motion.
"""

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import ClassVar

import numpy as np

from multibody_xval.engines.interface.registry import law_of
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.descriptions import REFERENCE_REFINEMENT
from multibody_xval.scenarios.catalogue.motion import (
    MotionScenario,
    NothingToCompare,
    Read,
    refined_counts,
    with_refined_steps,
)
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.task import Recorded, SteadyStateTask
from multibody_xval.scenarios.runs.transient_task import TransientTask
from multibody_xval.scenarios.verdicts.finding import Finding, Metric, Verdict
from multibody_xval.scenarios.verdicts.judge import Number, metric_difference
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from reference_lcp.chain.drives import HarmonicBase, MovingBase
from reference_lcp.chain.linear_response import frictionless_response, stuck_response
from reference_lcp.observables.transmittance import Transmissibility, decibel, transient_transmissibility
from reference_lcp.validation import FloatArray

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

    def __str__(self) -> str:
        return f"μλ_N/(k_c U0) = {self.friction_ratio:g}"


class Broadband(MotionScenario[TransientCase]):
    """A base motion that holds many frequencies, at several amplitudes."""

    source = (
        "Spectra: Bendat and Piersol, Random Data, chapters 6 and 9; chain: figure 3 of Sethi, Banerjee and Manna "
        "with ζ = 0.05, and 0.02 of the resonators."
    )
    metrics = (*BAND_METRICS.values(), RMS, PEAK, DIFFERENCE)
    friction_ratios: ClassVar[tuple[float, ...]]
    """Cases; zero is the linear chain."""

    @abstractmethod
    def case(self, friction_ratio: float) -> TransientCase:
        """Give the base motion, and how long it is followed."""

    @property
    def cases(self) -> Sequence[TransientCase]:
        """One a friction ratio."""
        return [self.case(ratio) for ratio in self.friction_ratios]

    def spectrum(self, base: FloatArray, response: FloatArray, time_step: float) -> Transmissibility:
        """Read the transmissibility of rows that are `time_step` [s] apart: Fourier transforms, unless overridden."""
        return transient_transmissibility(base, response, time_step)

    def parameters(self) -> list[str]:
        """Give chain, base and step sizes; see `Scenario.parameters`."""
        case = self.cases[0]
        base = ", ".join(f"{name} {value}" for name, value in case.base.parameters().items())
        return [
            f"chain: {', '.join(f'{name} {value}' for name, value in RATIOS.as_data().items())}",
            f"base (SI): {base}",
            f"{case.periods} periods 2π / ω_r, in {refined_counts(case.steps_per_period)} steps each",
        ]

    def baseline(self, case: TransientCase) -> list[TransientTask]:
        """Give the tasks of the reference with finer steps."""
        return with_refined_steps(case.task(REFERENCE).refined(REFERENCE_REFINEMENT))

    def period_tasks(self, variant: Variant) -> Mapping[str, SteadyStateTask]:
        """Compare a period of a harmonic motion of the same chain."""
        return {str(case): harmonic_period(variant, RATIOS, case.friction_ratio) for case in self.cases}

    def numbers(self, case: TransientCase, series: NamedNumbers) -> Mapping[Metric, Number]:
        """Read spectra, sizes and the response itself, over the base's scale."""
        base, response = case.base_rows(), np.array(series["response"])
        spectrum = self.spectrum(base, response, PERIOD / ROWS_PER_PERIOD)
        bands = {
            metric: decibel(spectrum.in_band(*(RESONATOR_FREQUENCY * edge for edge in BANDS[name])))
            for name, metric in BAND_METRICS.items()
        }
        rms = float(np.sqrt(np.mean(response**2) / np.mean(base**2)))
        return {**bands, RMS: rms, PEAK: float(np.max(np.abs(response))), DIFFERENCE: response}

    def judged(self, variant: Variant, case: TransientCase, evaluator: Evaluator) -> list[Finding]:
        """Compare with the reference in finer steps, once more with finer steps where a disagreement may be chance."""
        read = self.read_beside(case, case.task(variant), evaluator)
        findings = self._findings(variant, case, read)
        if not needs_step_refinement(findings):
            return findings
        finer = (with_refined_steps(case.task(each).refined(STEP_REFINEMENT)) for each in (variant, REFERENCE))
        try:
            own, scheme = (self.read(case, tasks, evaluator) for tasks in finer)
        except NothingToCompare:
            return findings
        read = read._replace(own=own, scheme=scheme)
        return [_annotated(finding) for finding in self._findings(variant, case, read)]

    def _findings(self, variant: Variant, case: TransientCase, read: Read) -> list[Finding]:
        """Judge every number; friction changes it by its distance to the farther one of two linear chains."""
        limits = [
            self.numbers(case, {"response": response}) for response in linear_limits(replace(case, friction_ratio=0.0))
        ]
        effects = {
            metric: max(abs(metric_difference(metric, limit[metric], expected.judged)) for limit in limits)
            for metric, expected in read.expected.items()
        }
        return [read.finding(variant, case, metric, effect=effects[metric]) for metric in self.metrics]


@cache
def linear_limits(case: TransientCase) -> list[tuple[float, ...]]:
    """Give the response at all rows with contacts that slide freely, and that never slide, by Fourier transforms."""
    import scipy.fft  # SciPy is imported once a motion is judged

    chain, rows = RATIOS.chain(case.friction_ratio), case.base_rows()
    length = 2 * rows.size  # what is left after the motion dies out in as long a rest
    angular_frequency = 2 * np.pi * scipy.fft.rfftfreq(length, PERIOD / ROWS_PER_PERIOD)[1:]
    spectrum = scipy.fft.rfft(rows, length)
    limits = []
    for response in (frictionless_response, stuck_response):
        passed = [response(chain, HarmonicBase(1.0, omega))[chain.cells - 1] for omega in angular_frequency.tolist()]
        motion = scipy.fft.irfft(np.array([1.0, *passed]) * spectrum, length)[: rows.size]
        limits.append(tuple(motion.tolist()))
    return limits


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
    return replace(finding, comparison=replace(finding.comparison, reason=reason))


def needs_step_refinement(findings: Sequence[Finding]) -> bool:
    """Whether there is a disagreement that may be chance: without a law that predicts it, or not by far."""
    wrong = [finding for finding in findings if finding.comparison.verdict is Verdict.DISAGREE]
    return any(law_of(finding.variant.preset) is None or not finding.by_far for finding in wrong)
