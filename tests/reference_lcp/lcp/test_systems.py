"""Equation (7) in full, on systems with one or two contacts whose motion is known in closed form."""

import dataclasses
import math
import re
from dataclasses import dataclass

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
from reference_lcp.lcp.time_step import StepFailed, advanced, solve_step
from tests.reference_lcp.cases import moved

GRAVITY = 9.81
ROUND_OFF = 1e-10
"""Relative; the motion within a step is exact here, and some thousand steps add their roundings."""


DT = 1e-3


@dataclass
class System:
    """A system whose step is a function of time, position, velocity and time step."""

    freedoms: int
    contacts: int
    step: object


def step_data(mass, force, velocity, dt, w_n, w_t, gap, slip, mu, *, w_tilde=None, motion_n=0.0, motion_t=0.0):
    """Equation (7)'s data; directions as rows, one a contact."""
    w_n, w_t = np.array(w_n, dtype=float).T, np.array(w_t, dtype=float).T
    contacts = w_n.shape[1]
    return FrictionalStep(
        mass_matrix=np.diag(mass) * 1.0, force=np.array(force, dtype=float), velocity=velocity, time_step=dt,
        normal_directions=w_n, tangential_directions=w_t,
        tangential_directions_of_position=np.zeros_like(w_n) if w_tilde is None else np.array(w_tilde).T,
        normal_motion=np.full(contacts, motion_n), tangential_motion=np.full(contacts, motion_t),
        normal_gap=np.array(gap, dtype=float), relative_velocity=np.array(slip, dtype=float),
        friction_coefficient=np.full(contacts, mu),
    )  # fmt: skip


def fitted_order(errors) -> float:
    """Order of convergence over halvings of the time step."""
    return -np.polyfit(np.arange(len(errors)), np.log2(errors), 1)[0]


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


def test_box_below_both_thresholds_stands_and_its_feet_carry_what_statics_says() -> None:
    mu, mass = 0.4, 2.0
    push = push_of(mu, 0.9)
    motion = moved(pushed_box(mu=mu, push=push), 1e-3, 50)
    assert np.max(np.abs(motion.positions)) < ROUND_OFF
    rear, front = mass * GRAVITY / 2 - push * 1.2, mass * GRAVITY / 2 + push * 1.2
    assert np.allclose(motion.normal_force, [rear, front], rtol=1e-8)
    assert np.allclose(motion.friction.sum(axis=1), -push, rtol=1e-8)


def test_sliding_box_leans_on_its_front_foot_by_the_moments_of_push_and_friction() -> None:
    """(λ_front − λ_rear) b/2 = P (h − s) + μ m g s, with s the height of the centre of mass."""
    mu, mass, centre, height = 0.2, 2.0, 0.8, 1.2
    push = 1.3 * mu * mass * GRAVITY
    motion = moved(pushed_box(mu=mu, push=push), 1e-3, 100)
    difference = 2 * (push * (height - centre) + mu * mass * GRAVITY * centre)
    assert np.allclose(motion.normal_force[:, 1] - motion.normal_force[:, 0], difference, rtol=1e-8)
    assert np.allclose(motion.friction, -mu * motion.normal_force, rtol=1e-8)


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


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("mu", [0.0, 0.4, 0.9])
def test_normal_force_of_a_sliding_rod_is_painleves(mu, direction) -> None:
    """λ_N (1/m + l²/(4 J) cos θ (cos θ ∓ μ sin θ)) = g for a rod at rest but for its sliding, below the paradox."""
    rod, position = sliding_rod(mu)
    c, s = math.cos(position[2]), math.sin(position[2])
    motion = moved(rod, 1e-6, 3, position, np.array([direction, 0.0, 0.0]))
    expected = GRAVITY / (1 + 3 * c * (c + direction * mu * s))
    assert motion.normal_force[0, 0] == pytest.approx(expected, rel=1e-5)
    assert motion.friction[0, 0] == pytest.approx(-direction * mu * expected, rel=1e-5)
    assert 1 + 3 * c * (c - mu * s) > 0


