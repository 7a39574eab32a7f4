"""Siconos's FrictionOscillator: m = k = F = 1 from x = 12 with v = 6, in the closed form and as its scheme has it."""

import math

import numpy as np
import pytest

from reference_lcp import EventDrivenSystem
from tests.reference_lcp.published.anchors import friction_oscillator, rows

START = {"position": [12.0], "velocity": [6.0]}
FIRST_TURN = math.atan2(6.0, 13.0)
"""When x = −1 + 13 cos t + 6 sin t is largest."""

FARTHEST = math.hypot(13.0, 6.0) - 1.0

SCHEME_UNCERTAINTY = 0.03
"""Of the published x and v: each of seven reversals falls within a step h, which leaves open 2 F h = 0.02."""


def turning_points():
    """Times and places of rest in the closed form: each half turn loses two F / k, until F holds what is left."""
    places = [FARTHEST]
    while abs(places[-1]) > 1:
        places.append(math.copysign(2, places[-1]) - places[-1])
    return FIRST_TURN + math.pi * np.arange(len(places)), np.array(places)


def test_oscillator_turns_where_the_closed_form_does_and_stays_at_the_last() -> None:
    times, places = turning_points()
    motion = EventDrivenSystem(friction_oscillator()).motion(**START, times=[*times, 100.0])
    assert motion.positions[:-1, 0] == pytest.approx(places, abs=1e-13 * FARTHEST)
    assert motion.velocities[:-1, 0] == pytest.approx(0, abs=1e-13 * FARTHEST)
    assert motion.positions[-1, 0] == pytest.approx(places[-1], abs=1e-13 * FARTHEST)
    assert motion.velocities[-1, 0] == 0


@pytest.mark.parametrize(("bound", "right"), [(1.0, True), (1.01, False)])
def test_published_rows_are_those_of_the_exact_motion(bound, right) -> None:
    time, x, v, _ = rows("friction_oscillator")
    motion = EventDrivenSystem(friction_oscillator(bound)).motion(**START, times=time)
    errors = np.abs(np.array([motion.positions[:, 0] - x, motion.velocities[:, 0] - v]))
    assert bool(np.max(errors) <= SCHEME_UNCERTAINTY) is right


def midpoint_rule(h: float, steps: int):
    """Moreau and Jean's scheme with θ = 1/2, one contact in closed form: x and v at the ends of the steps."""
    x, v, motion = 12.0, 6.0, np.empty((2, steps))
    for step in range(steps):
        inertia = 1 + h**2 / 4
        free = v - h * (x + h * v / 2) / inertia
        after = free - h / inertia * np.clip(free * inertia / h, -1.0, 1.0)
        x, v = x + h * (v + after) / 2, after
        motion[:, step] = x, v
    return motion


def test_published_rows_are_those_of_the_midpoint_rule() -> None:
    """So that what they differ from the exact motion by is the error of that rule."""
    time, x, v, _ = rows("friction_oscillator")
    own = midpoint_rule(0.01, 2500)[:, np.round(time / 0.01).astype(int) - 1]
    assert own == pytest.approx(np.array([x, v]), abs=1e-7)
