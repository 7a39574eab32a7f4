"""Published answers: problems of other suites that one block on a carrier can stand for, held against their numbers.

The published problems have one mass on the ground, or on a table with a given motion. The carrier that stands for both
is free along the row, but for a weak spring without a dashpot, see `on_free_carrier`; then

    r̈ = (1/m + 1/M) (λ_T − k r) − a(t)

is exact for the slip r of a block of mass m on a carrier of mass M, and the block that is simulated has the m for which
1/m + 1/M is one over the published mass. So a carrier of `CARRIER_MASSES` blocks costs nothing: what its spring leaves,
and what reading at steps does, is measured by the exact motion of the same task and allowed.
"""

import csv
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from importlib import resources
from typing import NamedTuple

import numpy as np

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.block.base import (
    ROUND_OFF,
    ROUNDINGS,
    BlockScenario,
    on_free_carrier,
    round_off,
)
from multibody_xval.scenarios.catalogue.motion import refined_counts
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.transient_task import CARRIER_MASSES, Block, BlockTask, TransientTask
from multibody_xval.scenarios.verdicts.finding import Finding, Metric
from multibody_xval.scenarios.verdicts.judge import Number, Steps
from multibody_xval.scenarios.verdicts.steady_case import EXACT
from reference_lcp.chain.drives import ShakingForce, StillBase
from reference_lcp.defaults import FRICTION_COEFFICIENT
from reference_lcp.steady.error_bar import REFINEMENTS
from reference_lcp.validation import FloatArray

NO_SPRING = 1e-9
"""Force of a block's spring where there is none, over the bound of friction, for each metre of slip [1/m]."""

VALUE = Metric(
    "value", "", "Number over the published one; where that is 0, over the same with A = 1.01 m/s².", effect=1.0
)
"""Its effect is its size: the published number, of which friction at rest leaves nothing."""


class Target(NamedTuple):
    """A published number."""

    quantity: str
    unit: str
    source: str
    value: float
    uncertainty: float
    """The number, and half of its last printed digit, or what else it is known to be off by."""


@cache
def targets() -> Mapping[str, Target]:
    """Give every published number by its name."""
    text = resources.files("multibody_xval.scenarios.catalogue").joinpath("published.csv").read_text(encoding="utf-8")
    return {
        row["id"]: Target(row["quantity"], row["unit"], row["source"], float(row["value"]), float(row["uncertainty"]))
        for row in csv.DictReader(text.splitlines())
    }


class BlockMotion(NamedTuple):
    """Slip of a block [m], and the way that it has slid [m], at the rows of a task, shape (rows,)."""

    slip: FloatArray
    slid: FloatArray


class Problem(NamedTuple):
    """A published problem."""

    mass: float
    bound: float
    time_step: float
    steps: int
    scale: float
    """Size of the slip [m]."""
    every: int = 1
    """Coarsest step [s], how many, and one row in how many is kept."""
    stiffness: float = 0.0
    """m [kg], μ λ_N [N] and k [N/m] of the one mass."""
    slip: float = 0.0
    slip_velocity: float = 0.0
    """At first [m] and [m/s]."""
    acceleration: float = 0.0
    angular_frequency: float = 0.0
    """A [m/s²] and ω [rad/s] of the table's acceleration A sin ωt."""

    def task(self, variant: Variant) -> BlockTask:
        """Give the task of a variant, with its coarsest step; the carrier begins as the table goes on."""
        shaken = self.acceleration > 0
        block = Block(
            mass=self.mass * (1 + 1 / CARRIER_MASSES),
            normal_force=self.bound / FRICTION_COEFFICIENT,
            stiffness=self.stiffness or NO_SPRING * self.bound,
        )
        force = CARRIER_MASSES * block.mass * self.acceleration
        return BlockTask(
            variant=variant,
            block=on_free_carrier(block, self.steps * self.time_step),
            base=ShakingForce(force, self.angular_frequency, self.scale) if shaken else StillBase(self.scale),
            slip=self.slip,
            slip_velocity=self.slip_velocity,
            carrier_velocity=-self.acceleration / self.angular_frequency if shaken else 0.0,
            time_step=self.time_step,
            steps=self.steps,
            every=self.every,
        )


class PublishedNumber(NamedTuple):
    """A number that is read of a problem."""

    name: str
    problem: Problem
    read: Callable[[BlockMotion], float]
    round_off: Callable[[BlockTask], float]
    per_length: float
    """By how much it changes at most with each metre that a slip is off."""

    @property
    def unit(self) -> float:
        """What it is taken over, see `VALUE`."""
        return abs(targets()[self.name].value) or targets()["sdnd104-1.01"].value

    def task(self, variant: Variant) -> BlockTask:
        """Give the task of a variant, with its coarsest step."""
        return self.problem.task(variant)

    def __str__(self) -> str:
        return self.name


TURN_STEPS, TURN_ROW = 100, 4
"""Coarsest steps of SDND100 to half a period π / ω, and to a row."""

SPRING = Problem(
    mass=1.0, bound=1.0, stiffness=1e4, slip=0.85e-3, scale=0.85e-3, time_step=math.pi / 100 / TURN_STEPS,
    steps=4 * TURN_STEPS, every=TURN_ROW,
)  # fmt: skip
"""SDND100 along its axis, at 45° to x and y."""


