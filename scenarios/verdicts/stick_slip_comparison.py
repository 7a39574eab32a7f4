"""When the stick–slip motions of two simulations are the same: the definitions, for every engine alike.

*Mode.* A contact sticks in a step while its friction is below its bound by more than the preset's stick margin
(`reference_lcp.observables.stick_slip.contact_modes`), and slips the way that its friction opposes; exact,
regularised and bristle laws are read alike. A stick of one step is a reversal of the slip; a slip
shorter than four residuals of the orbit is none. The event-driven solver knows its modes without a margin.

*Matching.* A transition of the engine and one of the expected motion are the same if they are of one cell, to one
mode, and at most `MATCHING_WINDOW` of the period apart; they are paired one to one, the closest first.

*Dead band.* Whether a phase that barely begins (grazing) is there can hang on the step. A transition is compared only
where the step does not decide on it: an expected one if the reference has it with each of its three steps; one that
is not expected if the reference has it with none of them. Others are left out and counted as undecided.

A slip of the expected motion that travels less than four residuals of the engine is read as stick, as it is in the
engine's own motion: single precision does not tell it from one.

*Missed, spurious.* Expected transitions that the engine does not have, and others that it has, beyond the dead band.
If the engine itself has them with one of its two steps only, its step is too coarse to tell: inconclusive.

*Time errors* are allowed, transition by transition: the engine's own error, from its two steps; no less than the
reference's at the same step; and one step, the resolution of a sampled motion.

*Stuck fraction*: of each contact, with the same three parts; the resolution is one step a stick.

*Creep* is the largest relative velocity within a stick, over ω U0. Expected is none. What a slip too short to be
counted makes in one step is allowed, and what a preset's stated softness leaves to a contact.
"""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from engines.interface.tolerances import CREEP
from reference_lcp.observables.stick_slip import UNREPEATED_SLIP, Mode
from reference_lcp.observables.transition_matching import TimedTransition, match_transitions
from scenarios.tasks.result import Result
from scenarios.verdicts.finding import Finding, Metric
from scenarios.verdicts.judge import Steps, decide, judge
from scenarios.verdicts.steady_case import Evidence, Expected
from scenarios.verdicts.verdict import Comparison, Tolerance, Verdict

_STICK = str(Mode.STICK)

MISSED = Metric("missed", "", "transitions of the expected motion that the engine does not have")
SPURIOUS = Metric("spurious", "", "transitions of the engine that the expected motion does not have")
MEDIAN_TIME = Metric("median time error", "% T", "of the transitions that match, in percent of the period")
LARGEST_TIME = Metric("largest time error", "% T", "of the transition that is worst beside what is allowed for it")
STUCK_FRACTION = Metric("stuck fraction", "", "part of the period that the worst contact sticks")
CREEP_VELOCITY = Metric("creep", "ω U0", "largest relative velocity of a contact within a stick")

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


def stick_slip_findings(found: Evidence) -> list[Finding]:
    """Compare stick and slip: a finding for each of `STICK_SLIP_METRICS`, in their order."""
    if found.missing is not None:
        return [
            Finding(found.variant, found.case.label, metric, math.nan, math.nan, found.missing)
            for metric in STICK_SLIP_METRICS
        ]
    found = dataclasses.replace(found, expected=as_resolved(found))
    return [
        _counted(found, MISSED, *_missed(found)),
        _counted(found, SPURIOUS, *_spurious(found)),
        *_times(found),
        _stuck(found),
        _creep(found),
    ]


def as_resolved(found: Evidence) -> Expected:
    """Read the expected motion as the engine's residual lets its own be read: slips too short for it as stick."""
    expected, period = found.expected, found.fine.period
    shortest = UNREPEATED_SLIP * found.variant.capabilities.residual
    travels = expected.travels or (math.inf,) * len(expected.transitions)
    stuck, kept = list(expected.stuck_fraction), []
    for cell in dict.fromkeys(one[0] for one in expected.transitions):
        own = [(one, way) for one, way in zip(expected.transitions, travels, strict=True) if one[0] == cell]
        kinds = [_STICK if way < shortest else one[2] for one, way in own]
        for place, ((_, time, kind), _) in enumerate(own):
            if kind != kinds[place]:
                following = own[(place + 1) % len(own)][0][1]
                stuck[cell - 1] += (following - time) / period % 1.0
            if kinds[place] != kinds[place - 1]:
                kept.append((cell, time, kinds[place]))
    return dataclasses.replace(expected, transitions=tuple(kept), stuck_fraction=tuple(stuck), travels=())


def _errors(answer: Result, expected: Sequence[TimedTransition]) -> dict[TimedTransition, float]:
    """Time error of every expected transition that an answer has, over the period."""
    match = match_transitions(answer.transitions, expected, answer.period)
    return {pair[1]: error for pair, error in zip(match.pairs, match.time_errors, strict=True)}


def _missed(found: Evidence) -> tuple[list[TimedTransition], list[TimedTransition], int]:
    """Give the missed transitions, those of them that the coarse answer has, and how many are undecided."""
    expected = found.expected.transitions
    decided = [one for one in expected if all(one in _errors(answer, expected) for answer in found.scheme)]
    missed = [one for one in decided if one not in _errors(found.fine, expected)]
    step_dependent = [one for one in missed if one in _errors(found.coarse, expected)]
    return missed, step_dependent, len(expected) - len(decided)


