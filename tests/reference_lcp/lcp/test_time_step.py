"""Equation (7) on systems whose motion is known in closed form."""

import dataclasses

import numpy as np
import pytest

from reference_lcp import FrictionalStep, ParameterError
from reference_lcp.lcp.time_step import StepFailed, advanced, assemble, solve_step

GRAVITY = 9.81
DT = 1e-3


def block_on_a_plane(position, velocity, *, mass=2.0, mu=0.4, push=0.0, belt=0.0, belt_acceleration=0.0):
    """A block (x along the plane, y off it) that may slide on a plane, lift off and land."""
    return FrictionalStep(
        mass_matrix=mass * np.eye(2),
        force=np.array([push, -mass * GRAVITY]),
        velocity=velocity,
        time_step=DT,
        normal_directions=np.array([[0.0], [1.0]]),
        tangential_directions=np.array([[1.0], [0.0]]),
        tangential_motion=np.array([-belt_acceleration]),
        normal_gap=position[1:],
        relative_velocity=velocity[:1] - belt,
        friction_coefficient=np.atleast_1d(mu),
    )


def simulate(steps, position, velocity, **parameters):
    rows = []
    for _ in range(steps):
        step = block_on_a_plane(position, velocity, **parameters)
        impulses = solve_step(step)
        position, velocity = advanced(step, impulses, position)
        rows.append((*position, *velocity, impulses.normal[0] / DT, impulses.tangential[0] / DT))
    return np.array(rows).T


def test_sliding_block_stops_after_v_squared_over_two_mu_g() -> None:
    mu, v = 0.4, 1.5
    x, y, vx, _, normal, tangential = simulate(800, np.zeros(2), np.array([v, 0.0]), mu=mu)
    assert x[-1] == pytest.approx(v**2 / (2 * mu * GRAVITY), abs=v * DT)
    assert abs(vx[-1]) < 1e-12
    assert np.allclose(normal, 2 * GRAVITY, rtol=1e-10)
    assert np.max(np.abs(tangential)) <= mu * 2 * GRAVITY * (1 + 1e-10)
    assert np.max(np.abs(y)) < 1e-12


def test_pushed_block_sticks_below_the_bound_and_slides_above_it() -> None:
    mass, mu = 2.0, 0.4
    bound = mu * mass * GRAVITY
    stuck = simulate(100, np.zeros(2), np.zeros(2), mu=mu, push=0.99 * bound)
    assert np.max(np.abs(stuck[0])) < 1e-12
    assert np.allclose(stuck[5], -0.99 * bound)
    sliding = simulate(100, np.zeros(2), np.zeros(2), mu=mu, push=1.25 * bound)
    assert sliding[2][-1] == pytest.approx(0.25 * bound / mass * 100 * DT, rel=1e-9)


def test_dropped_block_falls_freely_then_rests_on_the_plane() -> None:
    height = 0.05
    _, y, vx, vy, normal, _ = simulate(400, np.array([0.0, height]), np.array([0.3, 0.0]), mu=0.0)
    in_flight = int(np.sqrt(2 * height / GRAVITY) / DT) - 2
    assert np.all(normal[:in_flight] == 0)
    assert vy[in_flight] == pytest.approx(-GRAVITY * DT * (in_flight + 1))
    assert np.all(y >= -1e-12)
    assert abs(y[-1]) < 1e-12
    assert normal[-1] == pytest.approx(2 * GRAVITY)
    assert vx[-1] == pytest.approx(0.3)


