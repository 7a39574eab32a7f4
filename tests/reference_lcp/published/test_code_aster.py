"""Dry friction in the test cases of code_aster: what is wrong in SDND100, SDND104 and SDND106 is found."""

import math

import numpy as np
import pytest

from reference_lcp import EventDrivenSystem, simulate_system
from tests.reference_lcp.published.anchors import (
    ANCHORS,
    half_turns,
    sdnd100,
    sdnd104,
    sdnd106,
    sdnd106_motion,
    wear_power,
)


def test_sdnd100_with_a_hundredth_more_friction_turns_elsewhere() -> None:
    for turn, wrong in enumerate(half_turns(sdnd100(0.101)), 1):
        value, uncertainty = ANCHORS[f"sdnd100-{turn}"]
        assert abs(wrong - value) > 10 * uncertainty


@pytest.mark.parametrize("amplitude", [15, 1.5, 1.01])
def test_sdnd104_with_a_thousandth_less_friction_wears_more(amplitude) -> None:
    value, uncertainty = ANCHORS[f"sdnd104-{amplitude:g}"]
    assert abs(wear_power(sdnd104(amplitude, 0.0999)) - value) > 3 * uncertainty


def test_sdnd104_with_two_hundredths_less_friction_wears_where_it_should_not() -> None:
    assert wear_power(sdnd104(0.99, 0.098)) > ANCHORS["sdnd104-1.01"].value / 10


def test_sdnd106_breaks_loose_when_the_spring_pulls_with_the_static_bound() -> None:
    """cos ω t = 1 − μ_s N / F of the mass that is pulled alone."""
    stretches = EventDrivenSystem(sdnd106()).stretches(position=[0.0, 0.0], velocity=[0.0, 0.0], end=0.1)
    loose = next(stretch.start for stretch in stretches if stretch.modes[0])
    assert loose == pytest.approx(math.acos(1 - 0.3 * 1e4 / 3e3) / math.sqrt(1e4 / 5), rel=1e-13)


def test_sdnd106_without_the_static_coefficient_is_found() -> None:
    position, _ = sdnd106_motion(sdnd106(static=0.2), 0.15)
    assert abs(position[0] - ANCHORS["sdnd106-2"].value) > 0.02


def test_scheme_breaks_the_neighbour_of_sdnd106_loose_within_a_step() -> None:
    """What is left of its error is of first order: less than the masses move in a step."""
    position, velocity = sdnd106_motion(sdnd106(), 0.15)
    for steps in (750, 1500, 3000):
        dt = 0.15 / steps
        motion = simulate_system(sdnd106(), position=[0.0, 0.0], velocity=[0.0, 0.0], time_step=dt, steps=steps)
        assert np.max(np.abs(motion.positions[-1] - position)) < dt * np.max(velocity)
