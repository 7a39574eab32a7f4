"""The mass-in-mass chain with an internal Coulomb contact in every cell."""

import dataclasses
import math
from dataclasses import dataclass
from functools import cached_property, partial
from inspect import signature
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from reference_lcp import defaults
from reference_lcp.errors import ParameterError, choices
from reference_lcp.validation import (
    LARGEST_NUMBER,
    LARGEST_PARAMETER,
    LARGEST_UNIT,
    MOST_CELLS,
    FloatArray,
    checked_array,
    checked_count,
    checked_scalar,
)

_REQUIREMENTS = {
    "outer_mass": "> 0",
    "inner_mass": "> 0",
    "chain_stiffness": "> 0",
    "inner_stiffness": "> 0",
    "chain_damping": ">= 0",
    "inner_damping": ">= 0",
    "normal_force": ">= 0",
    "friction_coefficient": ">= 0",
}


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Chain:
    """A row of mass-in-mass cells (Sethi, Banerjee, Manna, figure 2), in SI units.

    Cell *i* has an outer mass at u_i and an inner mass at v_i that slides inside it. The base is at
    the left of cell 1; the right end is free. Every parameter is a number, or an array with one
    value a cell; it is stored as a read-only array of shape ``(cells,)``.
    """

    cells: int = defaults.CELLS
    """Number of cells n."""
    outer_mass: FloatArray
    """m_o [kg], > 0."""
    inner_mass: FloatArray
    """m_i [kg], > 0."""
    chain_stiffness: FloatArray
    """k_c [N/m], > 0, of the spring at the left of each cell."""
    inner_stiffness: FloatArray
    """k_i [N/m], > 0, between outer and inner mass."""
    chain_damping: FloatArray = dataclasses.field(default_factory=lambda: np.zeros(()))
    """c_c [N s/m], >= 0, of the dashpot at the left of each cell."""
    inner_damping: FloatArray = dataclasses.field(default_factory=lambda: np.zeros(()))
    """c_i [N s/m], >= 0, between outer and inner mass."""
    normal_force: FloatArray = dataclasses.field(default_factory=lambda: np.zeros(()))
    """λ_N [N] >= 0 that presses the inner on the outer mass."""
    friction_coefficient: FloatArray = dataclasses.field(default_factory=lambda: np.zeros(()))
    """μ [-] >= 0."""

    def __post_init__(self) -> None:
        checked_count("cells", self.cells, 1, MOST_CELLS)
        for name, requirement in _REQUIREMENTS.items():
            given = _by_cell(name, getattr(self, name), self.cells, requirement, LARGEST_NUMBER)
            own = np.broadcast_to(given, (self.cells,)).copy()
            own.flags.writeable = False
            object.__setattr__(self, name, own)

    @classmethod
    def from_ratios(
        cls,
        *,
        cells: int = defaults.CELLS,
        mass_ratio: ArrayLike = defaults.MASS_RATIO,
        stiffness_ratio: ArrayLike = defaults.STIFFNESS_RATIO,
        damping_ratio: ArrayLike = defaults.DAMPING_RATIO,
        friction_ratio: ArrayLike = 0.0,
        inner_damping_ratio: ArrayLike = 0.0,
        outer_mass_ratio: ArrayLike = 1.0,
        chain_stiffness_ratio: ArrayLike = 1.0,
        base_amplitude: float = defaults.BASE_AMPLITUDE,
        outer_mass: float = defaults.OUTER_MASS,
        chain_stiffness: float = defaults.CHAIN_STIFFNESS,
        friction_coefficient: float = defaults.FRICTION_COEFFICIENT,
        **unknown: object,
    ) -> Self:
        """Build a chain from non-dimensional ratios; the defaults are the canonical frictionless case.

        Parameters
        ----------
        cells, mass_ratio, stiffness_ratio
            Number of cells; m_i / m_o and k_i / k_c, of the cell's own outer mass and chain spring.
        damping_ratio, inner_damping_ratio
            c_c / (2 √(k_c m_o)) and c_i / (2 √(k_i m_i)), of the cell's own masses and springs.
        friction_ratio
            μ λ_N / (k_c U0), the paper's non-dimensional maximum frictional force; k_c is `chain_stiffness`.
        outer_mass_ratio, chain_stiffness_ratio
            m_o over `outer_mass` and k_c over `chain_stiffness`, where cells differ.
        base_amplitude
            U0 [m], the displacement that the friction ratio refers to.
        outer_mass, chain_stiffness
            m_o [kg] and k_c [N/m], which fix the units of mass and time.
        friction_coefficient
            μ > 0; only the product μ λ_N enters the motion.

        Raises
        ------
        ParameterError
            If a ratio is unknown, outside its range, or has not a value for every cell; the message names the ratio.
        """
        for name in unknown:
            raise ParameterError(f"{name} is unknown; {choices(name, [*signature(cls.from_ratios).parameters][:-1])}")
        checked_count("cells", cells, 1, MOST_CELLS)
        unit = partial(checked_scalar, requirement="> 0", largest=LARGEST_UNIT)
        positive = partial(_by_cell, cells=cells, requirement="> 0")
        mass, stiffness = unit("outer_mass", outer_mass), unit("chain_stiffness", chain_stiffness)
        amplitude, mu = unit("base_amplitude", base_amplitude), unit("friction_coefficient", friction_coefficient)
        outer = positive("outer_mass_ratio", outer_mass_ratio) * mass
        springs = positive("chain_stiffness_ratio", chain_stiffness_ratio) * stiffness
        inner_mass = positive("mass_ratio", mass_ratio) * outer
        inner_stiffness = positive("stiffness_ratio", stiffness_ratio) * springs
        friction = _by_cell("friction_ratio", friction_ratio, cells)
        damping = _by_cell("damping_ratio", damping_ratio, cells)
        inner_damping = _by_cell("inner_damping_ratio", inner_damping_ratio, cells)
        return cls(
            cells=cells,
            outer_mass=outer,
            inner_mass=inner_mass,
            chain_stiffness=springs,
            inner_stiffness=inner_stiffness,
            chain_damping=2 * damping * np.sqrt(springs * outer),
            inner_damping=2 * inner_damping * np.sqrt(inner_stiffness * inner_mass),
            normal_force=friction * stiffness * amplitude / mu,
            friction_coefficient=np.asarray(mu),
        )

    def __repr__(self) -> str:
        """Name the parameters in one line, from the smallest to the largest value where cells differ."""
        parts = [
            f"masses {_span(self.outer_mass)} and {_span(self.inner_mass)} kg",
            f"springs {_span(self.chain_stiffness)} and {_span(self.inner_stiffness)} N/m",
            f"dashpots {_span(self.chain_damping)} and {_span(self.inner_damping)} N s/m",
            f"friction bound {_span(self.friction_bound)} N",
        ]
        return f"<Chain of {self.cells} cells: outer and inner {', '.join(parts)}>"

    one_coefficient: ClassVar[bool] = True
    """Friction at rest is that of motion, unless the lane says otherwise."""

    @property
    def freedoms(self) -> int:
        """Number of masses, 2n."""
        return 2 * self.cells

    @property
    def damped(self) -> bool:
        """Whether every cell has a chain dashpot."""
        return bool(np.all(self.chain_damping > 0))

    @property
    def contact_mass(self) -> FloatArray:
        """Mass that a contact has to move where no other holds, m_i m_o / (m_i + m_o) [kg], shape (n,)."""
        return self.inner_mass * self.outer_mass / (self.inner_mass + self.outer_mass)

    @property
    def friction_bound(self) -> FloatArray:
        """Largest friction force μ λ_N of each contact [N], shape (n,)."""
        return self.friction_coefficient * self.normal_force

    @property
    def resonator_frequency(self) -> float:
        """ω_r = √(k_i / m_i) of cell 1 [rad/s], the unit of the frequency ratio η_r = ω / ω_r."""
        return float(np.sqrt(self.inner_stiffness[0] / self.inner_mass[0]))

    @cached_property
    def mass_matrix(self) -> FloatArray:
        """M of equation (4) [kg], diagonal, shape (2n, 2n); outer masses first, then inner ones."""
        return np.diag(np.concatenate([self.outer_mass, self.inner_mass]))

    @cached_property
    def stiffness_matrix(self) -> FloatArray:
        """K [N/m], shape (2n, 2n), so that springs exert −K x; the spring to the base is in its first entry."""
        return self._element_matrix(self.chain_stiffness, self.inner_stiffness)

    @cached_property
    def damping_matrix(self) -> FloatArray:
        """C [N s/m], shape (2n, 2n), so that dashpots exert −C q; the one to the base is in its first entry."""
        return self._element_matrix(self.chain_damping, self.inner_damping)

    @cached_property
    def contact_directions(self) -> FloatArray:
        """W_T of equation (4), shape (2n, n): a contact's friction λ_T acts on the inner mass, −λ_T on the outer one.

        The force on all masses is W_T λ_T, and relative velocities, inner less outer, are ġ_T = v̇ − u̇ = W_Tᵀ q.
        """
        identity = np.eye(self.cells)
        return np.vstack([-identity, identity])

    @cached_property
    def highest_natural_frequency(self) -> float:
        """Highest natural frequency of the frictionless chain [rad/s]; builds no matrix."""
        from reference_lcp.chain.kernels import highest_square

        squared = highest_square(self.outer_mass, self.inner_mass, self.chain_stiffness, self.inner_stiffness)
        return math.sqrt(squared)

    def _element_matrix(self, between_cells: FloatArray, within_cells: FloatArray) -> FloatArray:
        elongation = np.eye(self.cells) - np.eye(self.cells, k=-1)
        row = elongation.T @ np.diag(between_cells) @ elongation
        inside = np.diag(within_cells)
        return np.block([[row + inside, -inside], [-inside, inside]])

    def _numbers(self) -> tuple[bytes, ...]:
        return tuple(getattr(self, name).tobytes() for name in _REQUIREMENTS)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Chain) and self._numbers() == other._numbers()

    def __hash__(self) -> int:
        return hash(self._numbers())