def block_on_a_table(amplitude, omega):
    """A block on a table that moves up and down as A sin ωt."""

    def step(time, position, velocity, dt):
        table, rate = amplitude * math.sin(omega * time), amplitude * omega * math.cos(omega * time)
        return step_data(
            [1.5], [-1.5 * GRAVITY], velocity, dt, [[1]], [[0]], [position[0] - table], [0], 0.0, motion_n=-rate
        )

    return System(1, 1, step)


@pytest.mark.parametrize(("ratio", "lifts"), [(0.95, False), (1.05, True)])
def test_block_leaves_a_shaken_table_only_where_its_acceleration_exceeds_gravity(ratio, lifts) -> None:
    omega = 20.0
    amplitude = ratio * GRAVITY / omega**2
    dt = 2 * math.pi / omega / 2000
    motion = moved(block_on_a_table(amplitude, omega), dt, 2000, velocity=[amplitude * omega])
    assert np.any(motion.normal_force[1:] == 0) == lifts
    assert np.min(motion.positions[:, 0] - amplitude * np.sin(omega * motion.time)) > -2 * amplitude * (omega * dt) ** 2


def test_block_lifts_off_and_lands_when_the_closed_form_says() -> None:
    """Off at sin ωt = g/(A ω²); then a parabola, until it meets the table again, within a few steps.

    On the table the velocity is the table's mean over the last step, so that positions follow Störmer's
    rule in flight: second order there.
    """
    omega, ratio = 20.0, 2.0
    amplitude = ratio * GRAVITY / omega**2
    off = math.asin(1 / ratio) / omega
    leaving, speed = amplitude / ratio, amplitude * omega * math.cos(omega * off)
    errors = []
    for steps in (500, 1000, 2000):
        dt = 2 * math.pi / omega / steps
        motion = moved(block_on_a_table(amplitude, omega), dt, int(0.95 * steps), velocity=[amplitude * omega])
        flying = motion.normal_force[:, 0] == 0
        assert abs(motion.time[np.argmax(flying)] - off) <= 2 * dt
        flight = motion.time - off
        parabola = leaving + speed * flight - GRAVITY * flight**2 / 2
        table = amplitude * np.sin(omega * motion.time)
        landing = motion.time[(flight > 0) & (parabola < table)][0]
        assert abs(motion.time[np.flatnonzero(flying)[-1]] - landing) <= 2 * dt
        inside = (flight > 0) & (motion.time < landing - 5 * dt)
        errors.append(np.max(np.abs(motion.positions[inside, 0] - parabola[inside])) / amplitude)
    assert fitted_order(errors) == pytest.approx(2.0, abs=0.1)
    assert errors[-1] < 1.6e-4


def block_on_a_belt(mu, belt, belt_rate):
    """A block on a belt with a velocity that is a function of time; freedoms along and off the belt."""

    def step(time, position, velocity, dt):
        return step_data(
            [2, 2], [0, -2 * GRAVITY], velocity, dt, [[0, 1]], [[1, 0]], [position[1]], [velocity[0] - belt(time)],
            mu, motion_t=-belt_rate(time),
        )  # fmt: skip

    return System(2, 1, step)


@pytest.mark.parametrize(("ratio", "sticks"), [(0.99, True), (1.01, False)])
def test_belt_carries_the_block_until_its_acceleration_exceeds_mu_g(ratio, sticks) -> None:
    mu, a = 0.3, ratio * 0.3 * GRAVITY
    motion = moved(block_on_a_belt(mu, lambda t: a * t, lambda _: a), 1e-3, 500)
    slip = np.abs(motion.relative_velocity[:, 0])
    assert np.max(slip) == pytest.approx(0.0 if sticks else (a - mu * GRAVITY) * 0.5, abs=ROUND_OFF)
    assert motion.velocities[-1, 0] == pytest.approx(min(a, mu * GRAVITY) * 0.5, rel=ROUND_OFF)


