"""Equation (7) in full on bodies whose contacts act on each other: a box on two feet, a rod on its tip, two walls."""

import math

import numpy as np
import pytest

from reference_lcp import simulate_system
from reference_lcp.lcp.time_step import StepFailed
from tests.reference_lcp.cases import moved
from tests.reference_lcp.lcp.step_data import GRAVITY, ROUND_OFF, System, step_data


def pushed_box(*, width=1.0, centre=0.8, push_height=1.2, mu, push, mass=2.0):
    """A box on two feet, pushed horizontally at a height; freedoms x, y of its centre and its rotation."""
    inertia = mass * (width**2 + (2 * centre) ** 2) / 12

    def step(time, position, velocity, dt):
        s, c = math.sin(position[2]), math.cos(position[2])
        feet = [(c * x + s * centre, s * x - c * centre) for x in (-width / 2, width / 2)]
        w_n, w_t = [[0, 1, x] for x, _ in feet], [[1, 0, -y] for _, y in feet]
        return step_data(
            [mass, mass, inertia], [push, -mass * GRAVITY, -push * (push_height - centre)], velocity, dt, w_n, w_t,
            [centre + position[1] + y for _, y in feet], np.array(w_t) @ velocity, mu,
            w_tilde=[[0, 0, x * velocity[2]] for x, _ in feet],
        )  # fmt: skip

    return System(3, 2, step)


def push_of(mu, factor, *, width=1.0, push_height=1.2, mass=2.0):
    """A force beyond (factor > 1) or below the smaller of sliding's and tipping's thresholds."""
    return factor * mass * GRAVITY * min(mu, width / (2 * push_height))


@pytest.mark.parametrize(("ratio", "slides"), [(0.7, True), (0.97, True), (1.03, False), (1.5, False)])
def test_pushed_box_slides_where_mu_is_below_half_its_width_over_the_height_of_the_push(ratio, slides) -> None:
    """Two contacts coupled through M: beyond μ = b/(2 h) the box tips about its front foot instead."""
    mu = ratio * 1.0 / (2 * 1.2)
    motion = moved(pushed_box(mu=mu, push=push_of(mu, 1.01)), 1e-3, 300)
    if slides:
        assert np.max(np.abs(motion.normal_gap)) < ROUND_OFF
        assert motion.velocities[-1, 0] == pytest.approx(0.01 * mu * GRAVITY * 0.3, rel=1e-6)
    else:
        assert motion.normal_gap[-1, 0] > 1e-4
        assert np.all(motion.normal_force[5:, 0] == 0)
        assert np.max(np.abs(motion.relative_velocity[:, 1])) < ROUND_OFF


def sliding_rod(mu, angle=0.7, length=1.0):
    """Painlevé's rod (mass 1) with one end on a plane; freedoms x, y of its centre and its angle."""

    def step(time, position, velocity, dt):
        s, c = math.sin(position[2]), math.cos(position[2])
        half = length / 2
        w_t = [[1, 0, half * s]]
        return step_data(
            [1, 1, length**2 / 12], [0, -GRAVITY, 0], velocity, dt, [[0, 1, -half * c]], w_t,
            [position[1] - half * s], np.array(w_t) @ velocity, mu, w_tilde=[[0, 0, half * c * velocity[2]]],
        )  # fmt: skip

    return System(3, 1, step), np.array([0.0, length / 2 * math.sin(angle), angle])


@pytest.mark.parametrize(
    ("along", "mu", "after"), [(0.0, 0.9, 0), (0.0, 0.4, -1), (2.0, 0.4, 1), (-2.0, 0.4, -1), (2.0, 0.0, 1)]
)
def test_rod_that_lands_gets_the_impulses_of_a_rigid_impact_with_friction(along, mu, after) -> None:
    """Without rebound, in a step so short that no weight counts: it sticks after it, or slides in one direction.

    G_NN Λ_N + G_NT Λ_T = 1 m/s, and G_TN Λ_N + G_TT Λ_T = −ġ_T or Λ_T = ∓μ Λ_N.
    """
    rod, position = sliding_rod(mu)
    dt, c, s = 1e-10, math.cos(position[2]), math.sin(position[2])
    g_nn, g_nt, g_tt = 1 + 3 * c**2, -3 * s * c, 1 + 3 * s**2
    motion = moved(rod, dt, 1, position, np.array([along, -1.0, 0.0]))
    sliding = 1 / (g_nn - after * mu * g_nt) * np.array([1, -after * mu])
    expected = np.linalg.solve([[g_nn, g_nt], [g_nt, g_tt]], [1, -along]) if after == 0 else sliding
    assert [motion.normal_force[0, 0] * dt, motion.friction[0, 0] * dt] == pytest.approx(expected, rel=1e-8)
    assert motion.relative_velocity[0, 0] == pytest.approx(along + [g_nt, g_tt] @ expected, abs=1e-8)
    assert np.sign(round(motion.relative_velocity[0, 0], 8)) == after


def test_two_runs_equal_one() -> None:
    """Nothing is carried over but the state: the warm start changes the path to a solution, not the solution."""
    system = pushed_box(mu=0.5, push=push_of(0.5, 1.3))
    whole = moved(system, 1e-3, 400)
    first = moved(system, 1e-3, 150)
    second = simulate_system(
        system, position=first.positions[-1], velocity=first.velocities[-1], time_step=1e-3, steps=250, start=150
    )
    assert np.allclose(second.positions, whole.positions[150:], rtol=0, atol=ROUND_OFF)
    assert second.time == pytest.approx(whole.time[150:])


def test_failed_step_is_named_with_its_time() -> None:
    """Two walls close in on a body of one freedom and meet at t = 0.0105 s."""

    def step(time, position, velocity, dt):
        gap = 0.0105 - time
        return step_data(
            [1], [0], velocity, dt, [[1], [-1]], [[0], [0]], [gap + position[0], gap - position[0]], [0, 0], 0.0,
            motion_n=-1.0,
        )  # fmt: skip

    with pytest.raises(StepFailed, match=r"step 10 at t = 0\.01 s: .*no solution"):
        moved(System(1, 2, step), 1e-3, 50)
