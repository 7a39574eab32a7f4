"""Numbers that an engine would cut off, take for others or crash at: refused in a line, with what is allowed."""

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from tests.engines.scheme_oracle import ROUND_OFF, STEPS, distance, lane_of, run, with_coefficients


def stiff_lane() -> Lane:
    chain = Chain.from_ratios(chain_stiffness=1e12, outer_mass=1e9)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, 1.0), STEPS)


def heavy_inside(mass_ratio: float) -> Lane:
    return lane_of(0.3, 0.9, mass_ratio=mass_ratio)


REFUSED = [
    ("mujoco:contact", with_coefficients(1e-5), r"friction_coefficient = .* at least"),
    ("mujoco:contact", with_coefficients([0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.004]), r"friction_coefficient = .* at least"),
    ("mujoco:joint:default", stiff_lane(), r"^forces reach .* N; allowed by MuJoCo: 1e\+10 N"),
    ("dart:contact", with_coefficients(0.001), "friction_coefficient = 0.001 is frictionless for DART"),
    ("genesis:contact:default", with_coefficients(0.002), "= 0.002; allowed: at least 0.01 in Genesis"),
    ("genesis:contact:default:across=held", with_coefficients(0.002), "= 0.002; allowed: at least 0.01 in Genesis"),
    ("pybullet:contact", with_coefficients(11.0), "friction_coefficient = 11; allowed by Bullet: at most 10"),
    ("pybullet", lane_of(cells=64), "cells = 64 .* at most 63"),
    ("rapier:joint:native", heavy_inside(101.0), "= 101; allowed: at most 100 in a multibody of Rapier"),
    # Masses beside which single precision loses the outer ones.
    ("newton", heavy_inside(2000.0), "= 2000; allowed: at most 1000 in Newton"),
    ("newton:joint:default", heavy_inside(2000.0), "= 2000; allowed: at most 1000 in Newton"),
    ("newton:contact", heavy_inside(2000.0), "= 2000; allowed: at most 1000 in Newton"),
    ("newton:contact:default", heavy_inside(2000.0), "= 2000; allowed: at most 1000 in Newton"),
    ("mujoco-warp", heavy_inside(200.0), "= 200; allowed: at most 100 in MuJoCo Warp"),
    ("mujoco-warp:contact", heavy_inside(40.0), "= 40; allowed: at most 20 in MuJoCo Warp"),
]


@pytest.mark.parametrize(
    ("name", "lane", "said"),
    [pytest.param(*row, id=f"{row[0]} {number}", marks=pytest.mark.needs(row[0].split(":")[0]))
     for number, row in enumerate(REFUSED)],
)  # fmt: skip
def test_what_an_engine_would_not_take_as_it_is_given_is_refused(name: str, lane: Lane, said: str) -> None:
    with pytest.raises(ParameterError, match=said):
        Variant.parse(name).build([lane]).advance(State.at_rest(1, lane.chain.cells), 0, STEPS)


@pytest.mark.needs("pybullet")
def test_the_longest_chain_that_pybullet_takes_moves_by_the_scheme() -> None:
    lane, rest = lane_of(cells=63), State.at_rest(1, 63)
    assert distance(lane, rest, run("pybullet", lane, rest, 100)) < ROUND_OFF


@pytest.mark.needs("mujoco")
def test_states_where_mujoco_would_stop_are_refused() -> None:
    with pytest.raises(ParameterError, match=r"initial positions reach 1e\+12"):
        run("mujoco", lane_of(), State(np.full((1, 14), 1e12), np.zeros((1, 14))), 1)


@pytest.mark.needs("exudyn-bristle")
def test_bristles_without_iterations_would_not_move_and_are_refused() -> None:
    with pytest.raises(ParameterError, match=r"discontinuous_iterations = 0 .* whole numbers >= 1"):
        run("exudyn-bristle", lane_of(), State.at_rest(1, 7), 1, discontinuous_iterations=0)