def _span(values: FloatArray) -> str:
    low, high = values.min(), values.max()
    return f"{low:.4g}" if low == high else f"{low:.4g}…{high:.4g}"


def _by_cell(
    name: str, value: ArrayLike, cells: int, requirement: str = ">= 0", largest: float = LARGEST_PARAMETER
) -> FloatArray:
    """Give one number, or one for every cell; refuse all else."""
    given = checked_array(name, value, requirement, largest=largest)
    if given.shape not in ((), (1,), (cells,)):
        has = f"{given.size} values and the chain {cells} cells" if given.ndim == 1 else f"shape {given.shape}"
        raise ParameterError(f"{name} has {has}; allowed: one number or {cells}, one per cell")
    return given


def mechanical_energy(chain: Chain, positions: FloatArray, velocities: FloatArray) -> FloatArray:
    """Kinetic energy and energy of the springs [J], shape (times,), of states (times, 2n); the base at zero."""
    cells = chain.cells
    outer, inner = positions[:, :cells], positions[:, cells:]
    kinetic = velocities[:, :cells] ** 2 @ chain.outer_mass + velocities[:, cells:] ** 2 @ chain.inner_mass
    elastic = np.diff(outer, axis=1, prepend=0.0) ** 2 @ chain.chain_stiffness
    return (kinetic + elastic + (inner - outer) ** 2 @ chain.inner_stiffness) / 2
