"""The chain's matrices, its ratios, and the checks of its parameters."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from reference_lcp import Chain, HarmonicBase, HarmonicForce, ParameterError, StillBase

N = 4


def chain_of_different_cells() -> Chain:
    return Chain(
        cells=N,
        outer_mass=np.array([1.0, 2.0, 3.0, 4.0]),
        inner_mass=np.array([0.5, 0.6, 0.7, 0.8]),
        chain_stiffness=np.array([10.0, 20.0, 30.0, 40.0]),
        inner_stiffness=np.array([5.0, 6.0, 7.0, 8.0]),
        chain_damping=np.array([0.1, 0.2, 0.3, 0.4]),
        inner_damping=np.array([0.01, 0.02, 0.03, 0.04]),
        normal_force=np.asarray(2.0),
        friction_coefficient=np.array([0.1, 0.2, 0.3, 0.4]),
    )


def test_quadratic_forms_are_the_energies_of_the_springs_and_masses() -> None:
    chain = chain_of_different_cells()
    for x in np.random.default_rng(0).normal(size=(10, 2 * N)):
        u, v = x[:N], x[N:]
        stretch = np.diff(u, prepend=0.0)
        springs = chain.chain_stiffness @ stretch**2 + chain.inner_stiffness @ (v - u) ** 2
        dashpots = chain.chain_damping @ stretch**2 + chain.inner_damping @ (v - u) ** 2
        masses = chain.outer_mass @ u**2 + chain.inner_mass @ v**2
        assert x @ chain.stiffness_matrix @ x == pytest.approx(springs)
        assert x @ chain.damping_matrix @ x == pytest.approx(dashpots)
        assert x @ chain.mass_matrix @ x == pytest.approx(masses)
        assert chain.contact_directions.T @ x == pytest.approx(v - u)


def test_ratios_of_unequal_cells_are_those_of_each_cells_own_masses_and_springs() -> None:
    """But for friction, which is over the unit of stiffness: the base's displacement knows no cell."""
    chain = Chain.from_ratios(
        cells=2, mass_ratio=[0.5, 2.0], stiffness_ratio=0.5, damping_ratio=0.01, inner_damping_ratio=0.02,
        outer_mass_ratio=[1.0, 4.0], chain_stiffness_ratio=[1.0, 9.0], friction_ratio=0.3,
        base_amplitude=0.02, outer_mass=2.0, chain_stiffness=100.0,
    )  # fmt: skip
    assert chain.outer_mass == pytest.approx([2.0, 8.0])
    assert chain.inner_mass == pytest.approx([1.0, 16.0])
    assert chain.chain_stiffness == pytest.approx([100.0, 900.0])
    assert chain.inner_stiffness == pytest.approx([50.0, 450.0])
    assert chain.chain_damping == pytest.approx([0.02 * np.sqrt(200), 0.02 * np.sqrt(7200)])
    assert chain.inner_damping == pytest.approx([0.04 * np.sqrt(50), 0.04 * np.sqrt(7200)])
    assert chain.friction_bound == pytest.approx([0.6, 0.6])
    assert HarmonicBase.from_ratio(chain, 0.9, 0.02).angular_frequency == pytest.approx(0.9 * np.sqrt(50))


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10**6), st.integers(1, 12))
def test_highest_natural_frequency_is_the_dense_eigenvalue(seed, cells) -> None:
    values = 10 ** np.random.default_rng(seed).uniform(-1.5, 1.5, size=(4, cells))
    names = ("outer_mass", "inner_mass", "chain_stiffness", "inner_stiffness")
    chain = Chain(cells=cells, **dict(zip(names, values, strict=True)))
    squares = scipy.linalg.eigh(chain.stiffness_matrix, chain.mass_matrix, eigvals_only=True)
    assert chain.highest_natural_frequency == pytest.approx(np.sqrt(squares[-1]), rel=1e-10)


def test_hundred_thousand_cells_reach_the_edge_of_the_infinite_chain_and_build_no_matrix() -> None:
    """Bloch at κ = π: ω² m_eff = 4 k_c, with m_eff = m_o + m_i ω_r²/(ω_r² − ω²); equal masses and springs."""
    chain = Chain.from_ratios(cells=100_000)
    squared = (chain.highest_natural_frequency / chain.resonator_frequency) ** 2
    assert squared == pytest.approx(3 + np.sqrt(5), rel=1e-8)
    assert not {"mass_matrix", "stiffness_matrix", "damping_matrix", "contact_directions"} & set(vars(chain))


def test_chain_is_a_value() -> None:
    assert Chain.from_ratios(friction_ratio=0.3) == Chain.from_ratios(friction_ratio=[0.3] * 7)
    assert hash(Chain.from_ratios()) == hash(Chain.from_ratios())
    assert Chain.from_ratios() != Chain.from_ratios(damping_ratio=0.02)
    with pytest.raises(ValueError, match="read-only"):
        Chain.from_ratios().outer_mass[0] = 2.0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Chain.from_ratios(mass_ratio=-1.0), "mass_ratio = -1"),
        (lambda: Chain.from_ratios(friction_ratio=np.nan), "friction_ratio = nan"),
        (lambda: Chain.from_ratios(outer_mass=np.inf), "outer_mass = inf"),
        (lambda: Chain.from_ratios(cells=0), "cells = 0"),
        (lambda: Chain.from_ratios(cells=2.5), "cells = 2.5"),
        (
            lambda: Chain.from_ratios(cells=5, friction_ratio=[0.1] * 7),
            "^friction_ratio has 7 values and the chain 5 cells; allowed: one number or 5, one per cell$",
        ),
        (lambda: Chain.from_ratios(mass_ratio=[1.0] * 7, outer_mass_ratio=[1.0, 2.0]), "^outer_mass_ratio has 2 "),
        (lambda: Chain.from_ratios(damping_ratio=np.ones((7, 1))), r"^damping_ratio has shape \(7, 1\); allowed: one "),
        (
            lambda: Chain(outer_mass=[1.0, 2.0], inner_mass=1, chain_stiffness=1, inner_stiffness=1),
            "^outer_mass has 2 values and the chain 7 cells; allowed: ",
        ),
        (lambda: Chain.from_ratios(stiffnes_ratio=2), "^stiffnes_ratio is unknown; .*; did you mean stiffness_ratio?"),
        (lambda: Chain.from_ratios(mass_ratio="heavy"), "mass_ratio = 'heavy' is not a number"),
        (lambda: HarmonicBase(0.01, 0.0), "= 0 .* allowed: > 0"),
        (lambda: HarmonicForce(np.nan, 1.0), "= nan .* allowed: > 0"),
        (lambda: StillBase(0.0), "= 0 .* allowed: > 0"),
        (lambda: HarmonicBase.from_ratio(Chain.from_ratios(), -0.3), "= -0.3 .* allowed: > 0"),
    ],
)
def test_impossible_chain_or_drive_is_refused_with_its_value(make, message) -> None:
    with pytest.raises(ParameterError, match=message):
        make()