def test_block_on_a_fast_oscillating_belt_moves_in_the_known_triangle_wave() -> None:
    """It slips all the time: velocity a triangle wave of slope ±μ g, symmetric in the steady state.

    The belt's velocity is V cos ωt; slip changes its sign where both velocities agree. By symmetry the
    block's velocity is +w at such an instant and −w half a period later, so w = μ g π / (2 ω).
    """
    mu, omega, belt = 0.1, 40.0, 1.0
    dt = 2 * math.pi / omega / 1000
    motion = moved(
        block_on_a_belt(mu, lambda t: belt * math.cos(omega * t), lambda t: -belt * omega * math.sin(omega * t)),
        dt,
        12_000,
    )
    last = motion.velocities[-1000:, 0]
    assert (last.max() - last.min()) / 2 == pytest.approx(mu * GRAVITY * math.pi / (2 * omega), rel=5e-3)
    assert np.all(np.isclose(np.abs(motion.friction), mu * 2 * GRAVITY) | (np.abs(motion.friction) < mu * 2 * GRAVITY))


@pytest.mark.parametrize("mu", [0.0, 0.3, 1.0])
def test_bead_pushed_by_a_rotating_arm_slides_out_as_the_closed_form_says(mu) -> None:
    """r̈ = Ω² r − 2 μ Ω ṙ: centrifugal force, and friction μ of the Coriolis force that the arm passes on.

    The centrifugal force comes from arms half a step apart, as a centred difference: second order here.
    """
    omega, radius, end = 3.0, 0.2, 0.5

    def step(time, position, velocity, dt):
        c, s = math.cos(omega * time), math.sin(omega * time)
        along, off = np.array([c, s]), np.array([-s, c])
        return step_data(
            [0.7, 0.7], [0, 0], velocity, dt, [off], [along], [off @ position], [along @ velocity], mu,
            motion_n=-omega * (along @ position), motion_t=omega * (off @ velocity),
        )  # fmt: skip

    roots = omega * (-mu + math.sqrt(mu**2 + 1)), omega * (-mu - math.sqrt(mu**2 + 1))
    first, second = np.linalg.solve([[1, 1], roots], [radius, 0.0])
    exact = first * math.exp(roots[0] * end) + second * math.exp(roots[1] * end)
    errors = []
    for steps in (250, 500, 1000):
        motion = moved(System(2, 1, step), end / steps, steps, [radius, 0.0], [0.0, omega * radius])
        errors.append(abs(np.linalg.norm(motion.positions[-1]) / exact - 1))
    assert fitted_order(errors) == pytest.approx(2.0, abs=0.1)
    assert errors[-1] < 1.6e-5
    rate = first * roots[0] * math.exp(roots[0] * end) + second * roots[1] * math.exp(roots[1] * end)
    assert motion.normal_force[-1, 0] == pytest.approx(2 * 0.7 * omega * rate, rel=1e-2)


def bead_inside_a_rough_ring(mu, radius, rim_speed=0.0):
    """A bead (mass 1) on the inner wall of a ring that turns; ġ_T = (x ẏ − y ẋ)/r − V depends on the position."""

    def step(time, position, velocity, dt):
        (x, y), r = position, math.hypot(*position)
        along = np.array([-y, x]) / r
        speed = along @ velocity
        slope = np.array([velocity[1], -velocity[0]]) / r - speed * position / r**2
        return step_data(
            [1, 1], [0, 0], velocity, dt, [-position / r], [along], [radius - r], [speed - rim_speed], mu,
            w_tilde=[slope],
        )  # fmt: skip

    return System(2, 1, step)


def test_bead_in_a_rough_ring_slows_as_one_over_time() -> None:
    """Its centripetal force is the normal force: v̇ = −μ v²/R, so v = v0 / (1 + μ v0 t / R)."""
    mu, radius, speed, end = 0.4, 0.5, 2.0, 1.0
    errors = []
    for steps in (250, 500, 1000):
        motion = moved(bead_inside_a_rough_ring(mu, radius), end / steps, steps, [radius, 0.0], [0.0, speed])
        exact = speed / (1 + mu * speed * motion.time / radius)
        errors.append(np.max(np.abs(motion.relative_velocity[:, 0] - exact)) / speed)
        assert np.max(np.abs(np.hypot(*motion.positions.T) - radius)) < radius * (speed * end / steps / radius) ** 2
    assert fitted_order(errors) == pytest.approx(1.0, abs=0.1)
    assert errors[-1] < 4e-3


