"""A chain in ratios: what steady states and motions of it have in common."""

from dataclasses import dataclass
from functools import lru_cache

from reference_lcp import defaults
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.errors import ParameterError
from reference_lcp.validation import (
    LARGEST_PARAMETER,
    LARGEST_UNIT,
    MOST_CELLS,
    checked_array,
    checked_count,
    checked_scalar,
)

Ratio = float | tuple[float, ...]
"""One number for all cells, or one a cell from the base on."""

PER_CELL = {
    "friction_ratio": ">= 0",
    "mass_ratio": "> 0",
    "stiffness_ratio": "> 0",
    "damping_ratio": ">= 0",
    "inner_damping_ratio": ">= 0",
    "outer_mass_ratio": "> 0",
    "chain_stiffness_ratio": "> 0",
    "friction_profile": ">= 0",
}
"""Parameters that may have one value a cell, and what is allowed of them."""


@dataclass(frozen=True, kw_only=True)
class ChainRatios:
    """A chain in ratios; the defaults are the chain of the paper's figure 3.

    Raises
    ------
    ParameterError
        If a value is outside its range, or a list has not one value a cell.
    """

    friction_ratio: Ratio
    """μ λ_N / (k_c U0) >= 0."""
    cells: int = defaults.CELLS
    mass_ratio: Ratio = defaults.MASS_RATIO
    """m_i / m_o > 0."""
    stiffness_ratio: Ratio = defaults.STIFFNESS_RATIO
    """k_i / k_c > 0."""
    damping_ratio: Ratio = defaults.DAMPING_RATIO
    """c_c / (2 √(k_c m_o)) >= 0 of the dashpots between the cells."""
    inner_damping_ratio: Ratio = 0.0
    """c_i / (2 √(k_i m_i)) >= 0 of those within the cells."""
    outer_mass_ratio: Ratio = 1.0
    """Outer masses over the unit of mass > 0."""
    chain_stiffness_ratio: Ratio = 1.0
    """Springs between the cells over their unit > 0."""
    friction_profile: Ratio = 1.0
    """Friction bounds of the cells over that of `friction_ratio` >= 0."""
    friction_coefficient: float = defaults.FRICTION_COEFFICIENT
    """μ > 0; the motion depends on μ λ_N alone."""
    displacement: float = defaults.BASE_AMPLITUDE
    """U0 [m] > 0 that ratios refer to: amplitude of the base, or P0 / k_c of a force."""

    def __post_init__(self) -> None:
        checked_count("cells", self.cells, 1, MOST_CELLS)
        checked_scalar("friction_coefficient", self.friction_coefficient, "> 0", LARGEST_PARAMETER)
        checked_scalar("displacement", self.displacement, "> 0", LARGEST_UNIT)
        for name, requirement in PER_CELL.items():
            value = getattr(self, name)
            checked_array(name, value, requirement, largest=LARGEST_PARAMETER)
            if isinstance(value, tuple) and len(value) != self.cells:
                problem = f"{name} has {len(value)} values and the chain {self.cells} cells"
                raise ParameterError(f"{problem}; allowed: one number, or as many as there are cells")

    @property
    def chain(self) -> Chain:
        """Build the chain."""
        return chain_of(*(getattr(self, name) for name in RATIOS))


RATIOS = tuple(ChainRatios.__dataclass_fields__)
"""Names of the ratios."""


@lru_cache(maxsize=4096)
def chain_of(*values: Ratio) -> Chain:
    """Build the chain of the values of `RATIOS`."""
    ratios = dict(zip(RATIOS, values, strict=True))
    bound = checked_array("friction_ratio", ratios.pop("friction_ratio")) * checked_array(
        "friction_profile", ratios.pop("friction_profile")
    )
    return Chain.from_ratios(friction_ratio=bound, base_amplitude=ratios.pop("displacement"), **ratios)  # type: ignore[arg-type]
