"""Questions that engines are asked, and their answers, as plain data."""

import dataclasses
import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from typing import Any, NamedTuple, Self

from engines.interface.registry import engine
from engines.interface.variant import Variant
from reference_lcp.chain.harmonic import HarmonicBase, HarmonicForce, PeriodicDrive
from reference_lcp.chain.mass_in_mass import CHAIN_STIFFNESS, Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import MINIMUM_STEPS_PER_PERIOD, Lane, steps_per_period_for
from reference_lcp.observables.stick_slip import STICK_MARGIN
from reference_lcp.steady.orbits import OrbitStatus
from reference_lcp.steady.subharmonics import LONGEST_MULTIPLE
from reference_lcp.validation import ParameterError, checked_array, checked_choice, checked_count, checked_scalar

RESULT_FORMAT = 2
"""Raised when the meaning of an answer changes: answers of other formats are not taken from a store."""


Ratio = float | tuple[float, ...]
"""One number for all cells, or one a cell."""

Series = Mapping[str, tuple[float, ...]]
"""Numbers by name: what is kept of a motion."""


BASE_AMPLITUDE = 0.01
"""U0 [m] of a base motion unless an amplitude is given; with friction given as a ratio it changes no answer."""


@dataclass(frozen=True, kw_only=True)
class Excitation:
    """What drives the chain at the frequency of a question.

    Parameters
    ----------
    kind
        ``base``: the base moves; ``force``: a force acts on the outer mass of cell 1.
    amplitude
        Of the base U0 [m], or of the force P0 [N]; > 0.

    Raises
    ------
    ParameterError
        If the kind is unknown or the amplitude is not > 0.
    """

    kind: str = "base"
    amplitude: float = BASE_AMPLITUDE

    def __post_init__(self) -> None:
        checked_choice("drive.kind", self.kind, EXCITATIONS)
        checked_scalar("drive.amplitude", self.amplitude, "> 0")

    @property
    def displacement(self) -> float:
        """Length [m] that friction and displacements are referred to: U0, or P0 / k_c."""
        return self.amplitude if self.kind == "base" else self.amplitude / CHAIN_STIFFNESS

    def drive(self, chain: Chain, frequency_ratio: float) -> PeriodicDrive:
        """Drive a chain at η_r = ω / ω_r."""
        base = HarmonicBase.from_ratio(chain, frequency_ratio, self.displacement)
        return base if self.kind == "base" else HarmonicForce(self.amplitude, base.angular_frequency)


DEFAULT_AMPLITUDE = {"base": BASE_AMPLITUDE, "force": CHAIN_STIFFNESS * BASE_AMPLITUDE}
"""U0 [m] or P0 [N] by kind: the same displacement scale for both."""

EXCITATIONS = tuple(DEFAULT_AMPLITUDE)


@dataclass(frozen=True, kw_only=True)
class ChainRatios:
    """The chain but for its friction, non-dimensional; the defaults are the canonical case of figure 3.

    The parameters are those of `Chain.from_ratios`; every ratio is a number, or one a cell.

    Parameters
    ----------
    friction_profile
        μ λ_N of each cell over that which a friction ratio asks for, where cells differ.
    """

    cells: int = 7
    mass_ratio: Ratio = 1.0
    stiffness_ratio: Ratio = 1.0
    damping_ratio: Ratio = 0.01
    inner_damping_ratio: Ratio = 0.0
    outer_mass_ratio: Ratio = 1.0
    chain_stiffness_ratio: Ratio = 1.0
    friction_profile: Ratio = 1.0

    def chain(self, friction_ratio: Ratio, base_amplitude: float = BASE_AMPLITUDE) -> Chain:
        """Build the chain with this friction ratio μ λ_N / (k_c U0), U0 [m] being the amplitude of the base."""
        ratios = dict(vars(self))
        profile = checked_array("friction_profile", ratios.pop("friction_profile"), ">= 0")
        bound = checked_array("friction_ratio", friction_ratio, ">= 0") * profile
        return Chain.from_ratios(friction_ratio=bound, base_amplitude=base_amplitude, **ratios)

    def as_data(self) -> dict[str, Any]:
        """Give the ratios as plain data; those in which cells may differ beside the paper's are left out where not."""
        return {name: value for name, value in vars(self).items() if name not in _OF_UNEQUAL_CELLS or value != 1.0}


_OF_UNEQUAL_CELLS = ("outer_mass_ratio", "chain_stiffness_ratio", "friction_profile")


_COMPACT = json.JSONEncoder(separators=(",", ":"))
_SORTED = json.JSONEncoder(sort_keys=True)


def key_of(text: str) -> str:
    """Hash of a question's text, under which its answer is kept."""
    return hashlib.sha256(text.encode()).hexdigest()


