"""One steady state as a case of a scenario: the tasks, what is expected, and what came of a variant."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from multibody_xval.engines.interface.tolerances import CREEP, TRAJECTORY_TOLERANCE
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.parameters import ChainRatios, Modulation, Ratio
from multibody_xval.scenarios.runs.result import RESOLVED_DB, Result, ResultStatus
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.verdicts.finding import Comparison, Verdict
from multibody_xval.scenarios.verdicts.judge import FrictionEffect, Number, Steps, certified, friction_effect, missing
from reference_lcp.chain.drives import PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import steps_per_period_for
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.observables.stick_slip import TimedTransition
from reference_lcp.steady.richardson import amplitude_in_db, unresolved_amplitude

REFERENCE = Variant("reference")

CONVERGED = Variant("reference", preset_name="converged")

EXACT = Variant("reference", preset_name="exact")
"""The motion without an error of a time step; variants with one are compared with it."""

MOST_EXACT_CELLS = 20
"""Cells of the longest chain whose exact motion is computed as the truth: half a second, and a tenth of one for the
paper's seven, on one processor. Every contact adds events, and all cells move from event to event."""

COARSE, FINE, FINEST = 1, 2, 4
"""Steps a period over the fewest that the case allows.

Engines run with the first two, and the second is judged: the fewest are as few as the suite compares at, so that half
of them would say little of the error. An engine that disagrees, but not by far, runs with the third too: three steps
show its error better than two.
"""

SCHEME = (COARSE, FINE, FINEST, 2 * FINEST)
"""Those of the reference, whose scheme tells how large the error of the judged step is.

Where a contact turns round between the steps, the part of the error that is of first order wanders with the step: on
the graded chain between 2e-4 and 6e-4 of the amplitude over the step, at η_r = 0.6. Three steps may hit three alike,
the fourth costs the reference next to nothing.
"""

AMPLIFICATION_MARGIN = 2.0
"""On the amplification of the reference: an engine's contacts may stick for another part of the period."""


@dataclass(frozen=True, kw_only=True)
class SteadyCase:
    """A chain under a harmonic base motion."""

    label: str
    """Name that distinguishes it from the other cases of its scenario."""
    friction_ratio: Ratio
    """μ λ_N / (k_c U0), a number or one a cell."""
    frequency_ratio: float
    """ω / ω_r, with ω_r of the first cell."""
    ratios: ChainRatios = field(default_factory=ChainRatios)
    modulation: Modulation | None = None
    """How the normal force changes over the period; ``None`` where it is constant."""
    steps: int = MINIMUM_STEPS_PER_PERIOD
    """Steps a period, at least."""

    def setting(self) -> tuple[Chain, PeriodicDrive]:
        """Build the chain and its drive."""
        return self._fewest.setting()

    def task(self, variant: Variant, refinement: int = COARSE) -> SteadyStateTask:
        """Give the task of a variant, with `refinement` times the fewest steps that the case allows."""
        return replace(self._fewest, variant=variant, steps_per_period=self._fewest.steps_per_period * refinement)

    @cached_property
    def _fewest(self) -> SteadyStateTask:
        task = SteadyStateTask(
            variant=REFERENCE,
            friction_ratio=self.friction_ratio,
            frequency_ratio=self.frequency_ratio,
            ratios=self.ratios,
            modulation=self.modulation,
            steps_per_period=self.steps,
        )
        return replace(task, steps_per_period=steps_per_period_for(*task.setting(), self.steps))


@dataclass(frozen=True, kw_only=True)
class Expected:
    """What the steady state of a case is."""

    transmittance_db: float
    """20 log10 |U_n| / U0."""
    phase: float = math.nan
    """Of the last outer mass's fundamental [rad]; NaN where it is not compared."""
    bar_db: float = 0.0
    """Error bar of the transmittance [dB]; zero where it is exact."""
    phase_bar: float = 0.0
    """Error bar of the phase [°]; likewise."""
    transitions: tuple[TimedTransition, ...] = ()
    """Changes between stick and slip over a period; empty where they are not compared."""
    stuck_fraction: tuple[float, ...] = ()
    """Part of the period that each contact sticks; empty where it is not compared."""
    travels: tuple[float, ...] = ()
    """Distance, over U0, that the contact slips in the phase that each transition begins; without it, far."""
    missing: Comparison | None = None
    """Why it is not known; ``None`` where it is."""


