"""Inclined chain: seven cells whose contacts are inclined to the row, so that normal forces depend on the motion."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engines.interface.variant import Variant
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.steady.error_bar import REFINEMENTS
from scenarios.catalogue.descriptions import INCLINED_REFINEMENT
from scenarios.catalogue.motion import MotionScenario, refined_counts, with_refined_steps
from scenarios.catalogue.transient.base import PERIOD, RATIOS
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.parameters import Modulation
from scenarios.runs.result import NamedNumbers
from scenarios.runs.transient import OPEN_GAP
from scenarios.runs.transient_task import InclinedTask, TransientTask
from scenarios.verdicts.finding import Finding, Metric
from scenarios.verdicts.judge import Number
from scenarios.verdicts.steady_case import REFERENCE

STEPS_PER_PERIOD = 200
"""Coarsest steps to a period of the base."""

ROWS_PER_PERIOD = 50
"""Rows kept to a period of the base."""

PERIODS = 3
"""Of the base: contacts have then slipped both ways, and parted and met some five times where they do."""

BASE = 1.0
"""Friction changes motions by what the base moves, U0: from what slides along with it to what stays behind."""

RESPONSE = Metric("series", "", "Largest difference of the last outer mass from the reference's, over U0.", effect=BASE)
SLIPS = Metric("slips", "", "Largest difference of v − u of any cell from the reference's, over U0.", effect=BASE)
HIGHEST = Metric("highest", "", "Largest gap of any contact over U0.", effect=BASE)
OPEN = Metric("open", "", "Part of the time in which a contact is open, mean of all contacts.", effect=1.0)
LANDINGS = Metric("landings", "", "Changes from open to closed, of all contacts.")

RESOLUTION = {
    OPEN: 2 / STEPS_PER_PERIOD / max(REFINEMENTS),
    HIGHEST: OPEN_GAP,
}
"""Where a contact opens and closes is read to a step, at either end; a contact with a smaller gap is none that is
open."""


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


class InclinedChainScenario(MotionScenario[Inclined]):
    """The spring of a cell loads and unloads its contact; a normal force that is known in advance is not enough."""

    name = "inclined-chain"
    source = "Equation (7) of Sethi, Banerjee and Manna, with a coupling of normal and tangential direction, G_NT."
    metrics = (RESPONSE, SLIPS, HIGHEST, OPEN, LANDINGS)
    cases = CASES
    law_series = "slips"

    def parameters(self) -> list[str]:
        """Give cases and step sizes; see `Scenario.parameters`."""
        cases = [
            f"{case}: μλ_N/(k_c U0) = {case.friction_ratio:g}, η_r = {case.frequency_ratio:g}, N = N0 (1 + "
            f"{case.modulation:g} sin 2ωt)"
            for case in self.cases
        ]
        return [*cases, f"{PERIODS} periods of the base, from rest, in {refined_counts(STEPS_PER_PERIOD)} steps each"]

    def law_variant(self, variant: Variant) -> Variant | None:
        """Give the law under inclined contacts; see `Scenario.law_variant`."""
        return variant.inclined_law

    def baseline(self, case: Inclined) -> list[TransientTask]:
        """Give the tasks of the reference with finer steps."""
        return with_refined_steps(case.task(REFERENCE).refined(INCLINED_REFINEMENT))

    def numbers(self, case: Inclined, series: NamedNumbers) -> Mapping[Metric, Number]:
        """Read the motions, and what is counted over all contacts."""
        motions = {RESPONSE: np.array(series["response"]), SLIPS: np.array(series["slips"])}
        return {**motions, **{metric: series[metric.name][0] for metric in (HIGHEST, OPEN, LANDINGS)}}

    def judged(self, variant: Variant, case: Inclined, evaluator: Evaluator) -> list[Finding]:
        """Compare with the reference in finer steps."""
        read = self.read_beside(case, case.task(variant), evaluator)
        return [read.finding(variant, case, metric, resolution=RESOLUTION.get(metric, 0.0)) for metric in self.metrics]
