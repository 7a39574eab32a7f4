"""Parameters of a task: the chain in ratios, its excitation, the modulation of its normal force."""

from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Annotated, Any, NamedTuple

from pydantic import ConfigDict, Discriminator, Field, Tag, TypeAdapter, ValidationError

from reference_lcp import defaults
from reference_lcp.chain.drives import HarmonicBase, HarmonicForce, PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.errors import ParameterError, checked_choice, choices, shown
from reference_lcp.validation import (
    LARGEST_DECIBEL,
    LARGEST_PARAMETER,
    LARGEST_UNIT,
    MOST_CELLS,
    checked_array,
    checked_count,
    checked_scalar,
)

Positive = Annotated[float, Field(gt=0, le=LARGEST_PARAMETER, allow_inf_nan=False, strict=True)]
NotNegative = Annotated[float, Field(ge=0, le=LARGEST_PARAMETER, allow_inf_nan=False, strict=True)]
Decibel = Annotated[float, Field(gt=0, le=LARGEST_DECIBEL, allow_inf_nan=False, strict=True)]


def _kind_of_ratio(value: object) -> str:
    return "one a cell" if isinstance(value, list | tuple) else "one for all"


_ByKind = Discriminator(_kind_of_ratio)
_OneForAll, _OneACell = Tag("one for all"), Tag("one a cell")
PositiveRatio = Annotated[Annotated[Positive, _OneForAll] | Annotated[tuple[Positive, ...], _OneACell], _ByKind]
Ratio = Annotated[Annotated[NotNegative, _OneForAll] | Annotated[tuple[NotNegative, ...], _OneACell], _ByKind]
"""One number for all cells, or one a cell."""


class OperatingPoint(NamedTuple):
    """Friction and frequency ratio of one steady state of a chain whose cells have equal friction."""

    friction_ratio: float
    frequency_ratio: float


def left_out(usual: object) -> Any:
    """Leave a field with its usual value out of plain data: what stores know was written before there was the field."""
    return Field(exclude_if=lambda value: value == usual)


@dataclass(frozen=True, kw_only=True)
class Excitation:
    """What drives the chain at the frequency of a task."""

    kind: str = "base"
    """``base``: the base moves; ``force``: a force acts on the outer mass of cell 1."""
    amplitude: float = defaults.BASE_AMPLITUDE
    """Of the base U0 [m], or of the force P0 [N]; > 0."""

    def __post_init__(self) -> None:
        checked_choice("drive.kind", self.kind, EXCITATIONS)
        checked_scalar("drive.amplitude", self.amplitude, "> 0", LARGEST_UNIT)

    @property
    def displacement(self) -> float:
        """Length [m] that friction and displacements are referred to: U0, or P0 / k_c."""
        return self.amplitude if self.kind == "base" else self.amplitude / defaults.CHAIN_STIFFNESS

    def drive(self, chain: Chain, frequency_ratio: float) -> PeriodicDrive:
        """Drive a chain at η_r = ω / ω_r."""
        base = HarmonicBase.from_ratio(chain, frequency_ratio, self.displacement)
        return base if self.kind == "base" else HarmonicForce(self.amplitude, base.angular_frequency)


DEFAULT_AMPLITUDE = {"base": defaults.BASE_AMPLITUDE, "force": defaults.CHAIN_STIFFNESS * defaults.BASE_AMPLITUDE}
"""U0 [m] or P0 [N] by kind: the same displacement scale for both."""

EXCITATIONS = tuple(DEFAULT_AMPLITUDE)


