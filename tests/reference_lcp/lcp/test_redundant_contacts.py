"""More contacts than freedoms: every step has a solution, found or left open, and no wrong one is given."""

import itertools

import numpy as np
import pytest

from reference_lcp.lcp.lemke import LemkeStatus, lemke
from tests.reference_lcp.lcp import redundant_contacts as redundant

SOLVED = LemkeStatus.SOLVED.name

WEDGED = (-0.5, 0.0, 1e-9)
"""Boxes whose contacts wedge by no more than 1e-9, without friction: their matrix does not hold what decides."""

BOXES = [boxes for boxes in itertools.product((0.2, -0.5), (0.0, 0.3, 1.0), redundant.NOISE) if boxes != WEDGED]


def hinged_boxes(seed, lowest=-0.5, friction=0.3, noise=0.0):
    rng = np.random.default_rng(seed)
    return redundant.hinged_boxes(rng, 10, lowest=lowest, friction=friction, noise=noise)


@pytest.mark.parametrize("boxes", BOXES, ids=str)
def test_hinged_boxes_with_ten_contacts_are_solved_sixty_of_sixty(boxes) -> None:
    """Corners of the pyramid are cos 90° = 6e-17 off the axes: entries of round-off, in rows that have no others."""
    for seed in range(60):
        assert redundant.outcome(*hinged_boxes(seed, *boxes)) == SOLVED


@pytest.mark.parametrize("count", [2, 4, 25])
def test_body_on_many_points_of_a_plane_is_solved(count) -> None:
    for seed in range(60):
        assert redundant.outcome(*redundant.body_on_a_plane(np.random.default_rng(seed), count)) == SOLVED


def test_contacts_that_wedge_by_1e_9_are_left_open() -> None:
    """Their matrix W_Nᵀ M⁻¹ W_N has an eigenvalue of 1e-18, lost beside one of 1: no solution and no proof of none."""
    left_open = 0
    for seed in range(60):
        M, q = hinged_boxes(seed, *WEDGED)
        result = lemke(M, q)
        left_open += not result.solved
        assert result.status is not LemkeStatus.NO_SOLUTION
        assert not result.solved or not redundant.is_wrong(M, q, result.z)
    assert left_open > 0


@pytest.mark.parametrize("count", redundant.SIZES)
def test_random_redundant_problem_is_solved_or_left_open(count) -> None:
    outcomes = [redundant.outcome(*redundant.random_step(seed, count)[1]) for seed in range(120)]
    assert set(outcomes) <= {SOLVED, LemkeStatus.RAY_TERMINATION.name, LemkeStatus.NUMERICAL_BREAKDOWN.name}
    assert outcomes.count(SOLVED) >= 110


@pytest.mark.parametrize(("factor", "more", "wrong"), [(1.0, 0.0, False), (1.0, 1e-6, True), (0.0, 0.0, True)])
def test_wrong_answer_is_recognised(factor, more, wrong) -> None:
    M, q = hinged_boxes(0)
    assert redundant.is_wrong(M, q, factor * lemke(M, q).z + more) == wrong
