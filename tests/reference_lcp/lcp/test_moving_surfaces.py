"""Equation (7) in full on surfaces that move, in closed form: a shaken table, a belt, a ring."""

import math

import numpy as np
import pytest

from tests.reference_lcp.cases import fitted_order, moved
from tests.reference_lcp.lcp.step_data import GRAVITY, ROUND_OFF, System, step_data


def block_on_a_table(amplitude, omega):
    """A block on a table that moves up and down as A sin ωt."""

    def step(time, position, velocity, dt):
        table, rate = amplitude * math.sin(omega * time), amplitude * omega * math.cos(omega * time)
        return step_data(
            [1.5], [-1.5 * GRAVITY], velocity, dt, [[1]], [[0]], [position[0] - table], [0], 0.0, motion_n=-rate
        )

    return System(1, 1, step)


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


@pytest.mark.parametrize(("ratio", "sticks"), [(0.99, True), (1.01, False)])
def test_belt_carries_the_block_until_its_acceleration_exceeds_mu_g(ratio, sticks) -> None:
    mu, a = 0.3, ratio * 0.3 * GRAVITY

    def step(time, position, velocity, dt):
        return step_data(
            [2, 2], [0, -2 * GRAVITY], velocity, dt, [[0, 1]], [[1, 0]], [position[1]], [velocity[0] - a * time], mu,
            motion_t=-a,
        )  # fmt: skip

    motion = moved(System(2, 1, step), 1e-3, 500)
    slip = np.abs(motion.relative_velocity[:, 0])
    assert np.max(slip) == pytest.approx(0.0 if sticks else (a - mu * GRAVITY) * 0.5, abs=ROUND_OFF)
    assert motion.velocities[-1, 0] == pytest.approx(min(a, mu * GRAVITY) * 0.5, rel=ROUND_OFF)


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
