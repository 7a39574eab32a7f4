"""Published answers: problems of other suites that one block on a carrier can stand for, held against their numbers.

The published problems have one mass on the ground, or on a table with a given motion. The carrier that stands for both
is free along the row, but for a weak spring without a dashpot, see `on_free_carrier`; then

    r̈ = (1/m + 1/M) (λ_T − k r) − a(t)

is exact for the slip r of a block of mass m on a carrier of mass M, and the block that is simulated has the m for which
1/m + 1/M is one over the published mass. So a carrier of `CARRIER_MASSES` blocks costs nothing.
"""

import csv
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib import resources
from typing import Any, NamedTuple

from multibody_xval.scenarios.cases.motions import CARRIER_MASSES, Block, BlockMotion
from multibody_xval.scenarios.catalogue.blocks.block import on_free_carrier, rounded, slips
from multibody_xval.scenarios.catalogue.scenario import ROUNDINGS, Quantity, Scenario, round_off
from multibody_xval.scenarios.model import AnyCase, Result, Run
from reference_lcp.chain.drives import HarmonicForce, StillBase
from reference_lcp.defaults import FRICTION_COEFFICIENT

NO_SPRING = 1e-9
"""Force of a block's spring where there is none, over the bound of friction, for each metre of slip [1/m]."""


def _targets() -> dict[str, dict[str, str]]:
    text = resources.files(__package__).joinpath("published.csv").read_text(encoding="utf-8")
    return {row["id"]: row for row in csv.DictReader(text.splitlines())}


TARGETS = _targets()
"""Every published number by its name: ``quantity``, ``unit``, ``source``, ``value``, and its ``uncertainty``: half of
its last printed digit, or what else it is known to be off by."""


class Published(NamedTuple):
    """A problem, of a mass of 1 kg and a bound of 1 N, and how a number is read of it."""

    name: str
    case: BlockMotion
    steps: int
    read: Callable[[Result, BlockMotion], float]
    """Gives the number in its unit."""
    rounded: Callable[[Run], float]
    """By how much roundings change that."""

    @property
    def value(self) -> float:
        """Give the published number."""
        return float(TARGETS[self.name]["value"])

    @property
    def over(self) -> float:
        """Give what a number is given over: its size, or where that is 0, that of the same with A = 1.01 m/s²."""
        return abs(self.value) or float(TARGETS["sdnd104-1.01"]["value"])


def moved(time: float, rows: int, length: float, stiffness: float, **start: Any) -> BlockMotion:
    """Give a mass on the ground with a spring [N/m], moved at first; `length` [m] is the size of its slip."""
    return BlockMotion(block=_block(stiffness, time), drive=StillBase(length), time=time, rows=rows, **start)


def shaken(acceleration: float, frequency: float, time: float, rows: int) -> BlockMotion:
    """Give a mass on a table with the acceleration A sin ωt [m/s²]; the carrier begins as the table goes on."""
    block = _block(0.0, time)
    force = CARRIER_MASSES * block.mass * acceleration
    return BlockMotion(
        block=block, drive=HarmonicForce(force, frequency, acceleration / frequency**2), time=time, rows=rows,
        carrier_velocity=-acceleration / frequency,
    )  # fmt: skip


def _block(stiffness: float, time: float) -> Block:
    block = Block(mass=1 + 1 / CARRIER_MASSES, normal_force=1 / FRICTION_COEFFICIENT, stiffness=stiffness or NO_SPRING)
    return on_free_carrier(block, time)


def place(result: Result, case: BlockMotion) -> float:
    """Give the slip in the end [m]."""
    return case.scale * float(slips(result)[-1])


HALF_TURN, TURNS, TURN_ROWS, TURN_STEPS = math.pi / 100, 4, 25, 400
"""π / ω of SDND100 [s], how many half turns are read, and rows and steps to each; its axis is at 45° to x and y."""

ALONG = math.cos(math.pi / 4)


def turn(number: int) -> Published:
    """Give y at the end of a half turn of SDND100."""
    longest = moved(TURNS * HALF_TURN, TURNS * TURN_ROWS, 0.85e-3, 1e4, slip=0.85e-3)
    case = replace(longest, time=number * HALF_TURN, rows=number * TURN_ROWS)
    return Published(
        f"sdnd100-{number}",
        case,
        number * TURN_STEPS,
        lambda *own: ALONG * place(*own),
        lambda run: ALONG * rounded(run),
    )


