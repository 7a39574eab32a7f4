"""When the stick–slip motions of two simulations are the same: the definitions, for every engine alike.

*Mode.* A contact sticks in a step while its friction is below its bound by more than the preset's stick margin
(`reference_lcp.observables.stick_slip.contact_modes`), and slips the way that its friction opposes; exact,
regularised and bristle laws are read alike. A stick of one step is a reversal of the slip; a slip
shorter than four residuals of the orbit is none. The event-driven solver knows its modes without a margin.

*Matching.* A transition of the engine and one of the expected motion are the same if they are of one cell, to one
mode, and at most `MATCHING_WINDOW` of the period apart; they are paired one to one, the closest first.

*Dead band.* Whether a phase that barely begins (grazing) is there can hang on the step. A transition is compared only
where the step does not decide on it: an expected one if the reference has it with each of its three steps; one that
is not expected if the reference has it with none of them. Others are left out and counted as inconclusive.

A slip of the expected motion that travels less than four residuals of the engine is read as stick, as it is in the
engine's own motion: single precision does not distinguish it from one.

*Missed, spurious.* Expected transitions that the engine does not have, and others that it has, beyond the dead band.
If the engine itself has them with one of its two steps only, its step is too coarse to decide: inconclusive.

*Time errors* are allowed, transition by transition: the engine's own error, from its two steps; no less than the
reference's at the same step; and one step, the resolution of a sampled motion.

*Stuck fraction*: of each contact, with the same three parts; the resolution is one step a stick.

*Creep* is the largest relative velocity within a stick, over ω U0. Expected is none. What a slip too short to be
counted makes in one step is allowed, and what a preset's residual slip compliance leaves to a contact.
"""

import dataclasses
import math
from dataclasses import dataclass
from functools import partial

import numpy as np

from multibody_xval.engines.interface.tolerances import CREEP
from multibody_xval.scenarios.verdicts.finding import Comparison, Finding, Metric, Tolerance, Verdict
from multibody_xval.scenarios.verdicts.judge import Steps, decide, judge
from multibody_xval.scenarios.verdicts.steady_case import Evidence, Expected
from reference_lcp.observables.stick_slip import UNREPEATED_SLIP, Mode, TimedTransition

_STICK = str(Mode.STICK)

MISSED = Metric("missed", "", "transitions of the expected motion that the engine does not have")
SPURIOUS = Metric("spurious", "", "transitions of the engine that the expected motion does not have")
WHOLE_PERIOD = 1.0
"""What friction changes of a stuck fraction at all: from nothing to the whole period."""

QUARTER_PERIOD = 0.25
"""What friction changes of the time of a transition at all: a contact that sticks and slips both ways has four."""

BASE_SPEED = 1.0
"""What friction changes of a velocity at all [ω U0]: from that of the base to none."""

MEDIAN_TIME = Metric(
    "median time error",
    "% T",
    "of the transitions that match, in percent of the period",
    effect=100 * QUARTER_PERIOD,
)
LARGEST_TIME = Metric(
    "largest time error",
    "% T",
    "of the transition that is worst beside what is allowed for it",
    effect=100 * QUARTER_PERIOD,
)
STUCK_FRACTION = Metric("stuck fraction", "", "part of the period that the worst contact sticks", effect=WHOLE_PERIOD)
CREEP_VELOCITY = Metric("creep", "ω U0", "largest relative velocity of a contact within a stick", effect=BASE_SPEED)

STICK_SLIP_METRICS = (MISSED, SPURIOUS, MEDIAN_TIME, LARGEST_TIME, STUCK_FRACTION, CREEP_VELOCITY)


@dataclass(frozen=True)
class TimeError:
    """The error of one matched transition, in percent of the period, and what is allowed of it."""

    transition: TimedTransition
    size: float
    tolerance: Tolerance

    @property
    def ratio(self) -> float:
        """Error over what is allowed."""
        return self.size / self.tolerance.allowed


