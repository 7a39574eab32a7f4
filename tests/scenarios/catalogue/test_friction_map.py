"""Effective friction over speed and direction: laws that are known, and engines whose cones are."""

import itertools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.scene import GRAVITY, SteppedWorld
from multibody_xval.scenarios.catalogue.friction_map import SPEEDS, STEPS, driven_box, friction_map, map_runs
from multibody_xval.scenarios.catalogue.scenes.pushed_box import ANGLES
from multibody_xval.scenarios.compute.driven import driven
from multibody_xval.scenarios.model import Config, Run
from multibody_xval.scenarios.running.evaluate import Means, computed

STEP = 2e-3
"""[s]."""

BOUND = 0.5 * GRAVITY
"""μ m g of the box [N]."""


class Sliding:
    """A mass of 1 kg that is pushed along x, with a friction that follows its velocity at the end of each step."""

    def __init__(self, friction: Callable[[float], float]):
        self.friction, self.velocity, self.force = friction, 0.0, 0.0

    def launch(self, velocity, _spin) -> None:
        self.velocity = velocity[0]

    def push(self, force) -> None:
        self.force = force

    def step(self) -> None:
        """Find the speed at which momentum and friction agree: both sides grow with it."""
        free, low, high = self.velocity + STEP * self.force, 0.0, 10.0
        for _ in range(100):
            middle = (low + high) / 2
            low, high = (low, middle) if middle + STEP * self.friction(middle) > free else (middle, high)
        self.velocity = low

    def state(self):
        return np.zeros(7), (self.velocity, 0.0, 0.0)


def effective(friction: Callable[[float], float], speed: float) -> tuple[float, float]:
    """Give friction over μ m g, and the speed over the one that is kept."""
    mass = Sliding(friction)
    world = SteppedWorld(mass.step, mass.state, mass.launch, push=mass.push)
    found = driven(driven_box(speed, 0, STEP).scene, speed, STEP, world, STEPS)[1]
    return found[0], found[1]


def test_dry_friction_is_what_keeps_a_mass_at_any_speed() -> None:
    for part, speed in itertools.product((1.0, 0.99, math.sqrt(2)), (SPEEDS[0], 1e-3, 1.0)):
        assert effective(lambda _speed, part=part: part * BOUND, speed) == pytest.approx((part, 1), abs=1e-6)


def test_friction_that_grows_with_the_speed_is_read_at_the_speed() -> None:
    """As engines have it: in proportion below a few millimetres a second."""
    for speed in (1e-4, 1e-3, 0.1):
        found = effective(lambda own: BOUND * min(1.0, own / 5e-3), speed)
        assert found == pytest.approx((min(1.0, speed / 5e-3), 1), rel=1e-3)


def test_nothing_is_said_of_friction_where_a_box_is_stuck() -> None:
    assert effective(lambda _speed: 3 * BOUND, SPEEDS[0])[1] < 0.1
    run = Run(Config("mujoco", "contact", "default"), driven_box(SPEEDS[0], 0, STEP), STEPS)
    (stored,) = computed([replace(run, steps=2)], Means())
    row = friction_map([stored]).iloc[0]
    assert abs(row.kept - 1) > 0.2
    assert math.isnan(row.friction)


def at(name: str, speed: float) -> list[float]:
    """Give the friction of a configuration at a speed by angle, less 1 [%]."""
    runs = [run for run in map_runs([Config.parse(name)]) if run.case.drive == speed]
    return friction_map(computed(runs, Means())).friction.tolist()


ALPHA = np.radians(ANGLES)

INSCRIBED = 100 * (1 / (np.cos(ALPHA) + np.sin(ALPHA)) - 1)
"""Of a pyramid whose corners are on the circle: the box slides off its face [%]."""

AN_AXIS = 100 * (1 / np.cos(ALPHA) - 1)
"""Of a bound an axis: the box slides along x alone, up to 45° [%]."""


@pytest.mark.parametrize(
    ("name", "speed", "expected", "within"),
    [
        ("mujoco:contact:default", 0.1, INSCRIBED, 1.5),
        ("mujoco:contact:default", 1e-4, [-93.8] * 4, 0.1),
        ("mujoco:contact:recommended", 1e-4, [0.0] * 4, 0.01),
        ("ode:contact:default", 1e-3, AN_AXIS, 0.01),
        ("dart:contact:default", 0.1, AN_AXIS, 0.01),
        ("pybullet:contact:recommended", 0.01, [0.0, -0.3, -2.1, -4.1], 0.2),
        ("rapier:contact:default", 1e-5, [0.0] * 4, 0.01),
    ],
)
def test_engines_have_the_cones_that_the_documentation_says(name, speed, expected, within) -> None:
    """MuJoCo's box rattles at 0.1 m/s: its mean is known to a per cent or so."""
    if engine(name.partition(":")[0]).unavailable_reason() is not None:
        pytest.skip("not installed")
    assert at(name, speed) == pytest.approx(expected, abs=within)
