"""A motion of very many steps and runs: what an engine does must not depend on how long it has been used."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from multibody_xval.engines.interface.tolerances import CREEP, STEPS, TRAJECTORY_TOLERANCE
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.shared.wide_range import LONG_USE, MANY_RUNS
from multibody_xval.scenarios.catalogue.motion import MotionScenario, refined_counts
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.transient_task import TransientTask
from multibody_xval.scenarios.verdicts.finding import Finding, Metric, Tolerance
from multibody_xval.scenarios.verdicts.judge import Number, decide
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.steady.error_bar import REFINEMENTS

RATIOS = ChainRatios(cells=1)

FRICTION_RATIO, FREQUENCY_RATIO = 0.3, 0.9
"""Where the contact of one cell sticks and slips."""

STEPS_PER_PERIOD, PERIODS = 100, 160
"""Coarsest steps to a period, and periods: the finest are four times as many, and go beyond `LONG_USE`."""

STRETCH = 250
"""Steps of one run: more than `MANY_RUNS` of them with the finest steps."""

ROWS_PER_PERIOD = 10

ROUND_OFF_PERIODS = 40
"""Periods for which `TRAJECTORY_TOLERANCE` is derived; roundings add up as the root of the number of steps."""

RESPONSE = Metric("series", "", "Largest difference of the outer mass from the exact motion's at any time, over U0.")
SAME_STEP = Metric(
    "same step",
    "",
    "Largest difference of the outer mass of presets that share the Euler scheme from the reference's with the same "
    "steps, over U0.",
)


class Run(NamedTuple):
    """The one case."""

    def task(self, variant: Variant) -> TransientTask:
        """Give the task of a variant, with its coarsest step."""
        base = HarmonicBase.from_ratio(RATIOS.chain(FRICTION_RATIO), FREQUENCY_RATIO, BASE_AMPLITUDE)
        return TransientTask(
            variant=variant,
            ratios=RATIOS,
            friction_ratio=FRICTION_RATIO,
            base=base,
            time_step=base.period / STEPS_PER_PERIOD,
            steps=PERIODS * STEPS_PER_PERIOD,
            every=STEPS_PER_PERIOD // ROWS_PER_PERIOD,
            stretch=STRETCH,
        )

    def __str__(self) -> str:
        return f"{PERIODS} periods"


class LongRun(MotionScenario[Run]):
    """Counters overflow, clocks lose digits, and what a run leaves behind adds up."""

    name = "long-run"
    source = "What a simulation is: state in, trajectory out, however often it has been used."
    metrics = (RESPONSE, SAME_STEP)
    cases = (Run(),)
    law_series = "response"

    def parameters(self) -> list[str]:
        """Give the chain and the steps; see `Scenario.parameters`."""
        return [
            f"one cell, friction {FRICTION_RATIO:g}, η_r {FREQUENCY_RATIO:g}; from rest, in "
            f"{refined_counts(STEPS_PER_PERIOD)} steps a period: more than {LONG_USE} in more than {MANY_RUNS} runs"
        ]

    def numbers(self, case: Run, series: NamedNumbers) -> Mapping[Metric, Number]:
        """Read the response."""
        return {RESPONSE: np.array(series["response"])}

    def judged(self, variant: Variant, case: Run, evaluator: Evaluator) -> list[Finding]:
        """Compare with the exact motion, and with the reference in the same steps where the scheme is shared."""
        read = self.read_beside(case, case.task(variant), evaluator)
        findings = [read.finding(variant, case, RESPONSE)]
        if variant.engine == REFERENCE.engine or not variant.preset.shares_scheme:
            return findings
        steps = PERIODS * STEPS_PER_PERIOD * max(REFINEMENTS)
        grown = max(1.0, math.sqrt(steps / (ROUND_OFF_PERIODS * STEPS)))
        rounded = grown * TRAJECTORY_TOLERANCE[variant.capabilities.precision]
        tolerance = Tolerance(resolution=rounded + CREEP * variant.preset.residual_slip_compliance)
        apart = float(np.max(np.abs(np.subtract(read.own[RESPONSE].judged, read.scheme[RESPONSE].judged))))
        same = Finding(variant, str(case), SAME_STEP, apart, 0.0, decide(SAME_STEP, apart, 0.0, tolerance))
        return [*findings, same]
