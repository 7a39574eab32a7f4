"""Equation (7)'s blocks by definition, static friction in a step, and what is no system."""

import dataclasses
import re

import numpy as np
import pytest

from reference_lcp import (
    FrictionalStep,
    FrictionContact,
    Harmonic,
    MassSpringSystem,
    ParameterError,
    Piecewise,
    Spring,
    simulate_system,
)
from reference_lcp.lcp.time_step import advanced, assemble, solve_step
from tests.reference_lcp.cases import moved

DT = 1e-3


def random_step(freedoms=5, contacts=2) -> FrictionalStep:
    """Everything that a step takes is there, and random."""
    rng = np.random.default_rng(7)
    root = rng.normal(size=(freedoms, freedoms))
    matrices = ("normal_directions", "tangential_directions", "tangential_directions_of_position")
    vectors = ("normal_motion", "tangential_motion", "normal_gap", "relative_velocity")
    return FrictionalStep(
        mass_matrix=root @ root.T + freedoms * np.eye(freedoms), force=rng.normal(size=freedoms),
        velocity=rng.normal(size=freedoms), time_step=0.01, friction_coefficient=np.array([0.3, 0.7]),
        **{name: rng.normal(size=(freedoms, contacts)) for name in matrices},
        **{name: rng.normal(size=contacts) for name in vectors},
    )  # fmt: skip


def test_matrix_has_the_blocks_of_equation_7() -> None:
    step = random_step()
    inverse, w_n, w_t = np.linalg.inv(step.mass_matrix), step.normal_directions, step.tangential_directions
    after = w_t + step.tangential_directions_of_position * step.time_step
    g_nn, g_nt = w_n.T @ inverse @ w_n, w_n.T @ inverse @ w_t
    g_tn, g_tt = after.T @ inverse @ w_n, after.T @ inverse @ w_t
    one, zero, mu = np.eye(2), np.zeros((2, 2)), np.diag(step.friction_coefficient)
    expected = [[g_nn - g_nt @ mu, g_nt, zero], [g_tn - g_tt @ mu, g_tt, one], [2 * mu, -one, zero]]
    assert np.allclose(assemble(step)[0], np.block(expected))


def test_right_hand_side_is_the_state_at_the_end_of_a_step_without_contact() -> None:
    """C_N and C_T by definition: gaps and relative velocities that (5) and (6) give for Λ = 0."""
    step = random_step()
    dt, gained = step.time_step, np.linalg.solve(step.mass_matrix, step.force * step.time_step)
    displaced = (step.velocity + gained) * dt
    _, vector = assemble(step)
    gap = step.normal_gap + step.normal_directions.T @ displaced + step.normal_motion * dt
    turned = step.tangential_directions_of_position.T @ displaced + step.tangential_motion * dt
    slip = step.relative_velocity + step.tangential_directions.T @ gained + turned
    assert np.allclose(vector, np.concatenate([gap, slip * dt, np.zeros(2)]))


def held_block(**contact) -> MassSpringSystem:
    """1 kg under 10 N, μ = 0.3 in motion."""
    rough = FrictionContact(0, **{"normal_force": 10.0, "coefficient": 0.3, **contact})
    return MassSpringSystem(masses=np.array([1.0]), friction=[rough])


@pytest.mark.parametrize(
    ("force", "before", "static", "after"),
    [
        (3.9, 0.0, 0.4, 0.0),  # at rest it is held up to the static bound, and released with the kinetic one
        (4.1, 0.0, 0.4, 1.1 * DT),
        (3.1, 0.0, None, 0.1 * DT),
        (0.0, 1.0, None, 1 - 3 * DT),  # in motion it feels kinetic friction, whatever holds it at rest
        (0.0, 1.0, 0.4, 1 - 3 * DT),
        (-3.9, 1e-20, 0.4, 0.0),  # to turn within a step it has to pass the static bound
        (-4.1, 1e-20, 0.4, -1.1 * DT),
        (-3.9, 1e-5, 0.4, 0.0),
        (-4.1, 1e-5, 0.4, 1e-5 - 1.1 * DT),
    ],
)
def test_static_friction_holds_at_rest_and_kinetic_friction_acts_in_motion(force, before, static, after) -> None:
    system = dataclasses.replace(held_block(static_coefficient=static), forces={0: force})
    motion = moved(system, DT, 1, velocity=[before])
    assert motion.velocities[0, 0] == pytest.approx(after, rel=1e-14, abs=1e-15)


