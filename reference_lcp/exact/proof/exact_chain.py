"""A chain and its drive in exact numbers: decimals as they are typed, or doubles as they are stored."""

from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from typing import Self

import numpy as np

from reference_lcp import defaults
from reference_lcp.chain.drives import HarmonicBase, HarmonicForce, PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.errors import ParameterError, shown
from reference_lcp.validation import LARGEST_PARAMETER, FloatArray, checked_count

MOST_CELLS = 100
"""Longest chain that a proof is tried for: matrices of 4n rows are multiplied in balls."""

MOST_DIGITS = 100
"""Most digits of a decimal ratio: far more than anyone types, few enough to compute with."""

LONGEST_CYCLE = 12
"""Most periods of the drive after which a modulated normal force repeats together with it."""

SAME_RATIO = 1e-14
"""Part by which Ω / ω of two doubles differs from the fraction that is meant: a few roundings."""

Decimals = str | int | float | Decimal | Fraction
"""An exact number; a float stands for its shortest decimal."""


@dataclass(frozen=True)
class ExactModulation:
    """N(t) = N0 (1 + a sin(Ωt + φ)), with Ω in units of the drive's ω."""

    depth: Fraction
    """a, from 0 to 1."""
    multiple: Fraction
    """Ω / ω."""
    phase: Fraction
    """φ [rad]."""

    def __post_init__(self) -> None:
        if not 0 <= self.depth <= 1:
            raise ParameterError(
                f"modulation = {float(self.depth):g} in a proof; allowed: 0 to 1, contacts stay closed"
            )
        if self.multiple.denominator > LONGEST_CYCLE:
            raise ParameterError(
                f"modulation_multiple = {float(self.multiple):.15g}: drive and normal force do not repeat together; "
                f"allowed: fractions with denominators up to {LONGEST_CYCLE}"
            )


