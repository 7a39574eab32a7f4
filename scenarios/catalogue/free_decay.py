"""Free decay: a chain that is let go, and the friction that brings its contacts to rest."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engines.variant import Variant
from reference_lcp.chain import Chain
from reference_lcp.drive import StillBase
from reference_lcp.event_driven import EventDrivenSimulation
from reference_lcp.validation import FloatArray
from scenarios.agreement import Tolerance, compare
from scenarios.broadband import refinements, unfinished
from scenarios.evaluation import Evaluator
from scenarios.motion_answering import kept_of
from scenarios.motions import Motion
from scenarios.questions import ChainRatios, Series
from scenarios.refinement import error_of_finest
from scenarios.scenario import Finding, Metric, Scenario

STEPS_PER_PERIOD = 100
"""Coarsest steps to a period 2π / ω_r; the finest of the three step sizes takes four times as many."""

LENGTH = 0.01
"""Displacement scale [m]: the U0 of the friction ratio."""

REST_TIME = Metric(
    "time to rest", "T_r", "When the last contact came to rest, over the period 2π / ω_r of the resonator."
)
OFFSETS = Metric("offsets", "", "Largest difference of v − u at the end from the exact one's, over F / k_i.")
DEAD_BAND = Metric("dead band", "", "By how much the largest |v − u| at the end is beyond F / k_i, over F / k_i.")
HEAT = Metric("heat of contacts", "", "Energy that contacts have turned into heat, over the initial energy.")
LEFT = Metric("energy left", "", "Energy of the chain at the end, over the initial one.")
BALANCE = Metric("balance", "", "Initial energy less what is left and all heat, over the initial energy.")
GROWTH = Metric("growth", "", "Largest growth of the energy over the least so far, over the initial energy.")
LOSS = Metric("loss a cycle", "", "Amplitude that the friction oscillator loses in a cycle, over 4 F / k_i.")


@dataclass(frozen=True)
class Decay:
    """One chain that is let go.

    Parameters
    ----------
    title
        As tables print it.
    ratios, friction_ratio
        The chain.
    shape
        Where it starts, one of `scenarios.motions.SHAPES`.
    periods
        Length of the motion in periods 2π / ω_r.
    """

    title: str
    ratios: ChainRatios
    friction_ratio: float
    shape: str
    periods: int

    @property
    def chain(self) -> Chain:
        """Build the chain."""
        return self.ratios.chain(self.friction_ratio)

    @property
    def half_width(self) -> float:
        """F / k_i of cell 1, over the displacement scale: half of the dead band."""
        return float(self.chain.friction_bound[0] / self.chain.inner_stiffness[0]) / LENGTH

    @property
    def period(self) -> float:
        """2π / ω_r [s]."""
        return 2 * math.pi / self.chain.resonator_frequency

    def motion(self, variant: Variant) -> Motion:
        """Ask a variant, with its coarsest step."""
        return Motion(
            variant=variant,
            ratios=self.ratios,
            friction_ratio=self.friction_ratio,
            base=StillBase(LENGTH),
            time_step=self.period / STEPS_PER_PERIOD,
            steps=self.periods * STEPS_PER_PERIOD,
            shape=self.shape,
            recorded="decay",
        )

    def exact(self) -> Series:
        """Give the event-driven motion, at the rows of every variant."""
        motion = self.motion(Variant("reference"))
        run = EventDrivenSimulation([motion.lane()]).run(motion.initial_state(), 0, motion.steps)[0]
        return kept_of(motion, run)


OSCILLATOR = Decay(
    "friction oscillator",
    # an outer mass of 10,000 inner ones on a spring of 40,000 inner ones: it moves by less than 1e-4
    ChainRatios(cells=1, mass_ratio=1e-4, stiffness_ratio=0.25e-4, damping_ratio=0.0),
    0.06 * 0.25e-4,
    "inner masses displaced",
    8,
)
DECAYS = (
    OSCILLATOR,
    Decay("inner masses let go", ChainRatios(), 0.1, "inner masses displaced", 30),
    Decay("stretched chain let go", ChainRatios(), 0.02, "stretched", 80),
)


class FreeDecay(Scenario):
    """Dry friction stops a motion after a finite time, anywhere within a dead band; dashpots never do."""

    name = "free-decay"
    question = "When, where and with what loss of energy does a chain come to rest that is let go?"
    source = (
        "Coulomb damping of an oscillator, 4 F / k a cycle: H. Lorenz, 1924; J. P. Den Hartog, Mechanical Vibrations, "
        "section 1.9."
    )
    expects = "the event-driven motion, exact to round-off; energy balance and growth: zero; loss of a cycle: 4 F / k"
    metrics = (REST_TIME, OFFSETS, DEAD_BAND, HEAT, LEFT, BALANCE, GROWTH, LOSS)

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Put the question to every variant; see `Scenario.run`. The loss a cycle is the oscillator's only."""
        exact = {decay: decay.exact() for decay in DECAYS}
        evaluator.evaluate(self.questions(variants))
        return [
            finding
            for variant in variants
            for decay in DECAYS
            for finding in _findings(variant, decay, exact[decay], evaluator)
        ]

    def questions(self, variants: Sequence[Variant]) -> list[Motion]:
        """Everything that `run` asks."""
        return [motion for variant in variants for decay in DECAYS for motion in refinements(decay.motion(variant))]