def stick_slip_findings(evidence: Evidence) -> list[Finding]:
    """Compare stick and slip: a finding for each of `STICK_SLIP_METRICS`, in their order."""
    if evidence.missing is not None:
        return Finding.without_numbers(evidence.variant, evidence.case.label, STICK_SLIP_METRICS, evidence.missing)
    evidence = dataclasses.replace(evidence, expected=as_resolved(evidence))
    return [
        _counted(evidence, MISSED, *_missed(evidence)),
        _counted(evidence, SPURIOUS, *_spurious(evidence)),
        *_times(evidence),
        _stuck(evidence),
        _creep(evidence),
    ]


def as_resolved(evidence: Evidence) -> Expected:
    """Read the expected motion as the engine's residual lets its own be read: slips too short for it as stick."""
    expected, period = evidence.expected, evidence.fine.period
    shortest = UNREPEATED_SLIP * evidence.variant.capabilities.residual
    travels = expected.travels or (math.inf,) * len(expected.transitions)
    stuck, transitions = list(expected.stuck_fraction), []
    for cell in dict.fromkeys(change[0] for change in expected.transitions):
        pairs = zip(expected.transitions, travels, strict=True)
        own = [(change, travel) for change, travel in pairs if change[0] == cell]
        kinds = [_STICK if travel < shortest else change[2] for change, travel in own]
        for index, ((_, time, kind), _) in enumerate(own):
            if kind != kinds[index]:
                following = own[(index + 1) % len(own)][0][1]
                stuck[cell - 1] += (following - time) / period % 1.0
            if kinds[index] != kinds[index - 1]:
                transitions.append((cell, time, kinds[index]))
    return dataclasses.replace(expected, transitions=tuple(transitions), stuck_fraction=tuple(stuck), travels=())


def _missed(evidence: Evidence) -> tuple[list[TimedTransition], list[TimedTransition], int]:
    """Give the missed transitions, those of them that the coarse result has, and how many are inconclusive."""
    expected = evidence.expected.transitions
    coarse, fine, *scheme = _all_matched_errors(evidence)
    decided = [change for change in expected if all(change in errors for errors in scheme)]
    missed = [change for change in decided if change not in fine]
    return missed, [change for change in missed if change in coarse], len(expected) - len(decided)


def _all_matched_errors(evidence: Evidence) -> list[dict[TimedTransition, float]]:
    """Errors of the coarse result, of the fine one, and of the reference's."""
    results = (evidence.coarse, evidence.fine, *evidence.scheme)
    return [result.matched(evidence.expected.transitions).errors for result in results]


def _spurious(evidence: Evidence) -> tuple[list[TimedTransition], list[TimedTransition], int]:
    """Give the spurious transitions, those of them that the coarse result lacks, and how many are inconclusive."""
    extra = evidence.fine.matched(evidence.expected.transitions).spurious
    scheme = [result.matched(extra).errors for result in evidence.scheme]
    spurious = [change for change in extra if not any(change in errors for errors in scheme)]
    coarse = evidence.coarse.matched(spurious).errors
    return spurious, [change for change in spurious if change not in coarse], len(extra) - len(spurious)


def _counted(
    evidence: Evidence,
    metric: Metric,
    wrong: list[TimedTransition],
    step_dependent: list[TimedTransition],
    inconclusive: int,
) -> Finding:
    """Judge a number of transitions, none of which is expected."""
    total = len(evidence.expected.transitions)
    aside = f"; {inconclusive} grazing ones left out" if inconclusive else ""
    if not wrong:
        comparison = Comparison(Verdict.AGREE, f"none, of {total}{aside}", 0.0, 0.0)
    elif len(step_dependent) == len(wrong):
        reason = f"{len(wrong)} of {total}, none of them with both of the engine's steps{aside}"
        comparison = Comparison(Verdict.INCONCLUSIVE, reason, float(len(wrong)), 0.0)
    else:
        cell, time, kind = next(change for change in wrong if change not in step_dependent)
        first = f"cell {cell} to {kind} at {100 * time / evidence.fine.period:.1f} % of the period"
        comparison = Comparison(Verdict.DISAGREE, f"{len(wrong)} of {total}: {first}{aside}", float(len(wrong)), 0.0)
    return Finding(evidence.variant, evidence.case.label, metric, float(len(wrong)), 0.0, comparison)