@dataclass(frozen=True, kw_only=True)
class ExactChain:
    """Chain and drive in units of m_o and k_c of cell 1 (or those that ratios refer to) and of the displacement scale.

    Roots of rational numbers are given by their squares.
    """

    outer_mass: tuple[Fraction, ...]
    inner_mass: tuple[Fraction, ...]
    chain_stiffness: tuple[Fraction, ...]
    inner_stiffness: tuple[Fraction, ...]
    chain_damping_squared: tuple[Fraction, ...]
    inner_damping_squared: tuple[Fraction, ...]
    friction: tuple[Fraction, ...]
    """Bounds μ λ_N, of the mean normal force."""
    frequency_squared: Fraction
    """ω²."""
    moving_base: bool = True
    modulation: ExactModulation | None = None

    @property
    def cells(self) -> int:
        """Number of cells n."""
        return len(self.outer_mass)

    @property
    def half(self) -> bool:
        """Whether drive and bounds are those of half a period before, the drive with the other sign."""
        return self.modulation is None or (self.modulation.multiple / 2).denominator == 1

    @property
    def cycle(self) -> int:
        """Periods of the drive after which drive and bounds repeat."""
        return 1 if self.modulation is None else self.modulation.multiple.denominator

    @property
    def damped(self) -> bool:
        """Whether every cell has a chain dashpot, so that all steady states have one transmittance."""
        return all(square > 0 for square in self.chain_damping_squared)

    @classmethod
    def from_ratios(
        cls,
        *,
        frequency_ratio: Decimals,
        friction_ratio: Decimals | tuple[Decimals, ...] = 0,
        cells: int = defaults.CELLS,
        mass_ratio: Decimals | tuple[Decimals, ...] = 1,
        stiffness_ratio: Decimals | tuple[Decimals, ...] = 1,
        damping_ratio: Decimals | tuple[Decimals, ...] = "0.01",
        inner_damping_ratio: Decimals | tuple[Decimals, ...] = 0,
        outer_mass_ratio: Decimals | tuple[Decimals, ...] = 1,
        chain_stiffness_ratio: Decimals | tuple[Decimals, ...] = 1,
        modulation: Decimals = 0,
        modulation_multiple: Decimals = 1,
        modulation_phase: Decimals = 0,
    ) -> Self:
        """Build a chain on a base from ratios, exact decimals with the meaning of `Chain.from_ratios`.

        Raises
        ------
        ParameterError
            If a ratio is no decimal, or outside its range; the message names it.
        """
        n = checked_count("cells", cells, 1, MOST_CELLS)
        outer, springs = (
            _per_cell(name, ratio, n, "> 0")
            for name, ratio in (
                ("outer_mass_ratio", outer_mass_ratio),
                ("chain_stiffness_ratio", chain_stiffness_ratio),
            )
        )
        inner = _products(_per_cell("mass_ratio", mass_ratio, n, "> 0"), outer)
        inner_springs = _products(_per_cell("stiffness_ratio", stiffness_ratio, n, "> 0"), springs)
        chain_zeta = _per_cell("damping_ratio", damping_ratio, n, ">= 0")
        inner_zeta = _per_cell("inner_damping_ratio", inner_damping_ratio, n, ">= 0")
        eta = checked_decimal("frequency_ratio", frequency_ratio, "> 0")
        depth = checked_decimal("modulation", modulation, ">= 0")
        multiple = checked_decimal("modulation_multiple", modulation_multiple, "> 0")
        phase = checked_decimal("modulation_phase", modulation_phase, "finite")
        return cls(
            outer_mass=outer,
            inner_mass=inner,
            chain_stiffness=springs,
            inner_stiffness=inner_springs,
            chain_damping_squared=tuple(4 * z**2 * k * m for z, k, m in zip(chain_zeta, springs, outer, strict=True)),
            inner_damping_squared=tuple(
                4 * z**2 * k * m for z, k, m in zip(inner_zeta, inner_springs, inner, strict=True)
            ),
            friction=_per_cell("friction_ratio", friction_ratio, n, ">= 0"),
            frequency_squared=eta**2 * inner_springs[0] / inner[0],
            modulation=ExactModulation(depth, multiple, phase) if depth else None,
        )

    @classmethod
    def of(cls, chain: Chain, drive: PeriodicDrive, preload: Preload | None = None) -> Self:
        """Take the doubles of a chain and its drive as the exact numbers that they are.

        Raises
        ------
        ParameterError
            If the chain is too long, the drive does not repeat, or the normal force not together with it.
        """
        checked_count("cells", chain.cells, 1, MOST_CELLS)
        if not isinstance(drive, PeriodicDrive) or getattr(drive, "length", None) is not None:
            allowed = "HarmonicBase, HarmonicForce without a length"
            raise ParameterError(f"{type(drive).__name__} has no steady state that can be proven; allowed: {allowed}")
        mass, stiffness = Fraction(float(chain.outer_mass[0])), Fraction(float(chain.chain_stiffness[0]))
        base, amplitude = isinstance(drive, HarmonicBase), Fraction(drive.amplitude)
        force = stiffness * amplitude if base else amplitude
        bounds = _products(_doubles(chain.friction_coefficient), _doubles(chain.normal_force))
        return cls(
            outer_mass=_over(_doubles(chain.outer_mass), mass),
            inner_mass=_over(_doubles(chain.inner_mass), mass),
            chain_stiffness=_over(_doubles(chain.chain_stiffness), stiffness),
            inner_stiffness=_over(_doubles(chain.inner_stiffness), stiffness),
            chain_damping_squared=tuple(c**2 / (stiffness * mass) for c in _doubles(chain.chain_damping)),
            inner_damping_squared=tuple(c**2 / (stiffness * mass) for c in _doubles(chain.inner_damping)),
            friction=_over(bounds, force),
            frequency_squared=Fraction(drive.angular_frequency) ** 2 * mass / stiffness,
            moving_base=base,
            modulation=None if preload is None or not preload.modulation else _modulation(drive, preload),
        )

    def floating(self) -> tuple[Chain, PeriodicDrive, Preload | None]:
        """Give chain, drive and normal force of these numbers, rounded to doubles."""
        chain = Chain(
            cells=self.cells,
            outer_mass=_rounded(self.outer_mass),
            inner_mass=_rounded(self.inner_mass),
            chain_stiffness=_rounded(self.chain_stiffness),
            inner_stiffness=_rounded(self.inner_stiffness),
            chain_damping=np.sqrt(_rounded(self.chain_damping_squared)),
            inner_damping=np.sqrt(_rounded(self.inner_damping_squared)),
            normal_force=_rounded(self.friction),
            friction_coefficient=np.asarray(1.0),
        )
        omega = float(self.frequency_squared) ** 0.5
        drive: PeriodicDrive = (
            HarmonicBase(1.0, omega) if self.moving_base else HarmonicForce(float(self.chain_stiffness[0]), omega)
        )
        pressed = self.modulation
        if pressed is None:
            return chain, drive, None
        return chain, drive, Preload.at_multiple(drive, *map(float, (pressed.depth, pressed.multiple, pressed.phase)))


