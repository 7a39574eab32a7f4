"""Parameters of a task: the chain in ratios, its excitation, the modulation of its normal force."""

from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from pydantic import ConfigDict, Discriminator, Field, Tag, TypeAdapter

from reference_lcp.chain import canonical
from reference_lcp.chain.harmonic import HarmonicBase, HarmonicForce, PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.refusal import checked_choice
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
    """Give whether a ratio is one number, or one a cell."""
    return "one a cell" if isinstance(value, list | tuple) else "one for all"


_ByKind = Discriminator(_kind_of_ratio)
_OneForAll, _OneACell = Tag("one for all"), Tag("one a cell")
PositiveRatio = Annotated[
    Annotated[Positive, _OneForAll] | Annotated[tuple[Positive, ...], _OneACell], _ByKind
]  # fmt: skip
Ratio = Annotated[
    Annotated[NotNegative, _OneForAll] | Annotated[tuple[NotNegative, ...], _OneACell], _ByKind
]  # fmt: skip
"""One number for all cells, or one a cell."""


class OperatingPoint(NamedTuple):
    """Friction and frequency ratio of one steady state of a chain whose cells have equal friction."""

    friction_ratio: float
    frequency_ratio: float


_LeftOutOfEqualCells = Field(exclude_if=lambda value: value == 1.0)


@dataclass(frozen=True, kw_only=True)
class Excitation:
    """What drives the chain at the frequency of a task.

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
    amplitude: float = canonical.BASE_AMPLITUDE

    def __post_init__(self) -> None:
        checked_choice("drive.kind", self.kind, EXCITATIONS)
        checked_scalar("drive.amplitude", self.amplitude, "> 0", LARGEST_UNIT)

    @property
    def displacement(self) -> float:
        """Length [m] that friction and displacements are referred to: U0, or P0 / k_c."""
        return self.amplitude if self.kind == "base" else self.amplitude / canonical.CHAIN_STIFFNESS

    def drive(self, chain: Chain, frequency_ratio: float) -> PeriodicDrive:
        """Drive a chain at η_r = ω / ω_r."""
        base = HarmonicBase.from_ratio(chain, frequency_ratio, self.displacement)
        return base if self.kind == "base" else HarmonicForce(self.amplitude, base.angular_frequency)


DEFAULT_AMPLITUDE = {"base": canonical.BASE_AMPLITUDE, "force": canonical.CHAIN_STIFFNESS * canonical.BASE_AMPLITUDE}
"""U0 [m] or P0 [N] by kind: the same displacement scale for both."""

EXCITATIONS = tuple(DEFAULT_AMPLITUDE)


@dataclass(frozen=True, kw_only=True)
class ChainRatios:
    """The chain but for its friction, non-dimensional; the defaults are the canonical case of figure 3.

    The parameters are those of `Chain.from_ratios`; every ratio is a number, or one a cell.

    Parameters
    ----------
    friction_profile
        μ λ_N of each cell over that of the friction ratio, where cells differ.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    cells: Annotated[int, Field(ge=1, le=MOST_CELLS, strict=True)] = canonical.CELLS
    mass_ratio: PositiveRatio = canonical.MASS_RATIO
    stiffness_ratio: PositiveRatio = canonical.STIFFNESS_RATIO
    damping_ratio: Ratio = canonical.DAMPING_RATIO
    inner_damping_ratio: Ratio = 0.0
    outer_mass_ratio: Annotated[PositiveRatio, _LeftOutOfEqualCells] = 1.0
    chain_stiffness_ratio: Annotated[PositiveRatio, _LeftOutOfEqualCells] = 1.0
    friction_profile: Annotated[Ratio, _LeftOutOfEqualCells] = 1.0

    def chain(self, friction_ratio: Ratio, base_amplitude: float = canonical.BASE_AMPLITUDE) -> Chain:
        """Build the chain with this friction ratio μ λ_N / (k_c U0), U0 [m] being the amplitude of the base."""
        ratios = dict(vars(self))
        profile = checked_array("friction_profile", ratios.pop("friction_profile"), ">= 0", largest=LARGEST_PARAMETER)
        bound = checked_array("friction_ratio", friction_ratio, ">= 0", largest=LARGEST_PARAMETER) * profile
        return Chain.from_ratios(friction_ratio=bound, base_amplitude=base_amplitude, **ratios)

    def as_data(self) -> dict[str, Any]:
        """Give the ratios as plain data; those in which cells may differ beside the paper's are left out where not."""
        return _RATIOS.dump_python(self, mode="json")


_RATIOS = TypeAdapter(ChainRatios)


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
        checked_scalar("modulation", self.modulation, ">= 0", LARGEST_PARAMETER)
        checked_count("modulation_multiple", self.multiple)
        checked_scalar("modulation_phase", self.phase)

    def preload(self, drive: PeriodicDrive) -> Preload:
        """Give the preload under this drive."""
        return Preload.at_multiple(drive, self.modulation, self.multiple, self.phase)
