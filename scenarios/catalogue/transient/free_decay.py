"""Free decay: a chain that is let go, and the friction that brings its contacts to rest."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.motion import MotionScenario, Readings, refined_counts
from multibody_xval.scenarios.catalogue.transient.base import harmonic_period
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.runs.transient_task import TransientTask
from multibody_xval.scenarios.verdicts.finding import Finding, Metric
from multibody_xval.scenarios.verdicts.judge import Number, Steps
from multibody_xval.scenarios.verdicts.steady_case import EXACT
from reference_lcp.chain.drives import StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.validation import FloatArray

DECAY_STEPS = 100
"""Coarsest steps to a period 2π / ω_r; the finest of the three step sizes takes four times as many."""

EXACT_REFINEMENT = 8
"""Rows of the exact motion to the coarsest step: heat of dashpots is a sum over them, good to 3e-7 of the energy."""

DISPLACEMENT_SCALE = 0.01
"""Displacement scale [m]: the U0 of the friction ratio."""

REST_TIME = Metric(
    "time to rest", "T_r", "When the last contact came to rest, over the period 2π / ω_r of the resonator."
)
OFFSETS = Metric(
    "offsets", "", "Largest difference of v − u at the end from the exact one's, over F / k_i.", effect=1.0
)
DEAD_BAND = Metric(
    "dead band", "", "By how much the largest |v − u| at the end is beyond F / k_i, over F / k_i.", effect=1.0
)
HEAT = Metric("heat of contacts", "", "Energy that contacts have turned into heat, over the initial energy.")
LEFT = Metric("energy left", "", "Energy of the chain at the end, over the initial one.")
BALANCE = Metric("balance", "", "Initial energy less what is left and all heat, over the initial energy.")
GROWTH = Metric("growth", "", "Largest growth of the energy over the least so far, over the initial energy.")
SHARES = (HEAT, LEFT, BALANCE)
ENERGIES = (*SHARES, GROWTH)
"""Friction changes them by what contacts turn into heat, as it changes offsets by what it holds at most, F / k_i."""
LOSS = Metric("loss a cycle", "", "Amplitude that the friction oscillator loses in a cycle, over 4 F / k_i.")


@dataclass(frozen=True)
class Decay:
    """One chain that is let go."""

    title: str
    ratios: ChainRatios
    friction_ratio: float
    shape: str
    """Where it starts, one of `multibody_xval.scenarios.runs.transient_task.SHAPES`."""
    periods: int
    """Length of the motion in periods 2π / ω_r."""

    @property
    def chain(self) -> Chain:
        """Build the chain."""
        return self.ratios.chain(self.friction_ratio)

    @property
    def half_width(self) -> float:
        """F / k_i of cell 1, over the displacement scale: half of the dead band."""
        return float(self.chain.friction_bound[0] / self.chain.inner_stiffness[0]) / DISPLACEMENT_SCALE

    @property
    def period(self) -> float:
        """2π / ω_r [s]."""
        return 2 * math.pi / self.chain.resonator_frequency

    def task(self, variant: Variant) -> TransientTask:
        """Give the task of a variant, with its coarsest step."""
        return TransientTask(
            variant=variant,
            ratios=self.ratios,
            friction_ratio=self.friction_ratio,
            base=StillBase(DISPLACEMENT_SCALE),
            time_step=self.period / DECAY_STEPS,
            steps=self.periods * DECAY_STEPS,
            shape=self.shape,
            recorded="decay",
        )

    def __str__(self) -> str:
        return self.title


OSCILLATOR_DECAY = Decay(
    "friction oscillator",
    # an outer mass of 10,000 inner ones on a spring of 40,000 inner ones: it moves by less than 1e-4
    ChainRatios(cells=1, mass_ratio=1e-4, stiffness_ratio=0.25e-4, damping_ratio=0.0),
    0.06 * 0.25e-4,
    "inner masses displaced",
    8,
)
DECAYS = (
    OSCILLATOR_DECAY,
    Decay("inner masses let go", ChainRatios(), 0.1, "inner masses displaced", 30),
    Decay("stretched chain let go", ChainRatios(), 0.02, "stretched", 80),
)


RESOLUTION = {REST_TIME: 1 / DECAY_STEPS, LOSS: 1e-4}
"""Of times, the rows; of the loss a cycle, the outer mass: it stands still in the closed form, and has 10,000 times the
inner one's mass here."""

