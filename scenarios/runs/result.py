"""The result of a task, as plain data."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from typing import Annotated, NoReturn, Self

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, TypeAdapter, ValidationError

from multibody_xval.scenarios.runs.parameters import first_error
from reference_lcp.chain.simulation import OrbitStatus
from reference_lcp.errors import ParameterError, shortened
from reference_lcp.observables.stick_slip import Mode, TimedTransition, TransitionMatch, match_transitions
from reference_lcp.steady.orbits import LONGEST_MULTIPLE
from reference_lcp.terminal import visible

LONGEST_REASON = 500
"""Characters of a reason: an engine may put a whole state into the text of an error."""

NOT_INSTALLED, UNREPRESENTABLE = "not installed", "cannot be represented"
"""How reasons begin where an engine has nothing to answer for: it is not there, or says that it lacks the ability."""

RESOLVED_DB = 1e-3
"""What a motion that is not certified may leave open of its transmittance to be compared all the same [dB].

That is a hundredth of a percent of the amplitude, and less than the step of any scheme here.
"""

NamedNumbers = Mapping[str, tuple[float, ...]]
"""Numbers by name."""


class ResultStatus(StrEnum):
    """How a task ended."""

    CONVERGED = OrbitStatus.CONVERGED.value
    """A certified steady state."""
    PERIOD_LIMIT = OrbitStatus.PERIOD_LIMIT.value
    """The search for a steady state gave up."""
    DIVERGED = OrbitStatus.DIVERGED.value
    """The search for a steady state left every bound."""
    FINISHED = "finished"
    """A motion was simulated to its end."""
    BLOCKED = "blocked"
    """The engine cannot run the task; see the reason."""
    MISSING = "missing"
    """There is no result so far: the task has not been run."""

    @classmethod
    def _missing_(cls, value: object) -> NoReturn:
        raise ParameterError(f"status of a result = {value!r}; allowed: {', '.join(cls)}")


_Status = Annotated[ResultStatus, BeforeValidator(ResultStatus)]
_Number = Annotated[float, BeforeValidator(lambda value: math.nan if value is None else value)]
"""NaN is written as null."""
_Count = Annotated[int, Field(ge=0, le=2**53)]
"""Whole numbers that a float holds."""
_Mode = Annotated[str, AfterValidator(cache(lambda text: str(Mode(text))))]


@dataclass(frozen=True, kw_only=True)
class Result:
    """The result of a task."""

    __pydantic_config__ = ConfigDict(extra="forbid", ser_json_inf_nan="null")

    status: _Status
    reason: str = ""
    """Why it is blocked or missing, or what is known of a steady state without dashpots; empty otherwise."""
    by_engine: bool = False
    """Whether a blocked task is blocked by its engine, which failed at it, and not by its circumstances, such as a
    worker that was killed: what is blocked by its engine is not tried again by itself.
    """
    transmittance_db: _Number = math.nan
    """20 log10 |U_n| / U0; NaN where there is no number."""
    phase: _Number = math.nan
    """By which the fundamental of the last outer mass is ahead of the drive's sine [rad], in (−π, π]; likewise."""
    residual: _Number = math.nan
    """Periodicity residual of the orbit; NaN where there is none."""
    amplification: _Number = math.nan
    """How many times farther from the steady state than its residual the motion may be, where the reference's scheme
    gives it; NaN elsewhere.
    """
    periods: _Count = 0
    multiple: _Count = 1
    """Periods of the drive after which the motion repeats, where repetition was searched for: more than one for a
    subharmonic response, 0 where no repetition was found.
    """
    steps_per_period: _Count = 0
    period: _Number = math.nan
    """Period of the drive [s]."""
    stuck_fraction: tuple[float, ...] = ()
    """Part of the period that each contact sticks."""
    transitions: tuple[tuple[_Count, float, _Mode], ...] = ()
    """Changes of mode as (cell from 1, time [s], new mode)."""
    creep: tuple[float, ...] = ()
    """Largest |ġ_T| of each contact within a stick, over ω and the displacement scale."""
    open_fraction: tuple[float, ...] = ()
    """Part of the period that each contact is open; empty where the normal force is constant."""
    largest_gap: tuple[float, ...] = ()
    """Largest g_N of each contact over the displacement scale; likewise."""
    seconds: _Number = math.nan
    """Wall-clock time that the point took, an even share of its batch."""
    series: NamedNumbers = field(default_factory=dict)
    """Other numbers by name: what a `TransientTask` or a `SteadyStateTask` records; ``travels`` of an exact steady
    state, the distance over the displacement scale that a contact slips after each transition.
    """

    def __post_init__(self) -> None:
        object.__setattr__(self, "status", ResultStatus(self.status))
        if self.reason:  # a text of an engine, or of somebody's store
            object.__setattr__(self, "reason", visible(self.reason))

    @property
    def converged(self) -> bool:
        """Whether the numbers belong to a steady state."""
        return self.status is ResultStatus.CONVERGED

    @property
    def failed(self) -> bool:
        """Whether it is blocked although its engine is there and does not refuse it: a crash, the time limit, NaN."""
        blocked = self.status is ResultStatus.BLOCKED
        return blocked and not self.reason.startswith((NOT_INSTALLED, UNREPRESENTABLE))

    def stuck_difference(self, other: "Result") -> float:
        """Give the largest difference of a contact's stuck fraction; NaN where the contacts are not equally many."""
        if len(self.stuck_fraction) != len(other.stuck_fraction):
            return math.nan
        pairs = zip(self.stuck_fraction, other.stuck_fraction, strict=True)
        return max((abs(one - two) for one, two in pairs), default=0.0)

    def matched(self, expected: Sequence[TimedTransition]) -> TransitionMatch:
        """Match the transitions with the expected ones, see `match_transitions`."""
        return match_transitions(self.transitions, expected, self.period)

    @classmethod
    def blocked(cls, reason: str, *, by_engine: bool = False) -> Self:
        """Give a result without numbers, with the reason, in one line of at most about `LONGEST_REASON` characters."""
        short = shortened(" ".join(reason.split()), LONGEST_REASON)
        return cls(status=ResultStatus.BLOCKED, reason=short, by_engine=by_engine)

    @classmethod
    def missing(cls) -> Self:
        """Give the result of a task that has not been run."""
        return cls(status=ResultStatus.MISSING, reason="not evaluated so far")

    def to_json(self) -> str:
        """Give the result as JSON; NaN becomes null."""
        return _RESULT.dump_json(self).decode()

    @staticmethod
    def from_json(text: str | bytes) -> "Result":
        """Read what `to_json` wrote; an error names the first field that is wrong."""
        try:
            return _RESULT.validate_json(text)
        except ValidationError as problem:
            raise first_error(problem, ", ".join(vars(Result.missing()))) from None


_RESULT = TypeAdapter(Result)


def repetition(multiple: int) -> str:
    """Give the number of periods after which a motion without a steady state repeats, in words; empty if unknown."""
    if multiple == 0:
        return f", no period up to {LONGEST_MULTIPLE}"
    return f", period {multiple}" if multiple > 1 else ""
