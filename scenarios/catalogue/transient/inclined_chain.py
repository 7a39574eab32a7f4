"""Inclined chain: seven cells whose contacts are inclined to the row, so that normal forces depend on the motion."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from engines.interface.variant import Variant
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.steady.error_bar import REFINEMENTS
from scenarios.catalogue.base import Scenario, motion_distance
from scenarios.catalogue.descriptions import DESCRIPTIONS, INCLINED_REFINEMENT
from scenarios.catalogue.transient.base import PERIOD, RATIOS, Readings, read_refined, with_refined_steps
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.parameters import Modulation
from scenarios.runs.result import NamedNumbers
from scenarios.runs.transient import OPEN_GAP
from scenarios.runs.transient_task import InclinedTask
from scenarios.verdicts.finding import Comparison, Finding, Metric
from scenarios.verdicts.judge import Number, judge
from scenarios.verdicts.prediction import LawPeriod
from scenarios.verdicts.steady_case import REFERENCE

STEPS_PER_PERIOD = 200
"""Coarsest steps to a period of the base."""

ROWS_PER_PERIOD = 50
"""Rows kept to a period of the base."""

PERIODS = 3
"""Of the base: contacts have then slipped both ways, and parted and met some five times where they do."""

RESPONSE = Metric("series", "", "Largest difference of the last outer mass from the reference's, over U0.")
SLIPS = Metric("slips", "", "Largest difference of v − u of any cell from the reference's, over U0.")
HIGHEST = Metric("highest", "", "Largest gap of any contact over U0.")
OPEN = Metric("open", "", "Part of the time in which a contact is open, mean of all contacts.")
LANDINGS = Metric("landings", "", "Changes from open to closed, of all contacts.")

RESOLUTION = {
    OPEN: 2 / STEPS_PER_PERIOD / max(REFINEMENTS),
    HIGHEST: OPEN_GAP,
}
"""Where a contact opens and closes is read to a step, at either end; a contact with a smaller gap is none that is
open."""

SERIES = {RESPONSE: "response", SLIPS: "slips"}
"""Metrics of which the largest difference at any time counts."""


class Inclined(NamedTuple):
    """One case: friction, frequency, inclination [°], and the modulation of the force that presses."""

    title: str
    friction_ratio: float
    frequency_ratio: float
    angle: float
    modulation: float = 0.0

    def task(self, variant: Variant) -> InclinedTask:
        """Give the task of a variant, with its coarsest step."""
        chain = RATIOS.chain(self.friction_ratio)
        return InclinedTask(
            variant=variant,
            ratios=RATIOS,
            friction_ratio=self.friction_ratio,
            base=HarmonicBase.from_ratio(chain, self.frequency_ratio, BASE_AMPLITUDE),
            inclination=math.radians(self.angle),
            modulation=Modulation(modulation=self.modulation, multiple=2),
            time_step=PERIOD / self.frequency_ratio / STEPS_PER_PERIOD,
            steps=PERIODS * STEPS_PER_PERIOD,
            every=STEPS_PER_PERIOD // ROWS_PER_PERIOD,
        )

    def __str__(self) -> str:
        return f"{self.title}, {self.angle:g}°"


CASES = (
    Inclined("sliding", 0.1, 0.6, 12.0),
    Inclined("sliding and sticking", 0.3, 0.9, -12.0, 0.5),
    Inclined("sticking", 2.0, 0.6, 12.0),
    Inclined("lift-off and landing", 0.3, 0.6, 12.0, 1.5),
)


class InclinedChainScenario(Scenario):
    """The spring of a cell loads and unloads its contact; a normal force that is known in advance is not enough."""

    name = "inclined-chain"
    question, expects = DESCRIPTIONS[name]
    source = "Equation (7) of Sethi, Banerjee and Manna, with a coupling of normal and tangential direction, G_NT."
    metrics = (RESPONSE, SLIPS, HIGHEST, OPEN, LANDINGS)

    def parameters(self) -> list[str]:
        """Give cases and step sizes; see `Scenario.parameters`."""
        steps = ", ".join(str(STEPS_PER_PERIOD * factor) for factor in REFINEMENTS)
        cases = [
            f"{case}: μλ_N/(k_c U0) = {case.friction_ratio:g}, η_r = {case.frequency_ratio:g}, N = N0 (1 + "
            f"{case.modulation:g} sin 2ωt)"
            for case in CASES
        ]
        return [*cases, f"{PERIODS} periods of the base, from rest, in {steps} steps each"]

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Run every case with every variant; see `Scenario.run`."""
        fine = [case.task(REFERENCE).refined(INCLINED_REFINEMENT) for case in CASES]
        coarse = [case.task(variant) for variant in dict.fromkeys((REFERENCE, *variants)) for case in CASES]
        evaluator.evaluate([task for coarsest in (*fine, *coarse) for task in with_refined_steps(coarsest)])
        return [finding for variant in variants for case in CASES for finding in self._judged(variant, case, evaluator)]

    def law_variant(self, variant: Variant) -> Variant | None:
        """Give the law under inclined contacts; see `Scenario.law_variant`."""
        return variant.inclined_law

    def law_periods(self, variant: Variant, evaluator: Evaluator) -> Mapping[str, LawPeriod]:
        """Compare the whole motion of every case, with the finest steps, with the law's from the same state."""
        by_law = variant.inclined_law
        assert by_law is not None, "only variants with a law are compared with one"
        own, predicted = (
            {str(case): with_refined_steps(case.task(each))[-1] for case in CASES} for each in (variant, by_law)
        )
        evaluator.evaluate([*own.values(), *predicted.values()])
        series = SERIES[SLIPS]
        return {case: motion_distance(task, predicted[case], series, evaluator) for case, task in own.items()}

    def _judged(self, variant: Variant, case: Inclined, evaluator: Evaluator) -> list[Finding]:
        """Compare a motion with the reference's, in finer steps and in the same ones."""
        scheme_task = case.task(REFERENCE)
        tasks = case.task(variant), scheme_task.refined(INCLINED_REFINEMENT), scheme_task
        readings = [read_refined(task, evaluator, _numbers) for task in tasks]
        for reading in readings:
            if isinstance(reading, Comparison):
                return Finding.without_numbers(variant, str(case), self.metrics, reading)
        own, exact, scheme = (reading for reading in readings if not isinstance(reading, Comparison))
        return [_finding(variant, case, metric, own, exact, scheme) for metric in self.metrics]


def _finding(
    variant: Variant, case: Inclined, metric: Metric, own: Readings, exact: Readings, scheme: Readings
) -> Finding:
    expected = exact[metric]
    comparison = judge(
        metric,
        own[metric],
        expected.judged,
        bar=expected.error(metric),
        scheme=scheme[metric],
        resolution=RESOLUTION.get(metric, 0.0),
    )
    if metric in SERIES:
        return Finding(variant, str(case), metric, comparison.difference, 0.0, comparison)
    return Finding(variant, str(case), metric, float(own[metric].judged), float(expected.judged), comparison)


def _numbers(series: NamedNumbers) -> Mapping[Metric, Number]:
    arrays: dict[Metric, Number] = {metric: np.array(series[name]) for metric, name in SERIES.items()}
    single = {HIGHEST: "highest", OPEN: "open", LANDINGS: "landings"}
    return arrays | {metric: series[name][0] for metric, name in single.items()}