def checked_decimal(name: str, value: Decimals, requirement: str) -> Fraction:
    """Give a number exactly, or raise a `ParameterError` that begins with its name."""
    if isinstance(value, Fraction):
        number = value
    else:
        try:
            decimal = Decimal(str(value))
        except InvalidOperation:
            raise ParameterError(f"{name} = {shown(value)} is no decimal number; allowed: {requirement}") from None
        if (
            not decimal.is_finite()
            or abs(decimal.adjusted()) > MOST_DIGITS
            or len(decimal.as_tuple().digits) > MOST_DIGITS
        ):
            raise ParameterError(
                f"{name} = {shown(value)} is outside its range; allowed: {requirement}, up to {MOST_DIGITS} digits"
            )
        number = Fraction(decimal)
    if (requirement == "> 0" and number <= 0) or (requirement == ">= 0" and number < 0):
        raise ParameterError(f"{name} = {shown(value)} is outside its range; allowed: {requirement}")
    largest = Fraction(LARGEST_PARAMETER)
    if number and not 1 / largest <= abs(number) <= largest:
        allowed = f"{1 / LARGEST_PARAMETER:g} to {LARGEST_PARAMETER:g}"
        raise ParameterError(f"{name} = {shown(value)} is outside its range; allowed: {allowed}")
    return number


def _per_cell(name: str, value: Decimals | tuple[Decimals, ...], cells: int, requirement: str) -> tuple[Fraction, ...]:
    values = tuple(value) if isinstance(value, tuple | list) else (value,) * cells
    if len(values) != cells:
        raise ParameterError(f"{name} has {len(values)} numbers; allowed: one, or {cells}")
    return tuple(checked_decimal(name, each, requirement) for each in values)


def _modulation(drive: PeriodicDrive, preload: Preload) -> ExactModulation:
    """Give the modulation with the fraction Ω / ω that is meant by two doubles."""
    ratio = Fraction(preload.angular_frequency) / Fraction(drive.angular_frequency)
    near = ratio.limit_denominator(LONGEST_CYCLE)
    multiple = near if abs(ratio - near) <= SAME_RATIO * ratio else ratio
    return ExactModulation(Fraction(preload.modulation), multiple, Fraction(preload.phase))


def _products(first: tuple[Fraction, ...], second: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
    return tuple(a * b for a, b in zip(first, second, strict=True))


def _over(values: tuple[Fraction, ...], unit: Fraction) -> tuple[Fraction, ...]:
    return tuple(value / unit for value in values)


def _doubles(values: FloatArray) -> tuple[Fraction, ...]:
    return tuple(map(Fraction, values.tolist()))


def _rounded(values: tuple[Fraction, ...]) -> FloatArray:
    return np.array(list(map(float, values)))
