"""Published answers: problems of other suites that one block on a carrier can stand for, held against their numbers.

The published problems have one mass on the ground, or on a table with a given motion. The carrier that stands for both
is free along the row, but for a weak spring without a dashpot, see `CARRIER_PHASE`; then

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

from engines.interface.variant import Variant
from reference_lcp.chain.drives import ShakingForce, StillBase
from reference_lcp.defaults import FRICTION_COEFFICIENT
from reference_lcp.steady.error_bar import REFINEMENTS
from reference_lcp.validation import FloatArray
from scenarios.catalogue.block.base import ROUND_OFF, ROUNDINGS, BlockScenario, round_off
from scenarios.catalogue.descriptions import DESCRIPTIONS
from scenarios.catalogue.transient.base import read_refined, with_refined_steps
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.result import NamedNumbers
from scenarios.runs.transient_task import CARRIER_MASSES, Block, BlockTask
from scenarios.verdicts.finding import Comparison, Finding, Metric
from scenarios.verdicts.judge import Number, judge
from scenarios.verdicts.steady_case import EXACT, REFERENCE

CARRIER_PHASE = 1e-3
"""ω_c times the length of a motion [rad]: the carrier's spring changes what it does by 5e-7 of its way."""

NO_SPRING = 1e-9
"""Force of a block's spring where there is none, over the bound of friction, for each metre of slip [1/m]."""

VALUE = Metric("value", "", "Number over the published one; where that is 0, over the same with A = 1.01 m/s².")


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
    text = resources.files(__package__).joinpath("published.csv").read_text(encoding="utf-8")
    return {
        row["id"]: Target(row["quantity"], row["unit"], row["source"], float(row["value"]), float(row["uncertainty"]))
        for row in csv.DictReader(text.splitlines())
    }


class Motion(NamedTuple):
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
        block = self._block()
        shaken = self.acceleration > 0
        force = CARRIER_MASSES * block.mass * self.acceleration
        return BlockTask(
            variant=variant,
            block=block,
            base=ShakingForce(force, self.angular_frequency, self.scale) if shaken else StillBase(self.scale),
            slip=self.slip,
            slip_velocity=self.slip_velocity,
            carrier_velocity=-self.acceleration / self.angular_frequency if shaken else 0.0,
            time_step=self.time_step,
            steps=self.steps,
            every=self.every,
        )

    def _block(self) -> Block:
        return Block(
            mass=self.mass * (1 + 1 / CARRIER_MASSES),
            normal_force=self.bound / FRICTION_COEFFICIENT,
            stiffness=self.stiffness or NO_SPRING * self.bound,
            carrier_frequency=CARRIER_PHASE / (self.steps * self.time_step),
            carrier_damping=0.0,
        )


class Case(NamedTuple):
    """A number that is read of a problem."""

    problem: Problem
    read: Callable[[Motion], float]
    round_off: Callable[[BlockTask], float]
    per_length: float
    """By how much it changes at most with each metre that a slip is off."""
    unit: float

    def value(self, series: NamedNumbers) -> float:
        """Read the number over its unit."""
        motion = Motion(self.problem.scale * np.array(series["slip"]), np.array(series["slid"]))
        return self.read(motion) / self.unit


TURN_STEPS, TURN_ROW = 100, 4
"""Coarsest steps of SDND100 to half a period π / ω, and to a row."""

SPRING = Problem(
    mass=1.0, bound=1.0, stiffness=1e4, slip=0.85e-3, scale=0.85e-3, time_step=math.pi / 100 / TURN_STEPS,
    steps=4 * TURN_STEPS, every=TURN_ROW,
)  # fmt: skip
"""SDND100 along its axis, at 45° to x and y."""