ROUND_OFF = 1e-6
"""Of energies and offsets: the heat of the exact motion's dashpots, see `EXACT_REFINEMENT`."""


class FreeDecay(MotionScenario[Decay]):
    """Dry friction stops a motion after a finite time, anywhere within a dead band; dashpots never do."""

    name = "free-decay"
    source = (
        "Free vibration with Coulomb damping, 4 F / k a cycle: J. P. Den Hartog, Mechanical Vibrations; chain: "
        "figure 3 of Sethi, Banerjee and Manna."
    )
    metrics = (REST_TIME, OFFSETS, DEAD_BAND, HEAT, LEFT, BALANCE, GROWTH, LOSS)
    cases = DECAYS

    def parameters(self) -> list[str]:
        """Give each chain and where it starts; see `Scenario.parameters`."""
        return [
            f"{decay}: {decay.shape}, {decay.ratios}, friction_ratio={decay.friction_ratio:g}; "
            f"{decay.periods} periods 2π / ω_r, in {refined_counts(DECAY_STEPS)} steps each"
            for decay in self.cases
        ]

    def period_tasks(self, variant: Variant) -> Mapping[str, SteadyStateTask]:
        """Compare a period of a harmonic motion of the same chain."""
        return {str(decay): harmonic_period(variant, decay.ratios, decay.friction_ratio) for decay in self.cases}

    def case_metrics(self, case: Decay) -> Sequence[Metric]:
        """Give what is compared: the loss a cycle is the oscillator's only."""
        return [metric for metric in self.metrics if metric is not LOSS or case is OSCILLATOR_DECAY]

    def baseline(self, case: Decay) -> list[TransientTask]:
        """Give the task of the exact motion, at the rows of every variant; heat is added up in finer rows."""
        return [case.task(EXACT).refined(EXACT_REFINEMENT)]

    def numbers(self, case: Decay, series: NamedNumbers) -> Mapping[Metric, Number]:
        """Read what is compared; of offsets those of all cells."""
        left, dashpots, contacts, growth = series["energy"]
        offsets = np.array(series["offsets"]) / case.half_width
        return {
            REST_TIME: series["rest"][0] / case.period,
            OFFSETS: offsets,
            DEAD_BAND: max(0.0, float(np.max(np.abs(offsets))) - 1),
            HEAT: contacts,
            LEFT: left,
            BALANCE: 1 - left - dashpots - contacts,
            GROWTH: growth,
            LOSS: loss_a_cycle(np.array(series["swing"])) / (4 * case.half_width),
        }

    def judged(self, variant: Variant, case: Decay, evaluator: Evaluator) -> list[Finding]:
        """Compare with the exact motion and closed forms, beside the error of the reference in the same steps."""
        read = self.read_beside(case, case.task(variant), evaluator)
        (exact,) = evaluator.evaluate(self.baseline(case))
        left, dashpots, _, _ = exact.series["energy"]
        heat = 1 - left - dashpots  # of contacts: dashpots are smooth, friction jumps between the rows
        known = {HEAT: heat, BALANCE: 0.0, GROWTH: 0.0, DEAD_BAND: 0.0, LOSS: 1.0}
        closed = {metric: Steps({1: number}) for metric, number in known.items()}
        read = read._replace(expected={**read.expected, **closed})
        shared = max(_shared_error(read.own), _shared_error(read.scheme))
        return [
            read.finding(
                variant,
                case,
                metric,
                resolution=RESOLUTION.get(metric, ROUND_OFF),
                own=shared if metric in SHARES else 0.0,
                effect=heat if metric in ENERGIES else None,
            )
            for metric in self.case_metrics(case)
        ]


def _shared_error(read: Readings) -> float:
    """Error of heat, what is left and what is missing, shares of one energy: that of one alone may vanish by chance."""
    return max(read[metric].error(metric) for metric in SHARES)


def loss_a_cycle(swing: FloatArray) -> float:
    """Amplitude that an oscillation from 1 loses from one turn to the next but one, on average while it swings."""
    turns = [1.0]
    sides = np.sign(swing)
    starts = np.flatnonzero(np.diff(sides, prepend=sides[0]) != 0)
    turns += [float(np.max(np.abs(stretch))) for stretch in np.split(swing, starts)[1:]]
    return 2 * (turns[0] - turns[-1]) / (len(turns) - 1) if len(turns) > 1 else math.nan
