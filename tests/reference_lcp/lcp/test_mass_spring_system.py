"""Masses with springs and dry friction between any two of them, under given forces and normal forces."""

import dataclasses
import re

import numpy as np
import pytest

from reference_lcp import FrictionContact, Harmonic, MassSpringSystem, Piecewise, Spring, simulate_system
from reference_lcp.lcp.static_friction import solve_stick_slip_step
from reference_lcp.lcp.time_step import advanced
from reference_lcp.refusal import ParameterError

DT = 1e-3


def held_block(**contact) -> MassSpringSystem:
    """1 kg under 10 N, μ = 0.3 in motion."""
    rough = FrictionContact(0, **{"normal_force": 10.0, "coefficient": 0.3, **contact})
    return MassSpringSystem(masses=np.array([1.0]), friction=[rough])


def pulled(force: float, velocity: float = 0.0, **contact) -> float:
    """Velocity of the block after a step."""
    system = dataclasses.replace(held_block(**contact), forces={0: force})
    motion = simulate_system(system, position=[0.0], velocity=[velocity], time_step=DT, steps=1)
    return float(motion.velocities[0, 0])


@pytest.mark.parametrize(("force", "static", "accelerates"), [(3.9, 0.4, 0.0), (4.1, 0.4, 1.1), (3.1, None, 0.1)])
def test_block_at_rest_is_held_up_to_its_static_bound_and_released_with_the_kinetic_one(
    force, static, accelerates
) -> None:
    assert pulled(force, static_coefficient=static) == pytest.approx(accelerates * DT, abs=1e-16)


@pytest.mark.parametrize("static", [None, 0.4])
def test_block_in_motion_feels_kinetic_friction_whatever_holds_it_at_rest(static) -> None:
    assert pulled(0.0, velocity=1.0, static_coefficient=static) == pytest.approx(1 - 3 * DT, rel=1e-14)


@pytest.mark.parametrize(("force", "after"), [(-3.9, 0.0), (-4.1, -1.1 * DT)])
def test_block_that_would_turn_within_a_step_has_to_pass_the_static_bound(force, after) -> None:
    assert pulled(force, velocity=1e-20, static_coefficient=0.4) == pytest.approx(after, abs=1e-15)
    # the kinetic bound alone would turn it too
    turned = pulled(force, velocity=1e-5, static_coefficient=0.4)
    assert turned == pytest.approx(0.0 if force > -4 else 1e-5 - 1.1 * DT, abs=1e-15)


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
    impulses = solve_stick_slip_step(step)
    _, velocity = advanced(step, impulses, np.zeros(2))
    assert velocity == pytest.approx([1.1 * DT, 0.0], abs=1e-16)
    assert impulses.tangential / DT == pytest.approx([-2.0, -2.0], rel=1e-12)


def test_a_static_coefficient_also_holds_where_the_normal_force_is_resolved() -> None:
    """A block on the ground, y up: normal force 10 N from its weight."""
    flat = held_block().step(0.0, np.zeros(1), np.zeros(1), DT)
    flat = dataclasses.replace(
        flat,
        mass_matrix=np.eye(2),
        velocity=np.zeros(2),
        force=np.array([3.5, -10.0]),
        normal_directions=np.array([[0.0], [1.0]]),
        tangential_directions=np.array([[1.0], [0.0]]),
        tangential_directions_of_position=np.zeros((2, 1)),
        normal_force=None,
        static_friction_coefficient=np.array([0.4]),
    )
    slides = dataclasses.replace(flat, static_friction_coefficient=None)
    assert solve_stick_slip_step(flat).relative_velocity[0] == 0
    assert solve_stick_slip_step(slides).relative_velocity[0] == pytest.approx(0.5 * DT)


def test_masses_without_contacts_move_freely() -> None:
    free = MassSpringSystem(masses=np.array([2.0]), forces={0: 4.0})
    motion = simulate_system(free, position=[0.0], velocity=[0.0], time_step=DT, steps=10)
    assert motion.velocities[-1, 0] == pytest.approx(20 * DT)


def test_a_force_switches_at_its_time_however_that_was_rounded() -> None:
    signal = Piecewise({0.0: 1.0, 0.3: Harmonic(2.0, 1.0, 1.0, -0.3)})
    assert signal.value(3 * 0.1) == signal.value(0.3) == pytest.approx(2.0)
    assert signal.value(0.3 - 1e-12) == 1.0
    assert signal.value(-1.0) == 1.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"masses": np.array([0.0])}, "masses = 0 is outside"),
        ({"springs": [Spring(1)]}, "body = 1 of a spring does not exist; allowed: 0 to 0"),
        ({"springs": [Spring(0, 0)]}, "a spring joins body 0 to itself"),
        ({"springs": [Spring(0, stiffness=-1.0)]}, "stiffness = -1 is outside"),
        ({"friction": [FrictionContact(0), FrictionContact(0)]}, "2 contacts join bodies in a ring"),
        ({"friction": [FrictionContact(0, coefficient=0.3, static_coefficient=0.2)]}, "static_coefficient = 0.2"),
        ({"friction": [FrictionContact(0, coefficient=-0.3)]}, "coefficient = -0.3 is outside"),
        ({"forces": {3: 1.0}}, "body = 3 of a force does not exist"),
    ],
)
def test_what_is_no_system_is_refused_with_its_value(change, message) -> None:
    with pytest.raises(ParameterError, match=re.escape(message)):
        dataclasses.replace(held_block(), **change)


def test_pieces_that_do_not_rise_are_refused() -> None:
    with pytest.raises(ParameterError, match=r"starts of pieces = \[1.0, 0.0\]"):
        Piecewise({1.0: 0.0, 0.0: 1.0})


def test_a_normal_force_that_pulls_is_refused_when_it_does() -> None:
    opens = held_block(normal_force=Piecewise({0.0: 1.0, 0.5: -1.0}))
    with pytest.raises(ParameterError, match="normal_force = -1 is outside"):
        simulate_system(opens, position=[0.0], velocity=[1.0], time_step=0.1, steps=10)


def test_static_friction_below_kinetic_is_refused_in_a_step() -> None:
    step = held_block().step(0.0, np.zeros(1), np.zeros(1), DT)
    with pytest.raises(ParameterError, match="static_friction_coefficient"):
        dataclasses.replace(step, static_friction_coefficient=np.array([0.2]))
