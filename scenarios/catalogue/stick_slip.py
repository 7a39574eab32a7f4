"""When the stick–slip motions of two simulations are the same: the definitions, for every engine alike.

*Mode.* A contact sticks in a step while its friction is below its bound by more than the preset's stick margin
(`reference_lcp.observables.stick_slip.contact_modes`). The event-driven solver knows its modes without a margin.

*Matching.* A transition of the engine and one that is expected are the same if they are of one cell, to one mode, and
at most `MATCHING_WINDOW` of the period apart; they are paired one to one, the closest first.

*Grazing.* Whether a phase that barely begins is there can hang on the step. A transition is compared only where the
step does not decide on it: an expected one if the reference has it with all its numbers of steps; one that is not
expected if the reference has it with none of them. A slip of the expected motion that travels less than four residuals
of the engine is read as stick, as it is in the engine's own motion.

*Expected* is the exact motion, or where there is none the reference at its finest steps, with their error as a bar; of
presets that share the scheme it is the reference at equal steps. Times may be off by one step, the resolution of a
sampled motion, and by the error of the scheme or what the preset states; a stuck fraction likewise, by one step a
stick.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from multibody_xval.scenarios.catalogue.scenario import STICK_SLIP, Exact
from multibody_xval.scenarios.model import Case, Result, Run
from multibody_xval.scenarios.ruler.exact_values import has_exact_motion
from multibody_xval.scenarios.ruler.judge import AT_EQUAL_STEPS, EXACT_VALUE
from reference_lcp.observables.stick_slip import UNREPEATED_SLIP, Mode, TimedTransition, match_transitions
from reference_lcp.steady.richardson import richardson_error

Row = dict[str, Any]

MISSED, SPURIOUS, TIME, STUCK = (quantity.name for quantity in STICK_SLIP)

QUARTER_PERIOD, WHOLE_PERIOD = 0.25, 1.0
"""What friction changes at all of the time of a transition, and of a stuck fraction: a contact that sticks and slips
both ways has four transitions."""


class Sides(NamedTuple):
    """What is compared: an engine's motion, what is expected of it, and the reference's by number of steps."""

    own: Result
    expected: Result
    ladder: Mapping[int, Result]
    shares: bool
    exact: bool
    """Whether what is expected is the exact motion."""

    @property
    def steps(self) -> int:
        """Give the steps per period of the engine."""
        return min(self.ladder)

    def scheme_error(self, values: Sequence[float]) -> float:
        """Give the error of the scheme, from values by ascending steps; none beside the reference at equal steps."""
        return 0.0 if self.shares else richardson_error(tuple(self.ladder), tuple(values), self.steps)

    def bar(self, values: Sequence[float]) -> float:
        """Give the error bar of what is expected, likewise: that of the finest steps where there is no exact motion."""
        known = self.shares or self.exact
        return 0.0 if known else richardson_error(tuple(self.ladder), tuple(values), max(self.ladder))


def stick_slip(
    run: Run, own: Result, exact: Result | None, ladder: Mapping[int, Result], about: Mapping[str, Any]
) -> dict[str, Row]:
    """Give the numbers of `STICK_SLIP` by name; none where the exact motion or the reference is missing."""
    if not ladder or (exact is None and has_exact_motion(run.of(Case))):
        return {}
    shares = bool(about["shares_scheme"])
    right = ladder[min(ladder)] if shares else exact or ladder[max(ladder)]
    sides = Sides(own, as_resolved(right, own.residual), ladder, shares, exact is not None)
    accuracy = run.config.preset.accuracy_of
    rows = {
        MISSED: _row(len(missed(sides)), 0.0),
        SPURIOUS: _row(len(spurious(sides)), 0.0),
        TIME: _time(sides, accuracy("time")),
        STUCK: _stuck(sides, accuracy("stuck fraction")),
    }
    common = {
        "exact_kind": str(Exact.LADDER if exact is None else Exact.MOTION),
        "expected": AT_EQUAL_STEPS if shares else EXACT_VALUE,
    }
    return {name: row | common for name, row in rows.items()}


def _row(value: float, exact: float, of: float = math.inf, **sizes: float) -> Row:
    """Give a number beside what is expected, and the sizes that decide."""
    none = dict.fromkeys(("exact_bar", "scheme_error", "resolution", "stated"), 0.0)
    apart = {"value": value, "exact": exact, "error": value - exact, "distance": abs(value - exact)}
    return {**apart, "size": of, "effect": of, **none, **sizes}


def as_resolved(exact: Result, residual: float) -> Result:
    """Read the expected motion as an engine's residual lets its own be read: slips too short for it as stick."""
    shortest, travels = UNREPEATED_SLIP * residual, exact.series.get("travels", ())
    stuck, transitions = list(exact.stuck), []
    for cell in dict.fromkeys(change[0] for change in exact.transitions):
        own = [pair for pair in zip(exact.transitions, travels, strict=True) if pair[0][0] == cell]
        kinds = [str(Mode.STICK) if travel < shortest else change[2] for change, travel in own]
        for index, ((_, time, kind), _) in enumerate(own):
            if kind != kinds[index]:
                stuck[cell - 1] += (own[(index + 1) % len(own)][0][1] - time) % 1.0
            if kinds[index] != kinds[index - 1]:
                transitions.append((cell, time, kinds[index]))
    return Result(status=exact.status, stuck=tuple(stuck), transitions=tuple(transitions))