def test_block_that_breaks_away_from_its_neighbour_leaves_that_at_rest() -> None:
    """Of two blocks in a row that rub on each other, the pulled one slides on the second, which the ground holds."""
    blocks = MassSpringSystem(
        masses=np.array([1.0, 1.0]),
        friction=[
            FrictionContact(0, 1, normal_force=10.0, coefficient=0.2, static_coefficient=0.3),
            FrictionContact(1, normal_force=40.0, coefficient=0.1, static_coefficient=0.12),
        ],
        forces={0: 3.1},
    )
    step = blocks.step(0.0, np.zeros(2), np.zeros(2), DT)
    impulses = solve_step(step)
    _, velocity = advanced(step, impulses, np.zeros(2))
    assert velocity == pytest.approx([1.1 * DT, 0.0], abs=1e-16)
    assert impulses.tangential / DT == pytest.approx([-2.0, -2.0], rel=1e-12)


@pytest.mark.parametrize(("static", "slip"), [(0.4, 0.0), (0.3, 0.5 * DT)])
def test_a_static_coefficient_also_holds_where_the_normal_force_is_resolved(static, slip) -> None:
    """A block of 1 kg on the ground, y up: normal force 10 N from its weight."""
    step = FrictionalStep(
        mass_matrix=np.eye(2), force=np.array([3.5, -10.0]), velocity=np.zeros(2), time_step=DT,
        normal_directions=np.array([[0.0], [1.0]]), tangential_directions=np.array([[1.0], [0.0]]),
        normal_gap=np.zeros(1), relative_velocity=np.zeros(1), friction_coefficient=np.array([0.3]),
        static_friction_coefficient=np.array([static]),
    )  # fmt: skip
    assert solve_step(step).relative_velocity == pytest.approx([slip], abs=1e-15)


def test_a_force_switches_at_its_time_however_that_was_rounded() -> None:
    signal = Piecewise({0.0: 1.0, 0.3: Harmonic(2.0, 1.0, 1.0, -0.3)})
    assert signal.value(3 * 0.1) == signal.value(0.3) == pytest.approx(2.0)
    assert signal.value(0.3 - 1e-12) == 1.0
    assert signal.value(-1.0) == 1.0


def moved_block(system=None, **wrong):
    given = {"position": [0.0], "velocity": [1.0], "time_step": 0.1, "steps": 10} | wrong
    return simulate_system(held_block() if system is None else system, **given)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: moved_block(time_step=0.0), "time_step = 0"),
        (lambda: moved_block(position=[0.0, 0.0]), "position has shape (2,); allowed: (1,)"),
        (lambda: moved_block(held_block(normal_force=Piecewise({0: 1, 0.5: -1}))), "normal_force = -1 is outside"),
        (lambda: MassSpringSystem(masses=np.array([0.0])), "masses = 0 is outside"),
        (lambda: dataclasses.replace(held_block(), springs=[Spring(1)]), "body = 1 of a spring does not exist"),
        (lambda: dataclasses.replace(held_block(), friction=[FrictionContact(0)] * 2), "join bodies in a ring"),
        (lambda: held_block(static_coefficient=0.2), "static_coefficient = 0.2"),
        (lambda: dataclasses.replace(held_block(), forces={3: 1.0}), "body = 3 of a force does not exist"),
        (lambda: Piecewise({1.0: 0.0, 0.0: 1.0}), "starts of pieces = [1.0, 0.0]"),
        (lambda: dataclasses.replace(random_step(), friction_coefficient=np.ones(3)), "shape (3,); allowed: (2,)"),
        (
            lambda: dataclasses.replace(random_step(), static_friction_coefficient=np.array([0.2, 0.7])),
            "static_friction_coefficient = [0.2 0.7]; allowed: >= [0.3 0.7]",
        ),
    ],
)  # fmt: skip
def test_what_is_no_system_or_no_motion_is_refused_with_its_value(make, message) -> None:
    with pytest.raises(ParameterError, match=re.escape(message)):
        make()