def test_turning_ring_catches_the_bead_at_the_speed_of_its_rim() -> None:
    mu, radius, speed, rim = 0.4, 0.5, 2.0, 1.0
    caught = radius / mu * (1 / rim - 1 / speed)
    motion = moved(bead_inside_a_rough_ring(mu, radius, rim), 1e-3, 1500, [radius, 0.0], [0.0, speed])
    stuck = np.abs(motion.relative_velocity[:, 0]) < ROUND_OFF
    assert motion.time[np.argmax(stuck)] == pytest.approx(caught, abs=5e-3)
    assert np.all(stuck[motion.time > caught + 5e-3])
    assert motion.normal_force[-1, 0] == pytest.approx(rim**2 / radius, rel=1e-2)


def test_block_stuck_to_a_stretching_belt_follows_it_to_the_end_of_each_step() -> None:
    """ġ_T = ẋ − κ x: W̃_T makes the sticking step implicit, x_(k+1) = x_k / (1 − κ Δt), close to x0 exp κt."""
    stretch, dt, steps = 0.8, 1e-3, 500

    def step(time, position, velocity, dt):
        return step_data(
            [2, 2], [0, -2 * GRAVITY], velocity, dt, [[0, 1]], [[1, 0]], [position[1]],
            [velocity[0] - stretch * position[0]], 0.8, w_tilde=[[-stretch, 0]],
        )  # fmt: skip

    motion = moved(System(2, 1, step), dt, steps, [1.0, 0.0], [stretch, 0.0])
    assert motion.positions[-1, 0] == pytest.approx((1 - stretch * dt) ** -steps, rel=ROUND_OFF)
    assert motion.positions[-1, 0] == pytest.approx(math.exp(stretch * dt * steps), rel=stretch * dt)


def test_two_runs_equal_one() -> None:
    """Nothing is carried over but the state: the warm start changes the path to a solution, not the solution."""
    system = block_on_a_table(2 * GRAVITY / 400, 20.0)
    whole = moved(system, 1e-3, 400, velocity=[0.98])
    first = moved(system, 1e-3, 150, velocity=[0.98])
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


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"time_step": 0.0}, "time_step = 0"),
        ({"steps": 0}, "steps = 0"),
        ({"start": -1}, "start = -1"),
        ({"position": [0.0, 0.0]}, r"position has shape \(2,\); allowed: \(1,\)"),
        ({"velocity": [np.nan]}, "velocity = nan"),
    ],
)
def test_wrong_argument_is_refused_with_its_value(wrong, message) -> None:
    arguments = {"position": [0.0], "velocity": [0.0], "time_step": 1e-3, "steps": 1} | wrong
    with pytest.raises(ParameterError, match=message):
        simulate_system(block_on_a_table(0.01, 20.0), **arguments)


def held_block(**contact) -> MassSpringSystem:
    """1 kg under 10 N, μ = 0.3 in motion."""
    rough = FrictionContact(0, **{"normal_force": 10.0, "coefficient": 0.3, **contact})
    return MassSpringSystem(masses=np.array([1.0]), friction=[rough])


def pulled(force: float, velocity: float = 0.0, **contact) -> float:
    """Velocity of the block after a step."""
    system = dataclasses.replace(held_block(**contact), forces={0: force})
    motion = moved(system, DT, 1, velocity=[velocity])
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
    impulses = solve_step(step)
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
        tangential_directions_of_position=np.zeros(()),
        normal_force=None,
        static_friction_coefficient=np.array([0.4]),
    )
    slides = dataclasses.replace(flat, static_friction_coefficient=None)
    assert solve_step(flat).relative_velocity[0] == 0
    assert solve_step(slides).relative_velocity[0] == pytest.approx(0.5 * DT)


def test_masses_without_contacts_move_freely() -> None:
    free = MassSpringSystem(masses=np.array([2.0]), forces={0: 4.0})
    motion = moved(free, DT, 10)
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
        moved(opens, 0.1, 10, velocity=[1.0])


def test_static_friction_below_kinetic_is_refused_in_a_step() -> None:
    step = held_block().step(0.0, np.zeros(1), np.zeros(1), DT)
    with pytest.raises(ParameterError, match="static_friction_coefficient"):
        dataclasses.replace(step, static_friction_coefficient=np.array([0.2]))