def _turn(number: int) -> PublishedNumber:
    """Give y at the end of a half turn of SDND100."""
    along = math.cos(math.pi / 4)
    return PublishedNumber(
        f"sdnd100-{number}",
        SPRING,
        lambda motion: along * float(motion.slip[number * TURN_STEPS // TURN_ROW - 1]),
        lambda task: along * round_off(task),
        along,
    )


WEAR_FROM, WEAR_TO, WEAR_FORCE = 4.0, 12.0, 10.0
"""Times [s] between which SDND104 reads the wear power, and its normal force [N]."""

WEAR_STEP = 0.0025
"""Coarsest step of SDND104 [s]."""

TURNS_A_SECOND = 4.0
"""Ends of slips: at each of them a slip that is off changes the way."""


WEAR_ROW = 80
"""Coarsest steps of SDND104 to a row: 0.2 s."""


def _wear_power(motion: BlockMotion) -> float:
    """N times the mean |ṙ| [W]."""
    row = WEAR_ROW * WEAR_STEP
    start, end = (motion.slid[round(time / row) - 1] for time in (WEAR_FROM, WEAR_TO))
    return WEAR_FORCE * float(end - start) / (WEAR_TO - WEAR_FROM)


def _wear_round_off(task: BlockTask) -> float:
    """By how much roundings of two velocities change that [W]."""
    return WEAR_FORCE * ROUNDINGS * ROUND_OFF[task.variant.capabilities.precision] * abs(task.carrier_velocity)


def _wear(amplitude: float) -> PublishedNumber:
    """Give the wear power of SDND104 with one amplitude of the table's acceleration [m/s²].

    The printed values neglect the spring of 3e-5 N/m that is there to hold the mass: it takes 2e-5 off the first one.
    """
    omega = 2 * math.pi
    problem = Problem(
        mass=1.0, bound=1.0, acceleration=amplitude, angular_frequency=omega,
        scale=amplitude / omega**2, time_step=WEAR_STEP, steps=round(WEAR_TO / WEAR_STEP), every=WEAR_ROW,
    )  # fmt: skip
    return PublishedNumber(f"sdnd104-{amplitude:g}", problem, _wear_power, _wear_round_off, WEAR_FORCE * TURNS_A_SECOND)


BRAKE = Problem(mass=1.0, bound=1.0, slip_velocity=1.0, scale=0.5, time_step=0.002, steps=750, every=10)
"""The mass from 0.1 s on, when its brake closes; without that it has moved by 0.1 m."""

OSCILLATOR = Problem(
    mass=1.0, bound=1.0, stiffness=1.0, slip=12.0, slip_velocity=6.0, scale=12.0, time_step=0.01, steps=2500, every=25
)
"""FrictionOscillator, in its own units."""

NUMBERS = (
    *(_turn(number) for number in (1, 2, 3, 4)),
    *(_wear(amplitude) for amplitude in (15.0, 1.5, 1.01, 0.99)),
    PublishedNumber("brake", BRAKE, lambda motion: 0.1 + float(motion.slip[-1]), round_off, 1.0),
    PublishedNumber("friction-oscillator", OSCILLATOR, lambda motion: float(motion.slip[-1]), round_off, 1.0),
)


class Published(BlockScenario[PublishedNumber]):
    """Numbers that nobody here has computed first; docs/targets has each problem in full."""

    name = "published"
    source = "code_aster SDND100 and SDND104, Modelica's Brake, Siconos's FrictionOscillator: see published.csv."
    metrics = (VALUE,)
    cases = NUMBERS

    def parameters(self) -> list[str]:
        """Give each number with its source, and the steps; see `Scenario.parameters`."""
        named = ((str(case), targets()[case.name]) for case in self.cases)
        return [
            *(f"{name}: {target.quantity} = {target.value:g} {target.unit}" for name, target in named),
            f"steps divided by {refined_counts(1)}",
        ]

    def baseline(self, case: PublishedNumber) -> list[TransientTask]:
        """Give the exact motion, which says what carrier and steps of reading cost, at the finest steps."""
        return [case.task(EXACT).refined(REFINEMENTS[-1])]

    def numbers(self, case: PublishedNumber, series: NamedNumbers) -> Mapping[Metric, Number]:
        """Read the number over its unit."""
        motion = BlockMotion(case.problem.scale * np.array(series["slip"]), np.array(series["slid"]))
        return {VALUE: case.read(motion) / case.unit}

    def judged(self, variant: Variant, case: PublishedNumber, evaluator: Evaluator) -> list[Finding]:
        """Compare with the published number; its uncertainty and what the exact motion leaves of it are allowed."""
        target, task = targets()[case.name], case.task(variant)
        read = self.read_beside(case, task, evaluator)
        expected = target.value / case.unit
        left = abs(float(read.expected[VALUE].judged) - expected) + target.uncertainty / case.unit
        allowed = left + case.round_off(task) / case.unit
        finding = read._replace(expected={VALUE: Steps({1: expected})}).finding(
            variant, case, VALUE, resolution=allowed
        )
        per_amplitude = case.per_length * case.problem.scale / case.unit
        return [replace(finding, comparison=replace(finding.comparison, per_amplitude=per_amplitude))]