def _spurious(found: Evidence) -> tuple[list[TimedTransition], list[TimedTransition], int]:
    """Give the spurious transitions, those of them that the coarse answer lacks, and how many are undecided."""
    extra = match_transitions(found.fine.transitions, found.expected.transitions, found.fine.period).spurious
    grazing = [one for one in extra if any(one in _errors(answer, extra) for answer in found.scheme)]
    spurious = [one for one in extra if one not in grazing]
    step_dependent = [one for one in spurious if one not in _errors(found.coarse, spurious)]
    return spurious, step_dependent, len(grazing)


def _counted(
    found: Evidence, metric: Metric, wrong: list[TimedTransition], step_dependent: list[TimedTransition], undecided: int
) -> Finding:
    """Judge a number of transitions, none of which is expected."""
    total = len(found.expected.transitions)
    aside = f"; {undecided} grazing ones left out" if undecided else ""
    if not wrong:
        comparison = Comparison(Verdict.AGREE, f"none, of {total}{aside}", 0.0, 0.0)
    elif len(step_dependent) == len(wrong):
        reason = f"{len(wrong)} of {total}, none of them with both of the engine's steps{aside}"
        comparison = Comparison(Verdict.INCONCLUSIVE, reason, float(len(wrong)), 0.0)
    else:
        cell, time, kind = next(one for one in wrong if one not in step_dependent)
        first = f"cell {cell} to {kind} at {100 * time / found.fine.period:.1f} % of the period"
        comparison = Comparison(Verdict.DISAGREE, f"{len(wrong)} of {total}: {first}{aside}", float(len(wrong)), 0.0)
    return Finding(found.variant, found.case.label, metric, float(len(wrong)), 0.0, comparison)


def time_errors(found: Evidence) -> list[TimeError]:
    """Give the errors of all matched transitions that the dead band does not leave out."""
    expected = found.expected.transitions
    coarse, fine = _errors(found.coarse, expected), _errors(found.fine, expected)
    scheme = [_errors(answer, expected) for answer in found.scheme]
    errors = []
    for one, error in fine.items():
        if not all(one in answer for answer in scheme):
            continue
        own = {found.fine.steps_per_period: 100 * error}
        if one in coarse:
            own[found.coarse.steps_per_period] = 100 * coarse[one]
        steps = {
            result.steps_per_period: 100 * answer[one] for result, answer in zip(found.scheme, scheme, strict=True)
        }
        tolerance = Tolerance(
            engine=Steps(own).error(LARGEST_TIME),
            scheme=Steps(steps, found.scheme[1].steps_per_period).error(LARGEST_TIME),
            resolution=100 / found.fine.steps_per_period,
        )
        errors.append(TimeError(one, 100 * abs(error), tolerance))
    return errors


def _times(found: Evidence) -> tuple[Finding, Finding]:
    """Judge the median and the worst time error."""
    errors = time_errors(found)
    variant, label = found.variant, found.case.label
    if not errors:
        nothing = Comparison(Verdict.INCONCLUSIVE, "no transition matches an expected one")
        median, largest = (
            Finding(variant, label, metric, math.nan, 0.0, nothing) for metric in (MEDIAN_TIME, LARGEST_TIME)
        )
        return median, largest
    parts = [dataclasses.asdict(one.tolerance) for one in errors]
    middle = Tolerance(**{part: float(np.median([one[part] for one in parts])) for part in parts[0]})
    size = float(np.median([one.size for one in errors]))
    worst = max(errors, key=lambda one: one.ratio)
    return (
        Finding(variant, label, MEDIAN_TIME, size, 0.0, decide(MEDIAN_TIME, size, 0.0, middle)),
        Finding(variant, label, LARGEST_TIME, worst.size, 0.0, decide(LARGEST_TIME, worst.size, 0.0, worst.tolerance)),
    )


def _stuck(found: Evidence) -> Finding:
    """Judge the stuck fraction of the contact that is worst beside what is allowed for it."""
    judged = []
    for cell, expected in enumerate(found.expected.stuck_fraction):
        sticks = sum(1 for change in found.expected.transitions if (change[0], change[2]) == (cell + 1, _STICK))
        read = partial(_stuck_fraction, cell)
        resolution = max(sticks, 1) / found.fine.steps_per_period
        comparison = judge(
            STUCK_FRACTION, found.steps(read), expected, scheme=found.scheme_steps(read), resolution=resolution
        )
        judged.append((found.fine.stuck_fraction[cell], expected, comparison))
    fine, expected, comparison = max(judged, key=lambda one: one[2].excess)
    return Finding(found.variant, found.case.label, STUCK_FRACTION, fine, expected, comparison)


def _stuck_fraction(cell: int, result: Result) -> float:
    return result.stuck_fraction[cell]


def _creep(found: Evidence) -> Finding:
    """Judge the creep of the contact that creeps most; there is none in Coulomb's law."""
    residual, steps = found.variant.capabilities.residual, found.fine.steps_per_period
    comparison = judge(
        CREEP_VELOCITY,
        found.steps(lambda result: max(result.creep)),
        0.0,
        # a slip of so many residuals, all of it in one step of 2π / (ω steps)
        resolution=UNREPEATED_SLIP * residual * steps / (2 * math.pi)
        + CREEP * found.variant.preset.residual_slip_compliance,
    )
    return Finding(found.variant, found.case.label, CREEP_VELOCITY, max(found.fine.creep), 0.0, comparison)