def test_block_on_a_moving_belt_is_dragged_to_the_speed_of_the_belt() -> None:
    mu, belt = 0.4, 0.5
    _, _, vx, _, _, _ = simulate(400, np.zeros(2), np.zeros(2), mu=mu, belt=belt)
    catching_up = int(belt / (mu * GRAVITY) / DT)
    assert vx[catching_up // 2] == pytest.approx(mu * GRAVITY * DT * (catching_up // 2 + 1))
    assert np.allclose(vx[catching_up + 2 :], belt)


def test_accelerating_belt_carries_a_sticking_block_along() -> None:
    """The explicit motion of the surface, ω̃_T: within one step the block follows the belt exactly."""
    step = block_on_a_plane(np.zeros(2), np.zeros(2), belt_acceleration=2.0)
    _, velocity = advanced(step, solve_step(step), np.zeros(2))
    assert velocity[0] == pytest.approx(2.0 * DT)


def test_given_normal_force_equals_the_full_problem_where_the_contact_stays_closed() -> None:
    step = block_on_a_plane(np.zeros(2), np.array([0.7, 0.0]), push=3.0)
    full = solve_step(step)
    given = solve_step(dataclasses.replace(step, normal_force=full.normal / DT))
    assert given.tangential == pytest.approx(full.tangential)
    assert given.relative_velocity == pytest.approx(full.relative_velocity)


def test_matrix_has_the_blocks_of_equation_7() -> None:
    rng = np.random.default_rng(7)
    f, c, dt = 5, 2, 0.01
    root = rng.normal(size=(f, f))
    mass = root @ root.T + f * np.eye(f)
    w_n, w_t, w_tilde = rng.normal(size=(3, f, c))
    mu = np.array([0.3, 0.7])
    step = FrictionalStep(
        mass_matrix=mass, force=rng.normal(size=f), velocity=rng.normal(size=f), time_step=dt,
        normal_directions=w_n, tangential_directions=w_t, tangential_directions_of_position=w_tilde,
        normal_motion=rng.normal(size=c), tangential_motion=rng.normal(size=c), normal_gap=rng.normal(size=c),
        relative_velocity=rng.normal(size=c), friction_coefficient=mu,
    )  # fmt: skip
    matrix, _ = assemble(step)
    inverse = np.linalg.inv(mass)
    g_nn, g_nt = w_n.T @ inverse @ w_n, w_n.T @ inverse @ w_t
    g_tn, g_tt = (w_t + w_tilde * dt).T @ inverse @ w_n, (w_t + w_tilde * dt).T @ inverse @ w_t
    one, zero, coefficient = np.eye(c), np.zeros((c, c)), np.diag(mu)
    expected = [
        [g_nn - g_nt @ coefficient, g_nt, zero],
        [g_tn - g_tt @ coefficient, g_tt, one],
        [2 * coefficient, -one, zero],
    ]
    assert np.allclose(matrix, np.block(expected))


def test_right_hand_side_is_the_state_at_the_end_of_a_step_without_contact() -> None:
    """C_N and C_T by definition: gaps and relative velocities that (5) and (6) give for Λ = 0."""
    rng = np.random.default_rng(8)
    f, c, dt = 4, 3, 0.02
    mass = np.diag(rng.uniform(1, 3, f))
    w_n, w_t, w_tilde = rng.normal(size=(3, f, c))
    h, q, wn, wt, gn, gt = rng.normal(size=f), rng.normal(size=f), *rng.normal(size=(4, c))
    step = FrictionalStep(
        mass_matrix=mass, force=h, velocity=q, time_step=dt, normal_directions=w_n, tangential_directions=w_t,
        tangential_directions_of_position=w_tilde, normal_motion=wn, tangential_motion=wt, normal_gap=gn,
        relative_velocity=gt, friction_coefficient=np.ones(c),
    )  # fmt: skip
    dq = np.linalg.solve(mass, h * dt)
    du = (q + dq) * dt
    _, vector = assemble(step)
    assert np.allclose(vector[:c], gn + w_n.T @ du + wn * dt)
    assert np.allclose(vector[c : 2 * c] / dt, gt + w_t.T @ dq + w_tilde.T @ du + wt * dt)
    assert np.all(vector[2 * c :] == 0)


def test_shape_that_does_not_fit_is_named() -> None:
    with pytest.raises(ParameterError, match=r"friction_coefficient has shape \(2,\); allowed: \(1,\)"):
        block_on_a_plane(np.zeros(2), np.zeros(2), mu=np.array([0.1, 0.2]))


def test_wedged_contact_without_a_solution_is_reported() -> None:
    """Two surfaces that close in on a body of one freedom: no motion satisfies both, and Lemke says so."""
    step = FrictionalStep(
        mass_matrix=np.eye(1), force=np.zeros(1), velocity=np.zeros(1), time_step=DT,
        normal_directions=np.array([[1.0, -1.0]]), tangential_directions=np.zeros((1, 2)),
        normal_motion=np.array([-1.0, -1.0]),
        normal_gap=np.zeros(2), relative_velocity=np.zeros(2),
        friction_coefficient=np.zeros(2),
    )  # fmt: skip
    with pytest.raises(StepFailed, match="no solution"):
        solve_step(step)