@dataclass(frozen=True, kw_only=True)
class Modulation:
    """A preload that changes in step with the drive, non-dimensional.

    Parameters
    ----------
    modulation
        a >= 0, of N = N0 (1 + a sin(Ω t + φ)); above 1 contacts open.
    multiple
        Ω / ω, a whole number, so that the motion may have the drive's period.
    phase
        φ [rad].
    """

    modulation: float
    multiple: int = 1
    phase: float = 0.0

    def __post_init__(self) -> None:
        checked_scalar("modulation", self.modulation, ">= 0")
        checked_count("modulation_multiple", self.multiple)
        checked_scalar("modulation_phase", self.phase)

    def preload(self, drive: PeriodicDrive) -> Preload:
        """Give the preload under this drive."""
        return Preload.at_multiple(drive, self.modulation, self.multiple, self.phase)


@dataclass(frozen=True, kw_only=True)
class Task:
    """What every question says: who is asked, and about which chain.

    Parameters
    ----------
    variant
        Who is asked.
    ratios
        The chain but for its friction.
    friction_ratio
        μ λ_N / (k_c U0), a number or one a cell.
    """

    variant: Variant
    friction_ratio: Ratio
    ratios: ChainRatios = field(default_factory=ChainRatios)

    @property
    def chain(self) -> Chain:
        """Build the chain."""
        return self.ratios.chain(self.friction_ratio)

    def unsupported_reason(self) -> str | None:
        """Say why the variant cannot represent the case, as far as that is known without asking it."""
        return None

    def content(self) -> dict[str, Any]:
        """Everything that the answer depends on: the question, the engine's version and its options."""
        return {"format": RESULT_FORMAT, "question": self.as_data(), **_identity(self.variant)}

    def as_data(self) -> dict[str, Any]:
        """Give the question as plain data, ready for JSON."""
        data: dict[str, Any] = _plain(self)
        return data | {"ratios": self.ratios.as_data()}

    def key(self) -> str:
        """Hash of the content: equal for equal questions to equal engines."""
        return key_of(self.text())

    def text(self) -> str:
        """Give the content as JSON, one text for equal contents."""
        return _SORTED.encode(self.content())


@dataclass(frozen=True, kw_only=True)
class SteadyStateTask(Task):
    """The steady state of one chain under one harmonic excitation, by one variant.

    Parameters
    ----------
    variant, ratios, friction_ratio
        As for `Task`.
    frequency_ratio
        ω / ω_r, with ω_r of the first cell.
    steps_per_period
        Fewest steps a period; more are taken where dt ω_max <= 0.4 asks for them.
    excitation
        What drives the chain; a moving base unless something else is given.
    modulation
        How the normal force changes over the period; ``None`` where it is constant.
    """

    frequency_ratio: float
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD
    excitation: Excitation = field(default_factory=Excitation)
    modulation: Modulation | None = None

    @property
    def chain(self) -> Chain:
        """Build the chain, whose friction is referred to this excitation."""
        return self.ratios.chain(self.friction_ratio, self.excitation.displacement)

    def as_data(self) -> dict[str, Any]:
        """Give the question as plain data; what is usual (excitation, constant normal force) is left out."""
        data = super().as_data()
        if self.excitation == USUAL_EXCITATION:
            del data["excitation"]
        if self.modulation is None:
            del data["modulation"]
        return data

    def setting(self) -> tuple[Chain, PeriodicDrive]:
        """Build the chain and its drive."""
        chain = self.chain
        return chain, self.excitation.drive(chain, self.frequency_ratio)

    def unsupported_reason(self) -> str | None:
        """Say why the variant cannot change its normal force like this; ``None`` if it can, or it is constant."""
        if self.modulation is None:
            return None
        return self.variant.preset.unsupported_reason(self.lane()[0], str(self.variant))

    def lane(self) -> tuple[Lane, int]:
        """Build the lane, and give its number of steps a period."""
        chain, drive = self.setting()
        steps = steps_per_period_for(chain, drive, self.steps_per_period)
        preload = None if self.modulation is None else self.modulation.preload(drive)
        return Lane.periodic(chain, drive, steps, preload), steps

    def content(self) -> dict[str, Any]:
        """Everything that the answer depends on: under a modulated normal force, the options for it."""
        content = super().content()
        if self.modulation is None:
            return content
        options = self.variant.preset.modulated().options
        return content | {"options": {name: repr(option.value) for name, option in sorted(options.items())}}


USUAL_EXCITATION = Excitation()