WEAR_FROM, WEAR_TO, WEAR_ROW, WEAR_FORCE = 4.0, 12.0, 0.2, 10.0
"""Times [s] between which SDND104 reads the wear power, from row to row, and its normal force [N]."""


def wear_power(result: Result, _case: BlockMotion) -> float:
    """Give N times the mean |ṙ| [W]."""
    start, end = (result.series["slid"][round(time / WEAR_ROW) - 1] for time in (WEAR_FROM, WEAR_TO))
    return WEAR_FORCE * (end - start) / (WEAR_TO - WEAR_FROM)


def _rounded_power(run: Run) -> float:
    """Give by how much roundings change that [W]: those of two velocities, and of a slip of half a period at most.

    Friction takes equal parts off the velocity, so that their roundings are equal too, and add up as the number of
    steps.
    """
    of_velocities = ROUNDINGS * WEAR_FORCE * abs(run.of(BlockMotion).carrier_velocity)
    of_slips = NUMBERS[run.case].value * run.steps / (2 * WEAR_TO)
    return round_off(run) * (of_velocities + of_slips)


def wear(acceleration: float) -> Published:
    """Give the wear power of SDND104 with one amplitude of the table's acceleration [m/s²].

    The printed values neglect the spring of 3e-5 N/m that is there to hold the mass: it takes 2e-5 off the first one.
    """
    case = shaken(acceleration, 2 * math.pi, WEAR_TO, round(WEAR_TO / WEAR_ROW))
    return Published(f"sdnd104-{acceleration:g}", case, 19200, wear_power, _rounded_power)


BEFORE_BRAKING = 0.1
"""Way [m] and time [s] of Modelica's mass before its brake closes."""

BRAKE = Published(
    "brake", moved(1.5, 75, 0.5, 0.0, slip_velocity=1.0), 3000,
    lambda result, case: BEFORE_BRAKING + place(result, case), rounded,
)  # fmt: skip

OSCILLATOR = Published(
    "friction-oscillator", moved(25.0, 100, 12.0, 1.0, slip=12.0, slip_velocity=6.0), 10000, place, rounded
)

NUMBERS: Mapping[AnyCase, Published] = {
    own.case: own for own in (*map(turn, range(1, TURNS + 1)), *map(wear, (15.0, 1.5, 1.01, 0.99)), BRAKE, OSCILLATOR)
}
"""Every published number that is read, by its case."""

LEFT, MORE_LEFT = 2e-6, {"sdnd104-1.01": 1e-4}
"""What the carrier's spring and reading at steps leave of a published number, over it.

A table that is just strong enough moves the block for 6 % of the time, and the trapezoidal rule reads few steps.
"""


def read(result: Result, run: Run) -> float:
    """Give a number over the published one."""
    own = NUMBERS[run.case]
    return own.read(result, own.case) / own.over


def left_open(run: Run) -> float:
    """Give what the published digits, the carrier, reading at steps and roundings leave open of a number."""
    own = NUMBERS[run.case]
    open_digits = float(TARGETS[own.name]["uncertainty"]) + own.rounded(run)
    return MORE_LEFT.get(own.name, LEFT) + open_digits / own.over


PUBLISHED = Scenario(
    name="published",
    question="Do turning points, wear and stopping times agree with published numbers?",
    expects="the published number, to its printed digits; of presets that share the scheme the reference at equal "
    "steps",
    source="code_aster SDND100 and SDND104, Modelica's Brake, Siconos's FrictionOscillator: see published.csv.",
    cases={own.name: own.case for own in NUMBERS.values()},
    quantities=(
        Quantity(
            name="value", unit="", read=read, exact=lambda case: NUMBERS[case].value / NUMBERS[case].over,
            resolution=left_open, per_amplitude=0.0, effect=1.0, accuracy="transmittance",
            meaning="Number over the size of the published one; where that is 0, over the same with A = 1.01 m/s².",
        ),
    ),
    steps=lambda _config, case: {"": NUMBERS[case].steps},
    details=tuple(
        f"{name}: {own['quantity']} = {float(own['value']):g} {own['unit']}"
        for name, own in TARGETS.items()
        if name in {known.name for known in NUMBERS.values()}
    ),
)  # fmt: skip
"""Numbers that nobody here has computed first; docs/results/blocks_and_scenes.md has each problem."""

SCENARIOS = (PUBLISHED,)
