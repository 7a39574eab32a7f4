"""The result of a task, as plain data."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Annotated, Self, TypeVar

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, TypeAdapter, ValidationError

from reference_lcp.observables.stick_slip import Mode
from reference_lcp.refusal import ParameterError, shortened
from reference_lcp.steady.orbits import OrbitStatus
from reference_lcp.steady.subharmonics import LONGEST_MULTIPLE
from scenarios.tasks.validation_message import first_error

LONGEST_REASON = 500
"""Characters of a reason: an engine may put a whole state into the text of an error."""

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
    def parse(cls, text: str) -> Self:
        """Give the status of this text.

        Raises
        ------
        ParameterError
            If there is no such status.
        """
        try:
            return cls(text)
        except ValueError:
            raise ParameterError(f"status of a result = {text!r}; allowed: {', '.join(cls)}") from None


_Status = Annotated[ResultStatus, BeforeValidator(ResultStatus.parse)]
_Number = Annotated[float, BeforeValidator(lambda value: math.nan if value is None else value)]
"""NaN is written as null."""
_Count = Annotated[int, Field(ge=0, le=2**53)]
"""Whole numbers that a float holds."""
_Mode = Annotated[str, AfterValidator(lambda text: str(Mode(text)))]


@dataclass(frozen=True, kw_only=True)
class Result:
    """The result of a task.

    Parameters
    ----------
    status
        How the task ended.
    reason
        Why it is blocked or missing; empty otherwise.
    by_engine
        Whether a blocked task is blocked by its engine, which failed at it, and not by its circumstances, such as a
        worker that was killed: what is blocked by its engine is not tried again by itself.
    transmittance_db
        20 log10 |U_n| / U0; NaN where there is no number.
    phase
        By which the fundamental of the last outer mass is ahead of the drive's sine [rad], in (−π, π]; likewise.
    residual
        Periodicity residual of the orbit; NaN where there is none.
    amplification
        How many times farther from the steady state than its residual the motion may be, where the reference's scheme
        gives it; NaN elsewhere.
    periods
        Periods simulated.
    multiple
        Periods of the drive after which the motion repeats, where repetition was searched for: more than one for a
        subharmonic response, 0 where no repetition was found.
    steps_per_period
        Steps a period that were taken.
    period
        Period of the drive [s].
    stuck_fraction
        Part of the period that each contact sticks.
    transitions
        Changes of mode as (cell from 1, time [s], new mode).
    creep
        Largest |ġ_T| of each contact within a stick, over ω and the displacement scale.
    open_fraction
        Part of the period that each contact is open; empty where the normal force is constant.
    largest_gap
        Largest g_N of each contact over the displacement scale; likewise.
    seconds
        Wall-clock time that the point took, an even share of its batch.
    series
        Other numbers by name: what a `TransientTask` or a `RecordedPeriodTask` records; ``travels`` of an exact
        steady state, the distance over the displacement scale that a contact slips after each transition.

    Raises
    ------
    ParameterError
        If the status is unknown.
    """

    __pydantic_config__ = ConfigDict(extra="forbid", ser_json_inf_nan="null")

    status: _Status
    reason: str = ""
    by_engine: bool = False
    transmittance_db: _Number = math.nan
    phase: _Number = math.nan
    residual: _Number = math.nan
    amplification: _Number = math.nan
    periods: _Count = 0
    multiple: _Count = 1
    steps_per_period: _Count = 0
    period: _Number = math.nan
    stuck_fraction: tuple[float, ...] = ()
    transitions: tuple[tuple[_Count, float, _Mode], ...] = ()
    creep: tuple[float, ...] = ()
    open_fraction: tuple[float, ...] = ()
    largest_gap: tuple[float, ...] = ()
    seconds: _Number = math.nan
    series: NamedNumbers = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "status", ResultStatus.parse(self.status))

    @property
    def converged(self) -> bool:
        """Whether the numbers belong to a steady state."""
        return self.status is ResultStatus.CONVERGED

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
        """Read what `to_json` wrote.

        Raises
        ------
        ParameterError
            If it is something else; the message names the field.
        """
        return _read(_RESULT, text)


@dataclass(frozen=True)
class ResultSummary:
    """How a task ended: its result without the numbers.

    Parameters
    ----------
    status, periods, multiple, reason, by_engine
        As of `Result`.
    """

    status: _Status
    periods: _Count = 0
    multiple: _Count = 1
    reason: str = ""
    by_engine: bool = False

    @classmethod
    def of(cls, result: "Result | ResultSummary") -> Self:
        """Take it from a result."""
        return cls(result.status, result.periods, result.multiple, result.reason, result.by_engine)

    @staticmethod
    def from_json(text: str | bytes) -> "ResultSummary":
        """Read it from what `Result.to_json` wrote."""
        return _read(_SUMMARY, text)


_RESULT, _SUMMARY = TypeAdapter(Result), TypeAdapter(ResultSummary)
_Read = TypeVar("_Read")


def _read(schema: TypeAdapter[_Read], text: str | bytes) -> _Read:
    """Read the text of a store; an error names the first field that is wrong."""
    try:
        return schema.validate_json(text)
    except ValidationError as problem:
        raise first_error(problem, ", ".join(vars(Result.missing()))) from None


def repetition(multiple: int) -> str:
    """Give the number of periods after which a motion without a steady state repeats, in words; empty if unknown."""
    if multiple == 0:
        return f", no period up to {LONGEST_MULTIPLE}"
    return f", period {multiple}" if multiple > 1 else ""