@dataclass(frozen=True, kw_only=True)
class ChainRatios:
    """The chain but for its friction, non-dimensional; the defaults are the canonical case of figure 3.

    The parameters are those of `Chain.from_ratios`; every ratio is a number, or one a cell.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    cells: Annotated[int, Field(ge=1, le=MOST_CELLS, strict=True)] = defaults.CELLS
    mass_ratio: PositiveRatio = defaults.MASS_RATIO
    stiffness_ratio: PositiveRatio = defaults.STIFFNESS_RATIO
    damping_ratio: Ratio = defaults.DAMPING_RATIO
    inner_damping_ratio: Ratio = 0.0
    outer_mass_ratio: Annotated[PositiveRatio, left_out(1.0)] = 1.0
    chain_stiffness_ratio: Annotated[PositiveRatio, left_out(1.0)] = 1.0
    friction_profile: Annotated[Ratio, left_out(1.0)] = 1.0
    """μ λ_N of each cell over that of the friction ratio, where cells differ."""
    friction_coefficient: Annotated[Positive, left_out(defaults.FRICTION_COEFFICIENT)] = defaults.FRICTION_COEFFICIENT
    """μ, which enters the motion as a part of μ λ_N alone."""

    def chain(self, friction_ratio: Ratio, base_amplitude: float = defaults.BASE_AMPLITUDE) -> Chain:
        """Build the chain with this friction ratio μ λ_N / (k_c U0), U0 [m] being the amplitude of the base."""
        return _chain(self, friction_ratio, base_amplitude)

    def as_data(self) -> dict[str, Any]:
        """Give the ratios as plain data; those in which cells may differ beside the paper's are left out where not."""
        return _RATIOS.dump_python(self, mode="json")


_RATIOS = TypeAdapter(ChainRatios)


@lru_cache(maxsize=256)
def _chain(parameters: ChainRatios, friction_ratio: Ratio, base_amplitude: float) -> Chain:
    """Build a chain, of which thousands of tasks have the same few."""
    ratios = dict(vars(parameters))
    profile = checked_array("friction_profile", ratios.pop("friction_profile"), ">= 0", largest=LARGEST_PARAMETER)
    bound = checked_array("friction_ratio", friction_ratio, ">= 0", largest=LARGEST_PARAMETER) * profile
    return Chain.from_ratios(friction_ratio=bound, base_amplitude=base_amplitude, **ratios)


@dataclass(frozen=True, kw_only=True)
class Modulation:
    """A preload that changes in step with the drive, non-dimensional."""

    modulation: float
    """a >= 0, of N = N0 (1 + a sin(Ω t + φ)); above 1 contacts open."""
    multiple: int = 1
    """Ω / ω, a whole number, so that the motion may have the drive's period."""
    phase: float = 0.0
    """φ [rad]."""

    def __post_init__(self) -> None:
        checked_scalar("modulation", self.modulation, ">= 0", LARGEST_PARAMETER)
        checked_count("modulation_multiple", self.multiple)
        checked_scalar("modulation_phase", self.phase)

    def preload(self, drive: PeriodicDrive) -> Preload:
        """Give the preload under this drive."""
        return Preload.at_multiple(drive, self.modulation, self.multiple, self.phase)


TAGS = ("values", "range", "adaptive", "one for all", "one a cell")
"""Of the ways in which a value may be written; they stand in no file."""


def first_error(problem: ValidationError, known: str) -> ParameterError:
    """Give the first error in one line: its key, its value and what is allowed."""
    error: Any = problem.errors()[0]
    key = ".".join(str(part) for part in error["loc"] if part not in TAGS)
    kind = error["type"]
    if kind == "value_error":
        return ParameterError(str(error["ctx"]["error"]))
    if kind in ("extra_forbidden", "unexpected_keyword_argument"):
        allowed = [each.name for each in fields(ChainRatios)] if key.startswith("chain.") else known.split(", ")
        return ParameterError(f"{key} is unknown; {choices(error['loc'][-1], allowed)}")
    if kind == "missing":
        return ParameterError(f"{key} is missing")
    message = f"{error['msg'][0].lower()}{error['msg'][1:]}"
    return ParameterError(f"{key} = {shown(error['input'])}; {message}" if key else message)