def _errors(result: Result, expected: Sequence[TimedTransition]) -> dict[TimedTransition, float]:
    """Give the time errors, over the period, of the expected transitions that a result has."""
    return match_transitions(result.transitions, expected, 1.0).errors


def _decided(sides: Sides) -> list[TimedTransition]:
    """Give the expected transitions that the reference has with all its numbers of steps."""
    scheme = [_errors(own, sides.expected.transitions) for own in sides.ladder.values()]
    return [change for change in sides.expected.transitions if all(change in errors for errors in scheme)]


def missed(sides: Sides) -> list[TimedTransition]:
    """Give the expected transitions that an engine does not have, whatever the step."""
    own = _errors(sides.own, sides.expected.transitions)
    return [change for change in _decided(sides) if change not in own]


def spurious(sides: Sides) -> list[TimedTransition]:
    """Give the transitions of an engine that are not expected, and that the reference has with no number of steps."""
    extra = match_transitions(sides.own.transitions, sides.expected.transitions, 1.0).spurious
    scheme = [_errors(own, extra) for own in sides.ladder.values()]
    return [change for change in extra if not any(change in errors for errors in scheme)]


def _time(sides: Sides, stated: float) -> Row:
    """Give the time error [% T] of the transition that is worst beside what is allowed; zero where none matches."""
    own = _errors(sides.own, sides.expected.transitions)
    scheme = [_errors(each, sides.expected.transitions) for each in sides.ladder.values()]
    rows = []
    for change in (each for each in _decided(sides) if each in own):
        errors = [100 * each[change] for each in scheme]
        bar, error = sides.bar(errors), sides.scheme_error(errors)
        row = _row(
            100 * abs(own[change]), 0.0, 100 * QUARTER_PERIOD,
            exact_bar=bar, scheme_error=error, resolution=100 / sides.steps, stated=100 * stated,
        )  # fmt: skip
        rows.append(row)
    return max(rows, key=_excess, default=_row(0.0, 0.0))


def _stuck(sides: Sides, stated: float) -> Row:
    """Give the stuck fraction of the contact that is worst beside what is allowed."""
    rows = []
    for cell, expected in enumerate(sides.expected.stuck):
        sticks = sum((change[0], change[2]) == (cell + 1, str(Mode.STICK)) for change in sides.expected.transitions)
        fractions = [own.stuck[cell] for own in sides.ladder.values()]
        bar, error = sides.bar(fractions), sides.scheme_error(fractions)
        row = _row(
            sides.own.stuck[cell], expected, WHOLE_PERIOD,
            exact_bar=bar, scheme_error=error, resolution=max(sticks, 1) / sides.steps, stated=stated,
        )  # fmt: skip
        rows.append(row)
    return max(rows, key=_excess)


def _excess(row: Row) -> float:
    return float(row["distance"] / (row["exact_bar"] + max(row["scheme_error"], row["stated"]) + row["resolution"]))