def _findings(variant: Variant, decay: Decay, exact: Series, evaluator: Evaluator) -> list[Finding]:
    """Compare one decay with the exact one."""
    answers = evaluator.evaluate(refinements(decay.motion(variant)))
    metrics = [metric for metric in FreeDecay.metrics if metric is not LOSS or decay is OSCILLATOR]
    missing = unfinished(answers, ())
    if missing is not None:
        return [Finding(variant, decay.title, metric, math.nan, math.nan, missing) for metric in metrics]
    values = [_numbers(decay, answer.series, exact) for answer in answers]
    expected = _expected(decay, exact)
    found = []
    for metric in metrics:
        finest, wanted = values[-1][metric], expected[metric]
        tolerance = Tolerance(0.0, error_of_finest([value[metric] for value in values]), _resolution(metric))
        if metric is OFFSETS:
            offsets = [np.array(answer.series["offsets"]) / decay.half_width for answer in answers]
            tolerance = Tolerance(0.0, error_of_finest(offsets), tolerance.resolution)
        found.append(Finding(variant, decay.title, metric, finest, wanted, compare(finest, wanted, tolerance)))
    return found


def _numbers(decay: Decay, series: Series, exact: Series) -> dict[Metric, float]:
    """Read what is compared."""
    left, dashpots, contacts, growth = series["energy"]
    offsets, wanted = np.array(series["offsets"]), np.array(exact["offsets"])
    return {
        REST_TIME: series["rest"][0] / decay.period,
        OFFSETS: float(np.max(np.abs(offsets - wanted))) / decay.half_width,
        DEAD_BAND: max(0.0, float(np.max(np.abs(offsets))) / decay.half_width - 1),
        HEAT: contacts,
        LEFT: left,
        BALANCE: 1 - left - dashpots - contacts,
        GROWTH: growth,
        LOSS: loss_a_cycle(np.array(series["swing"])) / (4 * decay.half_width),
    }


def _expected(decay: Decay, exact: Series) -> dict[Metric, float]:
    """Give the exact numbers, and the laws."""
    numbers = _numbers(decay, exact, exact)
    # heat at the rows of the exact motion is a sum; its energy is exact, and dashpots are smooth
    heat = 1 - exact["energy"][0] - exact["energy"][1]
    return {**numbers, HEAT: heat, BALANCE: 0.0, GROWTH: 0.0, DEAD_BAND: 0.0, OFFSETS: 0.0, LOSS: 1.0}


def _resolution(metric: Metric) -> float:
    """Give what a number leaves open beside the step: of times, the rows; of the loss, the motion of the outer mass."""
    if metric is REST_TIME:
        return 1 / STEPS_PER_PERIOD
    return _OUTER_MOTION if metric is LOSS else _ROUND_OFF


_OUTER_MOTION = 1e-4
"""Of the loss a cycle: the closed form's outer mass stands still; here it has 10,000 times the inner one's mass."""

_ROUND_OFF = 1e-5
"""Of energies and offsets: dashpots' heat of the exact motion is a sum over its rows, good to (ω Δt)² / 12 of 0.02."""


def loss_a_cycle(swing: FloatArray) -> float:
    """Amplitude that an oscillation loses from one turn to the next but one, on average while it swings.

    Parameters
    ----------
    swing
        Displacement at even times, shape (times,), let go from its first turn, where it was 1.
    """
    turns = [1.0]
    sides = np.sign(swing)
    starts = np.flatnonzero(np.diff(sides, prepend=sides[0]) != 0)
    turns += [float(np.max(np.abs(stretch))) for stretch in np.split(swing, starts)[1:]]
    return 2 * (turns[0] - turns[-1]) / (len(turns) - 1) if len(turns) > 1 else math.nan
