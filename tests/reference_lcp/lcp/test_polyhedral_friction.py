"""Friction in a plane by a pyramid: its bound by direction in closed form, and Coulomb's circle for many facets."""

import dataclasses

import numpy as np
import pytest

from reference_lcp import ParameterError, PolyhedralStep, solve_polyhedral_step

MASS, MU, WEIGHT, TIME_STEP = 2.0, 0.6, 15.0, 1e-3
BOUND = MU * WEIGHT
FACETS = (4, 6, 8, 16)
ANGLES = np.radians(np.arange(0, 361, 15))


def block(facets: int, angle: float, load: float = 0.0, speed: float = 0.0, weight: float = WEIGHT) -> PolyhedralStep:
    """A block on a plane under its weight, pulled by `load` [N] and sliding with `speed` [m/s] along `angle` [rad]."""
    along = np.array([np.cos(angle), np.sin(angle), 0.0])
    return PolyhedralStep(
        mass_matrix=MASS * np.eye(3),
        force=load * along - [0.0, 0.0, weight],
        velocity=speed * along,
        time_step=TIME_STEP,
        normal_directions=np.eye(3)[:, 2:],
        tangential_directions=np.eye(3)[:, :2],
        normal_gap=np.zeros(1),
        friction_coefficient=np.array([MU]),
        facets=facets,
    )


def from_corner(angle: float, facets: int) -> float:
    """Angle from the nearest corner of the polygon [rad]."""
    return abs((angle + np.pi / facets) % (2 * np.pi / facets) - np.pi / facets)


@pytest.mark.parametrize("facets", FACETS)
@pytest.mark.parametrize("angle", ANGLES)
def test_a_sliding_block_has_the_friction_of_the_nearest_corner(facets, angle) -> None:
    impulses = solve_polyhedral_step(block(facets, angle, speed=1.0))
    along = np.array([np.cos(angle), np.sin(angle)])
    friction = impulses.tangential[0] / TIME_STEP
    assert impulses.normal / TIME_STEP == pytest.approx(WEIGHT)
    assert -friction @ along == pytest.approx(BOUND * np.cos(from_corner(angle, facets)), rel=1e-12)


@pytest.mark.parametrize("facets", FACETS)
@pytest.mark.parametrize("angle", ANGLES)
def test_a_block_at_rest_slips_where_the_load_leaves_the_polygon(facets, angle) -> None:
    half = np.pi / facets
    bound = BOUND * np.cos(half) / np.cos(half - from_corner(angle, facets))
    held, slipping = (solve_polyhedral_step(block(facets, angle, load=part * bound)) for part in (0.999, 1.001))
    assert np.linalg.norm(held.slip) < 1e-15
    assert np.linalg.norm(slipping.slip) > 1e-4 * bound * TIME_STEP / MASS


def test_many_facets_are_coulombs_circle() -> None:
    facets = 256
    parts = [np.linalg.norm(solve_polyhedral_step(block(facets, angle, speed=1.0)).tangential) for angle in ANGLES]
    assert np.array(parts) / TIME_STEP == pytest.approx(BOUND, rel=1e-12)
    friction = solve_polyhedral_step(block(facets, 1.0, speed=1.0)).tangential[0]
    assert np.arctan2(*-friction[::-1]) == pytest.approx(1.0, abs=np.pi / facets)


def test_a_block_that_is_pulled_off_its_plane_has_neither_normal_force_nor_friction() -> None:
    impulses = solve_polyhedral_step(block(4, 0.3, speed=1.0, weight=-WEIGHT))
    assert not np.any(impulses.normal)
    assert not np.any(impulses.tangential)


def test_two_blocks_that_share_a_plane_do_not_share_friction() -> None:
    steps = [block(6, 0.2, speed=1.0), block(6, 1.1, load=0.5 * BOUND)]
    both = dataclasses.replace(
        steps[0],
        mass_matrix=MASS * np.eye(6),
        force=np.concatenate([each.force for each in steps]),
        velocity=np.concatenate([each.velocity for each in steps]),
        normal_directions=np.eye(6)[:, [2, 5]],
        tangential_directions=np.eye(6)[:, [0, 1, 3, 4]],
        normal_gap=np.zeros(2),
        friction_coefficient=np.full(2, MU),
    )
    alone = np.concatenate([solve_polyhedral_step(each).tangential for each in steps])
    assert solve_polyhedral_step(both).tangential == pytest.approx(alone, abs=1e-15)


@pytest.mark.parametrize("facets", [2, 3, 5])
def test_pyramids_with_too_few_or_an_odd_number_of_facets_are_refused(facets) -> None:
    with pytest.raises(ParameterError, match=rf"facets = {facets}"):
        block(facets, 0.0)