class ResultStatus(StrEnum):
    """How a question ended."""

    CONVERGED = OrbitStatus.CONVERGED.value
    """A certified steady state."""
    PERIOD_LIMIT = OrbitStatus.PERIOD_LIMIT.value
    """The search for a steady state gave up."""
    DIVERGED = OrbitStatus.DIVERGED.value
    """The search for a steady state left every bound."""
    FINISHED = "finished"
    """A motion was simulated to its end."""
    BLOCKED = "blocked"
    """The engine cannot answer; the reason says why."""
    MISSING = "missing"
    """There is no answer so far, because the question was not put to the engine."""

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
            raise ParameterError(f"status of an answer = {text!r}; allowed: {', '.join(cls)}") from None


@dataclass(frozen=True, kw_only=True)
class Result:
    """What came of a question.

    Parameters
    ----------
    status
        How the question ended.
    reason
        Why it is blocked or missing; empty otherwise.
    transmittance_db
        20 log10 |U_n| / U0; NaN where there is no number.
    residual
        Periodicity residual of the orbit; NaN where there is none.
    periods
        Periods simulated.
    multiple
        Periods of the drive after which the motion repeats, where one was looked for: more than one for a
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
        What is kept of a motion; empty for a steady state.

    Raises
    ------
    ParameterError
        If the status is unknown.
    """

    status: ResultStatus
    reason: str = ""
    transmittance_db: float = math.nan
    residual: float = math.nan
    periods: int = 0
    multiple: int = 1
    steps_per_period: int = 0
    period: float = math.nan
    stuck_fraction: tuple[float, ...] = ()
    transitions: tuple[tuple[int, float, str], ...] = ()
    creep: tuple[float, ...] = ()
    open_fraction: tuple[float, ...] = ()
    largest_gap: tuple[float, ...] = ()
    seconds: float = math.nan
    series: Series = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "status", ResultStatus.parse(self.status))

    @property
    def converged(self) -> bool:
        """Whether the numbers belong to a steady state."""
        return self.status is ResultStatus.CONVERGED

    @classmethod
    def blocked(cls, reason: str) -> Self:
        """Say why there is no answer."""
        return cls(status=ResultStatus.BLOCKED, reason=" ".join(reason.split()))

    @classmethod
    def missing(cls) -> Self:
        """Stand for an answer that nobody has given so far."""
        return cls(status=ResultStatus.MISSING, reason="not answered so far")

    def to_json(self) -> str:
        """Give the answer as JSON; NaN becomes null."""
        return _COMPACT.encode({name: None if _is_nan(value) else value for name, value in vars(self).items()})

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Read what `to_json` wrote."""
        numbers: dict[str, Any] = {
            name: math.nan if value is None else value for name, value in json.loads(text).items()
        }
        for name in ("stuck_fraction", "creep", "open_fraction", "largest_gap"):
            numbers[name] = tuple(numbers.get(name, ()))
        numbers["transitions"] = tuple((cell, time, kind) for cell, time, kind in numbers["transitions"])
        numbers["series"] = {name: tuple(values) for name, values in numbers.get("series", {}).items()}
        return cls(**numbers)


class ResultSummary(NamedTuple):
    """How a question ended: its answer without the numbers.

    Parameters
    ----------
    status, periods, multiple, reason
        As of `Result`.
    """

    status: ResultStatus
    periods: int = 0
    multiple: int = 1
    reason: str = ""

    @classmethod
    def of(cls, answer: Result) -> Self:
        """Take it from an answer."""
        return cls(answer.status, answer.periods, answer.multiple, answer.reason)

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Read the list [status, periods, multiple]; answers of old have no multiple."""
        status, periods, multiple = json.loads(text)
        return cls(ResultStatus.parse(status), periods, 1 if multiple is None else multiple)


def repetition(multiple: int) -> str:
    """Say after how many periods a motion without a steady state repeats; empty if nobody has looked."""
    if multiple == 0:
        return f", no period up to {LONGEST_MULTIPLE}"
    return f", period {multiple}" if multiple > 1 else ""


@cache
def _identity(variant: Variant) -> dict[str, Any]:
    """Version and options that a variant's answers depend on."""
    asked = engine(variant.engine)
    preset = asked.preset(variant.formulation, variant.preset_name)
    identity: dict[str, Any] = {
        "version": asked.version(),
        "options": {name: repr(option.value) for name, option in sorted(preset.options.items())},
    }
    return identity if preset.stick_margin == STICK_MARGIN else identity | {"stick_margin": preset.stick_margin}


def _plain(value: Any) -> Any:
    """Give a dataclass as dictionaries, without the copies of `dataclasses.asdict` that took most of a key's time."""
    if not dataclasses.is_dataclass(value):
        return value
    return {name: _plain(part) for name, part in vars(value).items()}


def _is_nan(value: object) -> bool:
    return isinstance(value, float) and math.isnan(value)