def exact_expected(result: Result) -> Expected:
    """Expect the exact motion: the result of `EXACT`, which takes a second for seven cells, minutes from thirty on."""
    gap = missing("exact motion", [result])
    if gap is not None:
        return Expected(transmittance_db=math.nan, missing=gap)
    return Expected(
        transmittance_db=result.transmittance_db,
        phase=result.phase,
        transitions=result.transitions,
        stuck_fraction=result.stuck_fraction,
        travels=result.series.get("travels", ()),
    )


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """The results of one variant in one case, and what is expected."""

    variant: Variant
    case: SteadyCase
    coarse: Result
    fine: Result
    """Its results with the fewest steps and with twice as many; the second is judged."""
    scheme: tuple[Result, ...]
    """The reference's results with `SCHEME` times the fewest steps."""
    expected: Expected
    finest: Result | None = None
    """Its result with four times the fewest steps; ``None`` where two show its error."""
    skip_reason: Comparison | None = None
    """Why the variant was not simulated; ``None`` if it was."""

    @property
    def certified(self) -> bool:
        """Whether the variant's steady states are certified; also where it was not simulated."""
        return certified([self.coarse, self.fine])

    @cached_property
    def missing(self) -> Comparison | None:
        """Give the reason why nothing can be compared; ``None`` where every steady state is known."""
        if self.skip_reason is not None:
            return self.skip_reason
        for source, results in (("engine", (self.fine, self.coarse)), ("reference", self.scheme)):
            for result in results:
                gap = missing(f"{source} at {result.steps_per_period} steps a period", [result])
                if gap is not None and not is_resolved(result, self._amplified):
                    return gap
        if self.coarse.steps_per_period >= self.fine.steps_per_period:
            taken = f"{self.coarse.steps_per_period} and {self.fine.steps_per_period}"
            return Comparison(Verdict.INCONCLUSIVE, f"the engine took {taken} steps a period, not more the second time")
        return self.expected.missing

    @property
    def _amplified(self) -> float:
        return amplification(self.scheme[1])

    @cached_property
    def effect(self) -> FrictionEffect:
        """How much friction changes the case at all."""
        return friction_effect(*self.case.setting(), self.expected.transmittance_db, self.expected.phase)

    def resolution(self, transmittance_db: float) -> float:
        """What the judged result leaves open of an amplitude near this transmittance [dB], over U0."""
        return resolution(self.variant, self.fine, transmittance_db, self._amplified)

    def resolution_db(self, transmittance_db: float) -> float:
        """What the judged result leaves open of a transmittance near this one [dB]."""
        return amplitude_in_db(self.resolution(transmittance_db), transmittance_db)

    def steps(self, read: Callable[[Result], Number]) -> Steps:
        """Read a number of all results; the fine one's is judged."""
        results = [self.coarse, self.fine, *([] if self.finest is None else [self.finest])]
        return Steps({result.steps_per_period: read(result) for result in results}, self.fine.steps_per_period)

    def scheme_steps(self, read: Callable[[Result], Number], expected: Number | None = None) -> Steps:
        """Read a number of the reference's results; its error with the steps of the judged one counts.

        Where `expected` is exact to `RESOLVED_DB`, the error is measured; the reference itself has to estimate it.
        """
        values = {result.steps_per_period: read(result) for result in self.scheme}
        known = self.expected.bar_db <= RESOLVED_DB and self.variant.engine != REFERENCE.engine
        return Steps(values, self.scheme[1].steps_per_period, expected if known else None)


def is_resolved(result: Result, amplified: float) -> bool:
    """Whether a motion that is not certified repeats well enough for its transmittance: to `RESOLVED_DB`."""
    if result.status is not ResultStatus.PERIOD_LIMIT:
        return False
    return amplitude_in_db(result.residual * amplified, result.transmittance_db) <= RESOLVED_DB


def resolution_db(variant: Variant, result: Result, transmittance_db: float, amplified: float) -> float:
    """What a result leaves open of a transmittance near this one [dB]; see `resolution`."""
    return amplitude_in_db(resolution(variant, result, transmittance_db, amplified), transmittance_db)


def resolution(variant: Variant, result: Result, transmittance_db: float, amplified: float) -> float:
    """What a result leaves open of an amplitude near this transmittance [dB], over U0.

    It repeats within the engine's residual, or its own where the motion is not certified, and is `amplified` times that
    from its steady state. A contact that the engine cannot make harder gives way by up to `CREEP` times its residual
    slip compliance. Round-off
    adds up as the contract derives it for forty periods of `STEPS` steps of a motion as large as the base's: in
    proportion to the motion, and to the root of the number of steps, of all the periods that were simulated.
    """
    capabilities = variant.capabilities
    repeats = unresolved_amplitude(
        capabilities.residual if result.converged else max(capabilities.residual, result.residual),
        amplified,
        max(result.periods, 1) * result.steps_per_period,
        transmittance_db,
        TRAJECTORY_TOLERANCE[capabilities.precision],
    )
    return repeats + CREEP * variant.preset.residual_slip_compliance


def amplification(reference: Result) -> float:
    """How many times farther from its steady state than its residual a motion may be, by the reference's at the point.

    `AMPLIFICATION_MARGIN` times that of the reference, since the engine's scheme is another one.
    """
    return AMPLIFICATION_MARGIN * reference.amplification


def case_tasks(variant: Variant, case: SteadyCase) -> list[SteadyStateTask]:
    """Give the tasks of a variant in a case."""
    refinements = SCHEME if variant == REFERENCE else (COARSE, FINE)
    return [case.task(variant, refinement) for refinement in refinements]


def third_task(variant: Variant, case: SteadyCase) -> SteadyStateTask:
    """Give the task of a variant whose error two steps do not show well enough."""
    return case.task(variant, FINEST)


def collect_evidence(
    variant: Variant,
    case: SteadyCase,
    expected: Expected,
    results: Mapping[SteadyStateTask, Result],
    skip_reason: Comparison | None = None,
) -> Evidence:
    """Collect what is known of a variant in a case, from the results of its `case_tasks` and of those of the reference.

    Tasks that were skipped are `missing`.
    """
    own = [results.get(task, Result.missing()) for task in case_tasks(variant, case)]
    third = results.get(third_task(variant, case))
    return Evidence(
        variant=variant,
        case=case,
        coarse=own[0],
        fine=own[1],
        scheme=tuple(results[task] for task in case_tasks(REFERENCE, case)),
        expected=expected,
        finest=third if third is not None and third.converged else None,
        skip_reason=skip_reason,
    )