def _turn(number: int) -> Case:
    """Give y at the end of a half turn of SDND100."""
    along = math.cos(math.pi / 4)
    return Case(
        SPRING,
        lambda motion: along * float(motion.slip[number * TURN_STEPS // TURN_ROW - 1]),
        lambda task: along * round_off(task),
        along,
        abs(targets()[f"sdnd100-{number}"].value),
    )


WEAR_FROM, WEAR_TO, WEAR_FORCE = 4.0, 12.0, 10.0
"""Times [s] between which SDND104 reads the wear power, and its normal force [N]."""

WEAR_STEP = 0.0025
"""Coarsest step of SDND104 [s]."""

TURNS_A_SECOND = 4.0
"""Ends of slips: at each of them a slip that is off changes the way."""


WEAR_ROW = 80
"""Coarsest steps of SDND104 to a row: 0.2 s."""


def _wear_power(motion: Motion) -> float:
    """N times the mean |ṙ| [W]."""
    row = WEAR_ROW * WEAR_STEP
    start, end = (motion.slid[round(time / row) - 1] for time in (WEAR_FROM, WEAR_TO))
    return WEAR_FORCE * float(end - start) / (WEAR_TO - WEAR_FROM)


def _wear_round_off(task: BlockTask) -> float:
    """By how much roundings of two velocities change that [W]."""
    return WEAR_FORCE * ROUNDINGS * ROUND_OFF[task.variant.capabilities.precision] * abs(task.carrier_velocity)


def _wear(amplitude: float) -> Case:
    """Give the wear power of SDND104 with one amplitude of the table's acceleration [m/s²].

    The printed values neglect the spring of 3e-5 N/m that is there to hold the mass: it takes 2e-5 off the first one.
    """
    omega = 2 * math.pi
    problem = Problem(
        mass=1.0, bound=1.0, acceleration=amplitude, angular_frequency=omega,
        scale=amplitude / omega**2, time_step=WEAR_STEP, steps=round(WEAR_TO / WEAR_STEP), every=WEAR_ROW,
    )  # fmt: skip
    value = targets()[f"sdnd104-{amplitude:g}"].value or targets()["sdnd104-1.01"].value
    return Case(problem, _wear_power, _wear_round_off, WEAR_FORCE * TURNS_A_SECOND, value)


BRAKE = Problem(mass=1.0, bound=1.0, slip_velocity=1.0, scale=0.5, time_step=0.002, steps=750, every=10)
"""The mass from 0.1 s on, when its brake closes; without that it has moved by 0.1 m."""

OSCILLATOR = Problem(
    mass=1.0, bound=1.0, stiffness=1.0, slip=12.0, slip_velocity=6.0, scale=12.0, time_step=0.01, steps=2500, every=25
)
"""FrictionOscillator, in its own units."""

CASES: Mapping[str, Case] = {
    **{f"sdnd100-{number}": _turn(number) for number in (1, 2, 3, 4)},
    **{f"sdnd104-{amplitude:g}": _wear(amplitude) for amplitude in (15.0, 1.5, 1.01, 0.99)},
    "brake": Case(BRAKE, lambda motion: 0.1 + float(motion.slip[-1]), round_off, 1.0, targets()["brake"].value),
    "friction-oscillator": Case(
        OSCILLATOR, lambda motion: float(motion.slip[-1]), round_off, 1.0, targets()["friction-oscillator"].value
    ),
}


class Published(BlockScenario):
    """Numbers that nobody here has computed first; docs/targets has each problem in full."""

    name = "published"
    question, expects = DESCRIPTIONS[name]
    source = "code_aster SDND100 and SDND104, Modelica's Brake, Siconos's FrictionOscillator: see published.csv."
    metrics = (VALUE,)

    def parameters(self) -> list[str]:
        """Give each number with its source, and the steps; see `Scenario.parameters`."""
        named = [f"{name}: {target.quantity} = {target.value:g} {target.unit}" for name, target in targets().items()]
        factors = ", ".join(str(factor) for factor in REFINEMENTS)
        return [*(line for line in named if line.partition(":")[0] in CASES), f"steps divided by {factors}"]

    def tasks_by_case(self, variant: Variant) -> Mapping[str, BlockTask]:
        """Give the tasks; see `BlockScenario.tasks_by_case`."""
        return {name: case.problem.task(variant) for name, case in CASES.items()}

    def baseline(self) -> list[BlockTask]:
        """Give the exact motions, which say what carrier and steps of reading cost."""
        return [_exact(case.problem) for case in CASES.values()]

    def simulated(self, task: BlockTask) -> list[BlockTask]:
        """Give a task with three step sizes."""
        return with_refined_steps(task)

    def judged(self, variant: Variant, case: str, task: BlockTask, evaluator: Evaluator) -> list[Finding]:
        """Compare with the published number; its uncertainty and what the exact motion leaves of it are allowed."""
        number, target = CASES[case], targets()[case]

        def numbers(series: NamedNumbers) -> Mapping[Metric, Number]:
            return {VALUE: number.value(series)}

        tasks = (task, number.problem.task(REFERENCE))
        own, scheme = (read_refined(each, evaluator, numbers) for each in tasks)
        (exact,) = evaluator.evaluate([_exact(number.problem)])
        for gap in (own, scheme):
            if isinstance(gap, Comparison):
                return Finding.without_numbers(variant, case, self.metrics, gap)
        assert not isinstance(own, Comparison), "gaps are findings"
        assert not isinstance(scheme, Comparison), "gaps are findings"
        expected = target.value / number.unit
        left = abs(number.value(exact.series) - expected) + target.uncertainty / number.unit
        allowed = left + number.round_off(task) / number.unit
        comparison = judge(VALUE, own[VALUE], expected, scheme=scheme[VALUE], resolution=allowed)
        per_amplitude = number.per_length * number.problem.scale / number.unit
        comparison = replace(comparison, per_amplitude=per_amplitude)
        return [Finding(variant, case, VALUE, float(own[VALUE].judged), expected, comparison)]


def _exact(problem: Problem) -> BlockTask:
    """Give the exact motion, read at the finest steps of the others."""
    return problem.task(EXACT).refined(REFINEMENTS[-1])
