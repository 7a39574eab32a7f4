"""Mutants that build another chain than the one that is given."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from engines.interface.variant import Variant
from engines.mutants.altered import Built, of_chains, of_lanes
from engines.mutants.mutant import SCHEME, Mutant
from reference_lcp.chain.canonical import BASE_AMPLITUDE, CHAIN_STIFFNESS, FRICTION_COEFFICIENT
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

CELL = 2
"""Cell that is not built as it is given where one alone is wrong, counted from zero."""


def _grown(name: str) -> Built:
    """Build a parameter × (1 + s)."""
    return of_chains(**{name: lambda chain, size: (1 + size) * getattr(chain, name)})


def _shrunk(name: str) -> Built:
    """Build a parameter × (1 − s)."""
    return of_chains(**{name: lambda chain, size: (1 - size) * getattr(chain, name)})


def _in_one_cell(name: str, cell: int, change: Callable[[float], float]) -> Built:
    """Build a parameter of one cell times `change(s)`; chains without this cell are built as given."""

    def changed(chain: Chain, size: float) -> FloatArray:
        return getattr(chain, name) * np.where(np.arange(chain.cells) == cell, change(size), 1.0)

    return of_chains(**{name: changed})


def _towards(name: str, other: Callable[[Chain], FloatArray]) -> Built:
    """Build a parameter p + s (other − p)."""
    return of_chains(**{name: lambda chain, size: getattr(chain, name) + size * (other(chain) - getattr(chain, name))})


def _of_a_given_unit(lane: Lane, size: float) -> Lane:
    """Take the displacement scale of figure 3 for the lane's."""
    factor = BASE_AMPLITUDE / lane.drive.displacement_scale(lane.chain)
    return _with_bound(lane, 1 + size * (factor - 1))


def _of_a_given_stiffness(lane: Lane, size: float) -> Lane:
    """Take the chain stiffness of figure 3 for the lane's."""
    return _with_bound(lane, 1 + size * (CHAIN_STIFFNESS / lane.chain.chain_stiffness - 1))


def _with_bound(lane: Lane, factor: float | FloatArray) -> Lane:
    chain = lane.chain
    return replace(lane, chain=replace(chain, friction_coefficient=factor * chain.friction_coefficient))


def _swapped(chain: Chain, name: str, size: float) -> FloatArray:
    values: FloatArray = getattr(chain, name)
    if chain.cells <= CELL + 1:
        return values
    order = np.arange(chain.cells)
    order[[CELL, CELL + 1]] = CELL + 1, CELL
    return values + size * (values[order] - values)


def _chains_with_swapped_cells() -> Built:
    names = ("outer_mass", "inner_mass", "chain_stiffness", "inner_stiffness", "chain_damping", "inner_damping",
             "normal_force")  # fmt: skip
    return of_chains(**{name: lambda chain, size, own=name: _swapped(chain, own, size) for name in names})


def _named(name: str, error: str, build: Built, of: Variant = SCHEME) -> Mutant:
    return Mutant(name=name, error=error, build=build, of=of)


PARAMETERS = (
    _named("outer-mass", "outer masses × (1 + s)", _grown("outer_mass")),
    _named("inner-mass", "inner masses × (1 + s)", _grown("inner_mass")),
    _named("chain-spring", "chain springs × (1 + s)", _grown("chain_stiffness")),
    _named("inner-spring", "inner springs × (1 + s)", _grown("inner_stiffness")),
    _named("chain-damping", "chain dashpots × (1 + s)", _grown("chain_damping")),
    _named("inner-damping", "inner dashpots × (1 + s)", _grown("inner_damping")),
    _named("base-dashpot", "first chain dashpot × (1 − s)", _in_one_cell("chain_damping", 0, lambda size: 1 - size)),
    _named("inner-dashpots-missing", "inner dashpots × (1 − s)", _shrunk("inner_damping")),
    _named("mass-of-a-cell", "outer mass of cell 3 × (1 + s)", _in_one_cell("outer_mass", CELL, lambda size: 1 + size)),
    _named("cells-swapped", "parameters of cells 3 and 4, s of the way to each other's", _chains_with_swapped_cells()),
    _named("bound", "bound of friction × (1 + s)", _grown("friction_coefficient")),
    _named("normal-force", "normal force × (1 + s)", _grown("normal_force")),
    _named(
        "coefficient-of-cell-1",
        "μ of every cell, s of the way to that of cell 1",
        _towards("friction_coefficient", lambda chain: np.full(chain.cells, chain.friction_coefficient[0])),
    ),
    _named(
        "coefficient-mean",
        "μ of every cell, s of the way to their mean",
        _towards("friction_coefficient", lambda chain: np.full(chain.cells, np.mean(chain.friction_coefficient))),
    ),
    _named(
        "coefficient-ignored",
        "μ, s of the way to 0.5",
        _towards("friction_coefficient", lambda chain: np.full(chain.cells, FRICTION_COEFFICIENT)),
    ),
    _named("bound-of-amplitude", "bound, s of the way to that for U0 = 0.01 m", of_lanes(_of_a_given_unit)),
    _named("bound-of-stiffness", "bound, s of the way to that for k_c = 1000 N/m", of_lanes(_of_a_given_stiffness)),
    _named("siconos-bound", "Siconos' bound of friction × (1 + s)", _grown("friction_coefficient"), Variant("siconos")),
    _named(
        "siconos-base-dashpot",
        "Siconos' first chain dashpot × (1 − s)",
        _in_one_cell("chain_damping", 0, lambda size: 1 - size),
        Variant("siconos"),
    ),
    _named(
        "drake-base-dashpot",
        "Drake's first chain dashpot × (1 − s)",
        _in_one_cell("chain_damping", 0, lambda size: 1 - size),
        Variant("drake", "joint", "default"),
    ),
    _named(
        "mujoco-bound",
        "MuJoCo's bound of friction × (1 + s)",
        _grown("friction_coefficient"),
        Variant("mujoco", "joint", "default"),
    ),
    Mutant(
        name="excused",
        error="bound of friction × (1 + s), excused by a text alone",
        build=_grown("friction_coefficient"),
        of=Variant("mujoco", "joint", "default"),
        excuse="bad weather",
        sizes=(10.0, 1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6),
    ),
)