def time_errors(evidence: Evidence) -> list[TimeError]:
    """Give the errors of all matched transitions that the dead band does not leave out."""
    coarse, fine, *scheme = _all_matched_errors(evidence)
    errors = []
    for change, error in fine.items():
        if not all(change in result for result in scheme):
            continue
        own = {evidence.fine.steps_per_period: 100 * error}
        if change in coarse:
            own[evidence.coarse.steps_per_period] = 100 * coarse[change]
        steps = {
            result.steps_per_period: 100 * by_transition[change]
            for result, by_transition in zip(evidence.scheme, scheme, strict=True)
        }
        tolerance = Tolerance(
            engine=Steps(own).error(LARGEST_TIME),
            scheme=Steps(steps, evidence.scheme[1].steps_per_period).error(LARGEST_TIME),
            resolution=100 / evidence.fine.steps_per_period,
        )
        errors.append(TimeError(change, 100 * abs(error), tolerance))
    return errors


def _times(evidence: Evidence) -> tuple[Finding, Finding]:
    """Judge the median and the worst time error."""
    errors = time_errors(evidence)
    variant, label = evidence.variant, evidence.case.label
    if not errors:
        nothing = Comparison(Verdict.INCONCLUSIVE, "no transition matches an expected one")
        median, largest = (
            Finding(variant, label, metric, math.nan, 0.0, nothing) for metric in (MEDIAN_TIME, LARGEST_TIME)
        )
        return median, largest
    parts = [dataclasses.asdict(error.tolerance) for error in errors]
    middle = Tolerance(**{part: float(np.median([tolerance[part] for tolerance in parts])) for part in parts[0]})
    size = float(np.median([error.size for error in errors]))
    worst = max(errors, key=lambda error: error.ratio)
    return (
        Finding(variant, label, MEDIAN_TIME, size, 0.0, decide(MEDIAN_TIME, size, 0.0, middle)),
        Finding(variant, label, LARGEST_TIME, worst.size, 0.0, decide(LARGEST_TIME, worst.size, 0.0, worst.tolerance)),
    )


def _stuck(evidence: Evidence) -> Finding:
    """Judge the stuck fraction of the contact that is worst beside what is allowed for it."""
    judged = []
    for cell, expected in enumerate(evidence.expected.stuck_fraction):
        sticks = sum(1 for change in evidence.expected.transitions if (change[0], change[2]) == (cell + 1, _STICK))
        read = partial(lambda cell, result: result.stuck_fraction[cell], cell)
        resolution = max(sticks, 1) / evidence.fine.steps_per_period
        comparison = judge(
            STUCK_FRACTION,
            evidence.steps(read),
            expected,
            scheme=evidence.scheme_steps(read, expected),
            resolution=resolution,
        )
        judged.append((evidence.fine.stuck_fraction[cell], expected, comparison))
    fine, expected, comparison = max(judged, key=lambda contact: contact[2].excess)
    return Finding(evidence.variant, evidence.case.label, STUCK_FRACTION, fine, expected, comparison)


def _creep(evidence: Evidence) -> Finding:
    """Judge the creep of the contact that creeps most; there is none in Coulomb's law."""
    residual, steps = evidence.variant.capabilities.residual, evidence.fine.steps_per_period
    comparison = judge(
        CREEP_VELOCITY,
        evidence.steps(lambda result: max(result.creep)),
        0.0,
        # a slip of so many residuals, all of it in one step of 2π / (ω steps)
        resolution=UNREPEATED_SLIP * residual * steps / (2 * math.pi)
        + CREEP * evidence.variant.preset.residual_slip_compliance,
    )
    return Finding(evidence.variant, evidence.case.label, CREEP_VELOCITY, max(evidence.fine.creep), 0.0, comparison)
